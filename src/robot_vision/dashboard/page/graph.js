/** The panel that shows which nodes run, and by which topics they are connected. */

import { el, setText, textButton } from "./dom.js";
import { GraphDetails, levelClass } from "./graph_details.js";
import { drawGraph } from "./graph_drawing.js";
import { shownTopics } from "./graph_layout.js";
import { listGraph } from "./graph_list.js";
import { GraphRates } from "./graph_rates.js";
import { ICONS } from "./icons.js";

class GraphPanel {
  /** @param {HTMLElement} element @param {any} app */
  constructor(element, app) {
    this.app = app;
    this.rates = new GraphRates(app);
    this.chosen = ""; // "n" or "t", and the name
    this.drawn = "";
    const redraw = () => this.draw();
    this.all = el("input", { type: "checkbox", onchange: redraw });
    const phone = matchMedia("(max-width: 699px)").matches;
    this.asList = el("input", {
      type: "checkbox",
      checked: app.storage.get("graph_list", phone),
      onchange: () => {
        app.storage.set("graph_list", this.asList.checked);
        redraw();
      },
    });
    this.search = el("input", {
      type: "search",
      class: "grow",
      placeholder: "Search",
      "aria-label": "Search the graph",
      oninput: redraw,
    });
    this.measureButton = textButton("Measure rates", () => this.measureAll(), {
      title: "Listens to each topic shown for two seconds",
    });
    this.picture = el("div", { class: "graph" });
    this.details = new GraphDetails(app, this.rates, (id) => this.choose(id));
    element.classList.add("filled");
    element.append(
      el(
        "div",
        { class: "row" },
        this.search,
        el("label", { class: "row tight" }, this.all, "all topics"),
        el("label", { class: "row tight" }, this.asList, "list"),
        this.measureButton,
      ),
      this.picture,
      this.details.element,
    );
    this.offs = [app.on("graph", () => this.update())];
    this.draw();
  }

  /** Draws again only if something is another. */
  update() {
    const { nodes, topics } = this.app.graph;
    const key = JSON.stringify([topics, nodes.map(({ name, status }) => [name, status?.level])]);
    if (key !== this.drawn) this.draw();
    this.drawn = key;
    if (this.chosen) this.showDetails();
  }

  topics() {
    const word = this.search.value.trim().toLowerCase();
    const own = this.app.connection.hello?.node;
    const shown = shownTopics(this.app.graph?.topics || [], this.all.checked, own);
    if (!word) return shown;
    return shown.filter(({ name, publishers, subscribers }) =>
      [name, ...publishers, ...subscribers].some((text) => text.toLowerCase().includes(word)),
    );
  }

  levelOf(name) {
    return levelClass((this.app.graph?.nodes || []).find((node) => node.name === name)?.status);
  }

  /** Draws anew; what has the focus has it afterwards, too. */
  draw() {
    const focused = /** @type {any} */ (document.activeElement)?.dataset?.id;
    this.picture.replaceChildren(this.made());
    if (focused) this.picture.querySelector(`[data-id="${CSS.escape(focused)}"]`)?.focus();
  }

  /** @returns {Element} the drawing, the list, or why there is none */
  made() {
    const { search, all, asList, rates, chosen } = this;
    const topics = this.topics();
    const nodes = search.value ? [] : (this.app.graph?.nodes || []).map(({ name }) => name);
    if (!topics.length && !(all.checked && nodes.length)) {
      const nobody = 'Nobody listens to anybody yet. "all topics" shows what there is.';
      return el("div", { class: "empty" }, search.value ? "Nothing fits." : nobody);
    }
    const shown = {
      topics,
      nodes,
      all: all.checked,
      rates,
      chosen,
      levelOf: (name) => this.levelOf(name),
      choose: (id) => this.choose(id),
    };
    return asList.checked ? listGraph(shown) : drawGraph(shown);
  }

  choose(id) {
    this.chosen = id === this.chosen ? "" : id;
    this.draw();
    this.showDetails();
  }

  showDetails() {
    this.details.show(this.chosen);
  }

  async measureAll() {
    this.measureButton.disabled = true;
    const topics = this.topics();
    for (const [index, { name }] of topics.entries()) {
      if (this.closed) return;
      setText(this.measureButton, `${index + 1} of ${topics.length} ...`);
      await this.rates.measure(name);
      this.draw();
    }
    setText(this.measureButton, "Measure rates");
    this.measureButton.disabled = false;
  }

  close() {
    this.closed = true;
    this.offs.forEach((off) => off());
  }
}

/** @type {import("./tools.js").Tool} */
export const tool = {
  name: "graph",
  title: "Graph",
  icon: ICONS.graph,
  key: "g",
  wide: true,
  available: (app) => Boolean(app.graph),
  missing: "It is here as soon as the dashboard has told what runs.",
  open: (element, app) => {
    const panel = new GraphPanel(element, app);
    return () => panel.close();
  },
};
