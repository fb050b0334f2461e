/** The controls of all parameters of a node, in their groups. */

import { el } from "./dom.js";
import { ParameterControl } from "./parameter_control.js";

export class ParameterList {
  /**
   * @param {any[]} groups as the server describes them
   * @param {boolean} readOnly
   * @param {(values: Object<string, any>) => void} onChange
   */
  constructor(groups, readOnly, onChange) {
    this.readOnly = readOnly;
    this.onChange = onChange;
    /** @type {Map<string, ParameterControl>} */
    this.controls = new Map();
    this.sections = groups.flatMap((group) => this.makeSections(group, false));
    const none = this.controls.size ? "No parameter fits." : "This node has no live parameters.";
    this.none = el("div", { class: "empty", hidden: this.controls.size > 0 }, none);
    const sections = this.sections.map(({ element }) => element);
    this.element = el("div", { class: "stack" }, sections, this.none);
  }

  /** A section for each group that has parameters of its own. */
  makeSections({ name, parameters, groups }, inside) {
    const controls = parameters.map((parameter) => {
      const change = (value) => this.onChange({ [parameter.name]: value });
      const control = new ParameterControl(parameter, this.readOnly, change);
      this.controls.set(parameter.name, control);
      return control;
    });
    const named = inside || name.toLowerCase() !== "default";
    const title = named && el("h3", {}, name.replace(/_/g, " "));
    const elements = controls.map((control) => control.element);
    const element = el("section", { class: "parameter-group" }, title, elements);
    const own = controls.length ? [{ element, controls }] : [];
    return [...own, ...groups.flatMap((group) => this.makeSections(group, true))];
  }

  /** @param {Object<string, any>} values that the node has now */
  show(values) {
    for (const [name, value] of Object.entries(values)) this.controls.get(name)?.show(value);
  }

  /** @param {Object<string, string>} refused why, by name */
  refuse(refused) {
    for (const [name, text] of Object.entries(refused)) this.controls.get(name)?.refuse(text);
  }

  /**
   * Hides what does not fit.
   * @param {string} text to look for
   * @param {boolean} changedOnly
   */
  filter(text, changedOnly) {
    const word = text.trim().toLowerCase();
    let any = false;
    for (const { element, controls } of this.sections) {
      const shown = controls.filter((control) => control.filter(word, changedOnly)).length > 0;
      element.hidden = !shown;
      any ||= shown;
    }
    this.none.hidden = any;
  }

  /** @returns {number} how many had another value than by default, and are set back */
  reset() {
    const changed = [...this.controls.values()].filter((control) => control.isChanged());
    for (const control of changed) control.change(control.parameter.default);
    return changed.length;
  }
}
