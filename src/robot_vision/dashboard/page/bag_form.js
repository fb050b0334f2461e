/** The form that starts a recording: topics, name and limits. */

import { offers, requested } from "./bag_offers.js";
import { el, setText } from "./dom.js";

const MAX_TOPICS = 200;

export class BagForm {
  /**
   * @param {any} app
   * @param {(fields: any) => Promise<void>} record
   */
  constructor(app, record) {
    this.app = app;
    this.chosen = new Set(app.storage.get("bags.topics", []));
    this.offered = new Set();
    /** @type {import("./bag_offers.js").Offer[]} */
    this.images = [];
    this.shown = "";
    this.recordTopics = record;
    this.build();
    this.show();
  }

  build() {
    const field = (label, input) =>
      el("label", { class: "field grow" }, el("span", {}, label), input);
    const number = (test, attributes) =>
      el("input", { type: "number", step: 1, "data-test": test, ...attributes });
    this.first = el("div", { class: "checks" });
    this.others = el("div", { class: "checks" });
    const search = { type: "search", placeholder: "Find a topic", "aria-label": "Find a topic" };
    this.filter = el("input", { ...search, oninput: () => this.show(true) });
    const named = { type: "text", maxlength: 96, placeholder: "named by the time" };
    this.name = el("input", { ...named, "data-test": "bag-name" });
    this.megabytes = number("bag-megabytes", { min: 1 });
    this.seconds = number("bag-seconds", { min: 0, placeholder: "no limit" });
    this.button = el("button", {
      type: "submit",
      class: "button primary",
      "data-test": "bag-record",
    });
    const all = el("details", { "data-test": "bag-all-topics" });
    all.append(el("summary", {}, "All topics"), this.filter, this.others);
    this.element = el(
      "form",
      { class: "stack", onsubmit: (event) => this.start(event) },
      el("h3", {}, "What is recorded"),
      this.first,
      all,
      field("Name", this.name),
      el(
        "div",
        { class: "row tight" },
        field("At most, MB", this.megabytes),
        field("At most, s", this.seconds),
      ),
      this.button,
    );
  }

  /** @param {number} megabytes the largest limit */
  setLimit(megabytes) {
    if (!this.megabytes.value) this.megabytes.value = String(megabytes);
    this.megabytes.max = String(megabytes);
  }

  /** @param {boolean} [anyway] though the topics are the same */
  show(anyway = false) {
    const { first, others } = offers(this.app.graph?.topics || []);
    const shown = JSON.stringify([first, others]);
    if (shown === this.shown && !anyway) return;
    this.shown = shown;
    this.images = first;
    this.offered = new Set([...first, ...others].map((one) => one.key));
    this.first.replaceChildren(...first.map((one) => this.row(one)));
    if (!first.length) this.first.append(el("p", { class: "dim" }, "No images are published now."));
    const words = this.filter.value.toLowerCase();
    const found = others.filter((one) => one.label.toLowerCase().includes(words));
    this.others.replaceChildren(...found.map((one) => this.row(one)));
    this.showCount();
  }

  row({ key, label, note, beside }) {
    const box = el("input", {
      type: "checkbox",
      checked: this.chosen.has(key),
      "data-test": "bag-topic",
      "data-name": key,
      onchange: () => this.choose(key, beside, box.checked),
    });
    return el(
      "label",
      { class: "check", title: label },
      box,
      el("span", { class: "ellipsis grow" }, label),
      el("span", { class: "dim small-text" }, note),
    );
  }

  /**
   * @param {string} key
   * @param {string[]} beside keys that are chosen with it, and go unless another one needs them
   * @param {boolean} on
   */
  choose(key, beside, on) {
    this.chosen[on ? "add" : "delete"](key);
    const images = this.images.filter((one) => this.chosen.has(one.key));
    const needed = new Set(images.flatMap((one) => one.beside));
    for (const other of beside) {
      if (on) this.chosen.add(other);
      else if (!needed.has(other)) this.chosen.delete(other);
    }
    for (const box of this.element.querySelectorAll("[data-test=bag-topic]")) {
      box.checked = this.chosen.has(box.dataset.name);
    }
    this.app.storage.set("bags.topics", [...this.chosen].slice(-MAX_TOPICS));
    this.showCount();
  }

  wanted() {
    return [...this.chosen].filter((key) => this.offered.has(key));
  }

  showCount() {
    const count = this.wanted().length;
    this.button.disabled = count === 0;
    const topics = count === 1 ? "topic" : "topics";
    setText(this.button, count ? `Record ${count} ${topics}` : "Choose what to record");
  }

  async start(event) {
    event.preventDefault();
    const fields = { ...requested(this.wanted()), name: this.name.value };
    if (this.megabytes.value) fields.max_megabytes = Number(this.megabytes.value);
    if (this.seconds.value) fields.max_seconds = Number(this.seconds.value);
    this.button.disabled = true;
    await this.recordTopics(fields);
    this.showCount();
  }
}
