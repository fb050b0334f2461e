/** One parameter: its name, meaning and value, and what changes it. */

import { el, iconButton, setText } from "./dom.js";
import { ICONS } from "./icons.js";
import {
  fromSlider,
  hasSlider,
  sameValue,
  shortNumber,
  sliderSteps,
  toSlider,
} from "./parameter_scale.js";

const QUIET = 700; // ms after a change by hand, in which the control shows nothing else

export class ParameterControl {
  /**
   * @param {any} parameter as the server describes it
   * @param {boolean} readOnly
   * @param {(value: any) => void} onChange
   */
  constructor(parameter, readOnly, onChange) {
    this.parameter = parameter;
    this.readOnly = readOnly;
    this.onChange = onChange;
    this.value = parameter.default; // as the node has it
    this.changedAt = -QUIET;
    this.inputs = [];
    this.reset = iconButton(
      ICONS.reset,
      `Back to ${this.words(parameter.default)}`,
      () => this.change(parameter.default),
      { class: "icon-button small reset" },
    );
    this.error = el("div", { class: "bad refused", role: "alert", hidden: true });
    const { name, description, unit, type } = parameter;
    const inputs = this.makeInputs();
    this.element = el(
      "div",
      { class: "parameter", "data-name": name },
      el(
        "div",
        { class: "parameter-head" },
        el("span", { class: "parameter-name", id: `name-${name}` }, name),
        this.reset,
        type === "bool" && inputs,
      ),
      type !== "bool" && inputs,
      el(
        "div",
        { class: "dim meaning" },
        [description, unit && `(${unit})`].filter(Boolean).join(" "),
      ),
      this.error,
    );
  }

  /** A value as people read it. */
  words(value) {
    const choice = (this.parameter.choices || []).find((one) => one.value === value);
    if (choice) return choice.name || choice.description;
    if (typeof value === "boolean") return value ? "on" : "off";
    if (value === null) return "a number that is not finite";
    return typeof value === "number" ? shortNumber(value) : `"${value}"`;
  }

  /** @param {string} tag */
  input(tag, attributes, ...children) {
    const { name } = this.parameter;
    const input = el(
      tag,
      {
        "data-test": "parameter",
        "data-name": name,
        "aria-labelledby": `name-${name}`,
        disabled: this.readOnly,
        autocomplete: "off",
        spellcheck: "false",
        ...attributes,
      },
      ...children,
    );
    this.inputs.push(input);
    return input;
  }

  makeInputs() {
    const { type, choices } = this.parameter;
    if (type === "bool") {
      // its choices, if it has some, say no more
      const box = this.input("input", {
        type: "checkbox",
        class: "switch",
        role: "switch",
        onchange: () => this.change(box.checked),
      });
      this.display = (value) => (box.checked = value);
      return box;
    }
    if (choices?.length) {
      const select = this.input(
        "select",
        { onchange: () => this.change(choices[select.selectedIndex].value) },
        choices.map((choice) => el("option", {}, choice.description || choice.name)),
      );
      this.display = (value) =>
        (select.selectedIndex = choices.findIndex((choice) => sameValue(choice.value, value)));
      return select;
    }
    return type === "str" ? this.makeText() : this.makeNumber();
  }

  makeText() {
    const field = this.input("input", { type: "text", onchange: () => this.change(field.value) });
    this.display = (value) => (field.value = value);
    return field;
  }

  makeNumber() {
    const { parameter } = this;
    const field = this.input("input", {
      type: "number",
      step: parameter.type === "int" ? 1 : "any",
      min: parameter.min,
      max: parameter.max,
      class: "number-field",
      onchange: () => this.typed(field),
      onkeydown: (event) => event.key === "Enter" && this.typed(field),
    });
    this.display = (value) => (field.value = shortNumber(value));
    if (!hasSlider(parameter)) return field;
    const slider = this.input("input", {
      type: "range",
      min: 0,
      max: sliderSteps(parameter),
      step: 1,
      class: "grow",
      "data-test": "parameter-slider",
      oninput: () => this.change(fromSlider(parameter, Number(slider.value)), slider),
    });
    this.display = (value, source) => {
      field.value = shortNumber(value);
      slider.setAttribute("aria-valuetext", `${field.value} ${parameter.unit || ""}`);
      if (source !== slider) slider.value = String(toSlider(parameter, value));
    };
    return el("div", { class: "row tight" }, slider, field);
  }

  typed(field) {
    const value = Number(field.value);
    if (field.value.trim() === "" || !Number.isFinite(value)) {
      this.refuse("This must be a number.");
      return;
    }
    const { type, min, max } = this.parameter;
    if ((min !== null && value < min) || (max !== null && value > max)) {
      const low = min === null ? "" : ` from ${shortNumber(min)}`;
      const high = max === null ? "" : ` up to ${shortNumber(max)}`;
      this.refuse(`${field.value} is out of range, must be${low}${high}.`);
      return;
    }
    if (type === "int" && !Number.isInteger(value)) {
      this.refuse(`${field.value} must be a whole number.`);
      return;
    }
    if (!sameValue(value, this.value)) this.change(value);
  }

  /** Somebody has set it here. */
  change(value, source) {
    this.changedAt = performance.now();
    this.error.hidden = true;
    this.display(value, source);
    this.mark(value);
    this.onChange(value);
  }

  /** The node has this value now. */
  show(value) {
    this.value = value;
    const busy =
      performance.now() - this.changedAt < QUIET ||
      (this.inputs.includes(document.activeElement) &&
        /** @type {any} */ (document.activeElement).matches("[type=text], [type=number]"));
    clearTimeout(this.later);
    if (busy) {
      this.later = setTimeout(() => this.show(this.value), QUIET);
      return;
    }
    this.display(value);
    this.mark(value);
  }

  /** Says why a value was not taken, and shows the one that the node has. */
  refuse(text) {
    this.changedAt = -QUIET;
    setText(this.error, text);
    this.error.hidden = false;
    this.display(this.value);
    this.mark(this.value);
  }

  mark(value) {
    const normal = this.parameter.default; // null cannot be set again
    const changed = normal !== null && !sameValue(value, normal);
    this.element.classList.toggle("changed", changed);
    this.reset.disabled = this.readOnly || !changed;
  }

  /** @returns {boolean} whether it shows another value than that by default */
  isChanged() {
    return this.element.classList.contains("changed");
  }

  /** @param {string} word @param {boolean} changedOnly @returns {boolean} whether it is shown */
  filter(word, changedOnly) {
    const { name, description } = this.parameter;
    const fits = `${name} ${description}`.toLowerCase().includes(word);
    const shown = fits && (!changedOnly || this.isChanged());
    this.element.hidden = !shown;
    return shown;
  }
}
