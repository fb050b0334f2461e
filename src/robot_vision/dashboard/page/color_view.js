/** What the panel of colours consists of: it shows, and tells what a user does. */

import { SPACES, TITLES, cssColor, gradient, isHue } from "./color_spaces.js";
import { rangeBar } from "./range_bar.js";

const NUMBERS = ["bgr", "hsv", "hls", "lab", "ycrcb"];
const MISSING = "To use it, start hsv_tracker: it finds colours.";
const ADD = "+"; // the choice of a colour that is not there yet

export class ColorView {
  /**
   * @param {HTMLElement} element
   * @param {any} app
   * @param {Object<string, (value?: any) => any>} on chooseNode, chooseColor, choose (a new one),
   *   named, chooseSpace, range, save and undo: called when a user does that
   */
  constructor(element, app, on) {
    this.app = app;
    this.on = on;
    const { el } = app;
    this.swatch = el("div", { class: "swatch", "data-test": "swatch" });
    this.numbers = el("dl", { class: "numbers", "data-test": "color-numbers" });
    this.hint = el("p", { "data-test": "color-hint" }, "2. Click the colour in an image.");
    this.missing = el("p", { class: "empty" });
    this.node = this.menu("Node", "color-node", on.chooseNode);
    this.color = this.menu("Colour to tune", "color-name", (name) => this.chooseColor(name));
    this.color.element.classList.add("grow");
    this.space = this.menu("Space", "color-space", on.chooseSpace);
    this.newName = el("input", {
      type: "text",
      maxlength: "60",
      placeholder: "such as orange",
      "data-test": "color-new-name",
      onchange: () => on.named(),
      oninput: () => on.choose(),
    });
    const naming = el("span", {}, "Name of the new colour");
    this.naming = el("label", { class: "field" }, naming, this.newName);
    this.naming.hidden = true;
    this.add = this.button("+ New colour", "color-add", () => this.chooseColor(ADD));
    this.bars = el("div", { class: "stack" });
    this.save = this.button("Save", "color-save", on.save);
    this.save.classList.add("primary");
    this.undo = this.button("Undo", "color-undo", on.undo);
    this.answer = el("p", { class: "dim", "aria-live": "polite", "data-test": "color-answer" });
    this.choosing = this.makeChoosing();
    this.tuning = this.makeTuning();
    const seen = el("div", { class: "row" }, this.swatch, this.numbers);
    const parts = [this.missing, this.choosing, this.hint, seen, this.answer, this.tuning];
    element.append(el("div", { class: "stack" }, ...parts));
  }

  makeChoosing() {
    const { el } = this.app;
    return el(
      "div",
      { class: "stack" },
      el("p", {}, "1. Choose the colour to tune, or add one."),
      this.node.element,
      el("div", { class: "row" }, this.color.element, this.add),
      this.naming,
    );
  }

  makeTuning() {
    const { el } = this.app;
    return el(
      "div",
      { class: "stack" },
      el(
        "p",
        {},
        "3. Move the ends until the thing is tinted, and nothing else but what has the node's " +
          "other colours, and save. min_area, under Parameters, leaves specks out.",
      ),
      this.space.element,
      this.bars,
      el("div", { class: "row" }, this.save, this.undo),
    );
  }

  menu(title, test, choose) {
    const { el } = this.app;
    const select = el("select", { "data-test": test, onchange: () => choose(select.value) });
    const element = el("label", { class: "field" }, el("span", {}, title), select);
    return { element, select };
  }

  button(text, test, onclick) {
    const attributes = { class: "button", type: "button", "data-test": test, onclick };
    return this.app.el("button", attributes, text);
  }

  chooseColor(name) {
    this.naming.hidden = name !== ADD;
    if (name !== ADD) {
      this.on.chooseColor(name);
      return;
    }
    this.color.select.value = ADD;
    this.undo.disabled = false;
    this.newName.focus();
    this.on.choose();
  }

  /** The new colour is there, or not wanted any more. */
  endNaming() {
    this.naming.hidden = true;
    this.newName.value = "";
    if (this.color.select.value === ADD) this.color.select.value = this.shown;
  }

  /** @returns {string} the name of the colour to give a range to; "": a new one has none yet */
  chosenName() {
    const name = this.color.select.value;
    return name === ADD ? this.newName.value.trim() : name;
  }

  /** @param {any} picked the colour of a pixel, as the server tells it */
  showPicked(picked) {
    this.swatch.style.backgroundColor = cssColor("bgr", picked.bgr);
    this.swatch.title = `BGR ${picked.bgr.join(", ")}`;
    const { el } = this.app;
    const pairs = NUMBERS.flatMap((space) => [
      el("dt", {}, TITLES[space]),
      el("dd", { "data-space": space }, picked[space].join(", ")),
    ]);
    this.numbers.replaceChildren(...pairs);
  }

  /**
   * @param {{node: string, names: string[], shown: string}[]} trackers
   * @param {string} node the chosen one's
   * @param {{space: string, low: number[], high: number[]}|null} range
   * @param {{space: string, low: number[], high: number[]}|null} before what Undo gives back
   */
  show(trackers, node, range, before) {
    const tracker = trackers.find((one) => one.node === node);
    this.shown = tracker?.shown || "";
    this.choosing.hidden = !tracker;
    this.missing.textContent = tracker ? "" : MISSING;
    this.missing.hidden = Boolean(tracker);
    this.tuning.hidden = !tracker;
    const controls = this.app.role === "control";
    this.add.hidden = this.save.hidden = this.undo.hidden = !controls;
    if (!controls) this.hint.textContent = "Click a colour in an image. Tuning needs control.";
    if (!tracker) return;
    this.fill(this.node.select, trackers.map((one) => [one.node, one.node]), node);
    this.node.element.hidden = trackers.length < 2;
    const names = tracker.names.map((name) => [name, name]);
    const chosen = this.naming.hidden ? tracker.shown : ADD;
    this.fill(this.color.select, [...names, [ADD, "A new colour …"]], chosen);
    for (const one of [this.color.select, this.space.select, this.save]) {
      one.disabled = !controls || !range;
    }
    const same = JSON.stringify(range) === JSON.stringify(before);
    this.undo.disabled = !controls || !range || (same && this.naming.hidden);
    if (range) this.showRange(range, controls);
  }

  showRange(range, controls) {
    const { space, low, high } = range;
    this.range = range;
    this.fill(this.space.select, Object.keys(SPACES).map((name) => [name, TITLES[name]]), space);
    if (this.drawn !== `${space} ${controls}`) this.makeBars(space, controls);
    this.channels.forEach((bar, index) => {
      bar.set(low[index], high[index], gradient(space, index, range));
    });
  }

  makeBars(space, controls) {
    this.drawn = `${space} ${controls}`;
    this.channels = SPACES[space].map(([short, meaning, highest], index) => {
      const options = { name: `${short} ${meaning}`, test: String(index), highest };
      options.circular = isHue(space, index);
      options.disabled = !controls;
      return rangeBar(this.app, options, (low, high) => this.moved(index, low, high));
    });
    this.bars.replaceChildren(...this.channels.map((bar) => bar.element));
  }

  moved(index, low, high) {
    const { space } = this.range;
    const range = { space, low: [...this.range.low], high: [...this.range.high] };
    range.low[index] = low;
    range.high[index] = high;
    this.on.range(range);
  }

  /** Gives a menu its entries, if they have changed, and its choice. */
  fill(select, entries, chosen) {
    const key = JSON.stringify(entries);
    if (select.dataset.entries !== key) {
      select.dataset.entries = key;
      const options = entries.map(([value, text]) => this.app.el("option", { value }, text));
      select.replaceChildren(...options);
    }
    select.value = chosen;
  }

  /** @param {string} text @param {string} [kind] info, good or bad */
  tell(text, kind = "info") {
    this.answer.textContent = text;
    this.answer.className = `color-answer ${kind}`;
    if (text) this.answer.scrollIntoView({ block: "nearest" });
  }
}
