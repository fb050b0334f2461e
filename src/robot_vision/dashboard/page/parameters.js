/** The panel with all live parameters of a node. */

import { el, setText, textButton } from "./dom.js";
import { ICONS } from "./icons.js";
import { LiveValues } from "./live_values.js";
import { ParameterList } from "./parameter_list.js";

const MANY = 7; // parameters, from which on there is a field to search them

/** Nodes that have parameters, by the app's graph. */
function nodesOf(app) {
  return (app.graph?.nodes || []).filter((node) => node.parameters).map((node) => node.name);
}

class ParameterPanel {
  /** @param {HTMLElement} element @param {any} app */
  constructor(element, app) {
    this.app = app;
    this.node = "";
    this.isGone = false; // the node is not in the graph
    this.closed = false;
    this.list = new ParameterList([], true, () => {});
    this.makeTop();
    element.append(this.top, this.list.element);
    this.offs = [
      app.on("selected", (node) => nodesOf(app).includes(node) && this.show(node)),
      app.on("graph", () => this.listNodes()),
      app.connection.on(
        "values",
        ({ node, values }) => node === this.node && this.changed(values),
      ),
      app.connection.on("parameters", ({ node }) => node === this.node && this.load()),
      app.connection.on("state", (state) => state === "open" && this.load()),
    ];
    const nodes = nodesOf(app);
    this.show(nodes.includes(app.selected) ? app.selected : nodes[0]);
  }

  makeTop() {
    const filter = () => this.filter();
    const choose = () => this.show(this.select.value);
    this.select = el("select", { class: "grow", "aria-label": "Node", onchange: choose });
    this.select.dataset.test = "parameter-node";
    this.saveButton = textButton("Save", () => this.save(), {
      class: "button primary",
      "data-test": "save-parameters",
    });
    this.resetButton = textButton("Reset all", () => this.reset());
    const attributes = { type: "search", class: "grow", placeholder: "Search" };
    this.search = el("input", { ...attributes, "aria-label": "Parameters", oninput: filter });
    this.changedOnly = el("input", { type: "checkbox", onchange: filter });
    const changed = el("label", { class: "row tight dim" }, this.changedOnly, "changed");
    this.searchRow = el("div", { class: "row tight" }, this.search, changed);
    this.answer = el("div", { role: "status", class: "answer", "data-test": "save-answer" });
    const row = el("div", { class: "row tight" }, this.select, this.resetButton, this.saveButton);
    this.top = el("div", { class: "parameter-top stack" }, row, this.searchRow, this.answer);
    this.tell("", "");
  }

  /** Keeps the menu of nodes that of the graph, and notices when the node comes back. */
  listNodes() {
    const nodes = nodesOf(this.app);
    const wasGone = this.isGone;
    this.isGone = Boolean(this.node) && !nodes.includes(this.node);
    if (this.isGone) nodes.push(this.node);
    if (this.isGone && !wasGone) this.tell(`${this.node} has gone.`, "bad");
    if (wasGone && !this.isGone) this.load();
    const texts = nodes.map((node) => node.replace(/^\//, ""));
    if (texts.join() === [...this.select.options].map(({ text }) => text).join()) return;
    const options = nodes.map((node, index) => el("option", { value: node }, texts[index]));
    this.select.replaceChildren(...options);
    this.select.value = this.node;
  }

  show(node) {
    if (!node || node === this.node) return;
    this.leave();
    this.node = node;
    this.isGone = false;
    this.listNodes();
    this.select.value = node;
    this.search.value = "";
    this.load();
  }

  leave() {
    if (!this.node || this.app.connection.state !== "open") return;
    this.app.connection.request("close_parameters", { node: this.node }).catch(() => {});
  }

  changed(values) {
    this.newer = values;
    this.list.show(values);
  }

  async load() {
    const { node } = this;
    this.newer = {}; // what is pushed until the answer is there
    const isWanted = () => node === this.node && !this.closed;
    try {
      const told = await this.app.connection.request("parameters", { node });
      if (isWanted()) this.build(told);
    } catch (error) {
      if (isWanted()) this.fail(error.message);
    }
  }

  replace(element) {
    this.top.nextElementSibling.replaceWith(element);
  }

  fail(text) {
    this.searchRow.hidden = true;
    this.saveButton.disabled = this.resetButton.disabled = true;
    const again = textButton("Try again", () => this.load());
    this.replace(el("div", { class: "empty" }, el("span", {}, text), again));
  }

  build({ groups, values, save }) {
    const readOnly = this.app.role !== "control";
    const live = new LiveValues(this.app, this.node, (now, refused) => {
      list.show(now);
      list.refuse(refused);
    });
    const list = new ParameterList(groups, readOnly, (changed) => live.set(changed));
    this.list = list;
    this.replace(list.element);
    this.tell("", "");
    this.searchRow.hidden = list.controls.size < MANY;
    this.saveButton.disabled = readOnly || !save;
    let title = "Writes the values into the node's file";
    if (readOnly) title = "You can only look.";
    else if (!save) title = "This node cannot save its parameters.";
    this.saveButton.title = title;
    this.resetButton.disabled = readOnly;
    list.show({ ...values, ...this.newer });
    this.filter();
  }

  filter() {
    if (this.list.controls.size) this.list.filter(this.search.value, this.changedOnly.checked);
  }

  reset() {
    const count = this.list.reset();
    const text = count
      ? `${count} back at their defaults, not saved yet.`
      : "All are as by default.";
    this.tell(text, "");
  }

  async save() {
    const { node } = this;
    this.saveButton.disabled = true;
    this.tell("Saving ...", "dim");
    try {
      const { message } = await this.app.connection.request("save_parameters", { node });
      this.saved(node, message || "Saved.", "good");
    } catch (error) {
      this.saved(node, error.message, "bad");
    }
  }

  /** Tells the answer in a notice if another node is looked at meanwhile. */
  saved(node, text, kind) {
    if (node !== this.node || this.closed) {
      this.app.notify(`${node}: ${text}`, kind);
      return;
    }
    this.tell(text, kind);
    this.saveButton.disabled = false;
  }

  /** @param {string} text @param {string} kind the class of its color */
  tell(text, kind) {
    setText(this.answer, text);
    this.answer.className = `answer ${kind}`;
    this.answer.hidden = !text;
  }

  close() {
    this.closed = true;
    this.leave();
    this.offs.forEach((off) => off());
  }
}

/** @type {import("./tools.js").Tool} */
export const tool = {
  name: "parameters",
  title: "Parameters",
  icon: ICONS.sliders,
  key: "p",
  missing: "A node with live parameters has to run.",
  available: (app) => nodesOf(app).length > 0,
  open: (element, app) => {
    const panel = new ParameterPanel(element, app);
    return () => panel.close();
  },
};
