/** The numbers below an image: what its node tells, and what the page measures itself. */

import { el, setText } from "./dom.js";

/** Name, unit, and what it means. */
const NUMBERS = {
  rate: ["rate", "Hz", "Images that the node works on in a second"],
  processing: ["takes", "ms", "Time that the node needs for an image"],
  age: ["age", "ms", "How old an image is when the node is done with it"],
  shown: ["shown", "Hz", "Images that this page draws in a second"],
  delay: ["delay", "ms", "From the dashboard's getting an image until it was drawn here"],
  size: ["size", "", "Width and height of the original image in pixels"],
};

/** @param {number|null|undefined} value */
function digits(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  return value >= 100 ? value.toFixed(0) : value.toFixed(1);
}

export class TileNumbers {
  constructor() {
    this.values = {};
    const cells = Object.entries(NUMBERS).map(([name, [label, unit, meaning]]) => {
      const value = el("span", { "data-test": "number-" + name }, "–");
      this.values[name] = value;
      return el(
        "div",
        { class: "number " + name, title: unit ? `${meaning} (${unit})` : meaning },
        el("dt", {}, label),
        el("dd", {}, value, unit && el("small", {}, " " + unit)),
      );
    });
    this.element = el("dl", { class: "tile-numbers" }, cells);
  }

  /**
   * @param {any} status of the node, or null
   * @param {import("./image_view.js").ImageView} view
   */
  update(status, view) {
    const shown = view.frameRate(performance.now());
    const texts = {
      rate: digits(status?.rate),
      processing: digits(status?.processing),
      age: digits(status?.age),
      shown: view.drawn ? digits(shown) : "–",
      delay: shown > 0 ? String(Math.max(0, Math.round(view.latency))) : "–",
      size: view.size[0] ? `${view.size[0]}×${view.size[1]}` : "–",
    };
    for (const [name, text] of Object.entries(texts)) setText(this.values[name], text);
  }
}
