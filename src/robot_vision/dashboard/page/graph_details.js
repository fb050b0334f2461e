/** What is known of a node or a topic of the graph. */

import { el, setText, textButton } from "./dom.js";

const LEVELS = ["good", "warn", "bad", "bad"];
const SMALL = { class: "button small" };

/** @param {any} status of a node, or null @returns {string} the class of its color */
export function levelClass(status) {
  return status ? LEVELS[status.level] || "bad" : "";
}

export class GraphDetails {
  /**
   * @param {any} app
   * @param {import("./graph_rates.js").GraphRates} rates
   * @param {(id: string) => void} choose
   */
  constructor(app, rates, choose) {
    this.app = app;
    this.rates = rates;
    this.choose = choose;
    this.chosen = "";
    this.shown = "";
    this.row = null; // of the topic that is chosen: what is measured stays while the graph changes
    this.element = el("div", {
      class: "graph-details stack",
      hidden: true,
      "data-test": "graph-details",
    });
  }

  /** @param {string} chosen "n" or "t", and the name; "" for nothing */
  show(chosen) {
    if (chosen !== this.chosen) this.row = null;
    this.chosen = chosen;
    this.element.hidden = !chosen;
    if (!chosen) {
      this.shown = "";
      return;
    }
    const isNode = chosen[0] === "n";
    const name = chosen.slice(1);
    const { nodes, topics } = this.app.graph;
    const found = (isNode ? nodes : topics).find((one) => one.name === name);
    const gone = () => [el("p", { class: "dim" }, "It has gone.")];
    const parts = found ? (isNode ? this.node(found) : this.topic(found)) : gone();
    const told = parts.filter((part) => part !== this.row).map((part) => part.textContent);
    const text = [chosen, ...told].join("\n");
    if (text === this.shown) return; // what is the same stays, and with it the focus
    this.shown = text;
    this.element.replaceChildren(el("h2", { class: "mono" }, name), ...parts);
  }

  names(title, names, kind) {
    if (!names.length) return null;
    const attributes = { class: "graph-line mono ellipsis" };
    const lines = names.map((name) => textButton(name, () => this.choose(kind + name), attributes));
    return el("div", {}, el("h3", {}, title), lines);
  }

  node({ name, status, parameters, subscribes, publishes }) {
    const openParameters = () => {
      this.app.select(name);
      this.app.panels.open("parameters");
    };
    const values = Object.entries(status?.values || {});
    const terms = values.map(([key, value]) => [el("dt", {}, key), el("dd", {}, value)]);
    return [
      status && el("div", { class: levelClass(status) }, status.message),
      parameters && el("div", {}, textButton("Parameters", openParameters, SMALL)),
      terms.length && el("dl", { class: "values" }, terms),
      this.names("Subscribes to", subscribes, "t"),
      this.names("Publishes", publishes, "t"),
    ].filter(Boolean);
  }

  topic({ name, type, image, publishers, subscribers }) {
    this.row ??= this.topicRow(name, image);
    return [
      el("div", { class: "mono dim" }, type),
      this.row,
      this.names("Published by", publishers, "n"),
      this.names("Subscribed by", subscribers, "n"),
    ].filter(Boolean);
  }

  /** What can be done with a topic. */
  topicRow(name, image) {
    const rate = el("span", { class: "dim" }, this.rates.get(name));
    const measure = async (event) => {
      event.target.disabled = true;
      setText(rate, "measuring ...");
      setText(rate, await this.rates.measure(name));
      event.target.disabled = false;
    };
    const row = el("div", { class: "row" }, textButton("Measure the rate", measure, SMALL));
    if (image) row.append(textButton("Show the image", () => this.app.tiles.addTopic(name), SMALL));
    row.append(rate);
    return row;
  }
}
