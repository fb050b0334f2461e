/** The second step of a calibration: the board is shown, and views of it are kept. */

import { KINDS } from "./board_picture.js";
import { el, setText } from "./dom.js";

const CELLS = 80; // of the image, in which it is told whether the board was there
const BARS = {
  x: ["Left to right", "Show the board at the left and at the right border."],
  y: ["Top to bottom", "Show the board at the upper and at the lower border."],
  size: ["Near", "Hold the board so near that it fills much of the image."],
  skew: ["Tilted", "Tilt the board, to all sides."],
};
const LINE = "#3ddc97";
const POINT = "#ffb000";
const CASING = "rgb(0 0 0 / 55%)";

export class ViewsStep {
  /** @param {any} panel */
  constructor(panel) {
    this.panel = panel;
    const { state } = panel;
    this.words = el("p", { class: "said", role: "status", "data-test": "calibration-state" });
    this.views = el("p", { "data-test": "calibration-views" });
    this.bars = new Map(Object.keys(BARS).map((name) => [name, this.bar(name)]));
    this.cells = Array.from({ length: CELLS }, () => el("i"));
    this.tip = el("p", { class: "dim small-text" });
    const solve = () => panel.ask("calibration_solve", {});
    this.solve = panel.button("Compute the camera", "calibration-solve", solve);
    const grid = { class: "coverage", role: "img", "data-test": "calibration-coverage" };
    const label = "Parts of the image in which the board was seen";
    this.coverage = el("div", { ...grid, "aria-label": label }, this.cells);
    this.element = el(
      "div",
      { class: "stack" },
      el("p", {}, "Show the board all over the image, near and far, tilted, and hold it still."),
      this.words,
      el(
        "div",
        { class: "stack tight-stack" },
        [...this.bars.values()].map(({ row }) => row),
      ),
      this.tip,
      this.views,
      panel.buttons(this.solve, panel.stopButton()),
      el("h3", {}, "Where the board has been"),
      this.coverage,
      el("p", { class: "dim small-text" }, `${state.topic}: ${boardText(state.settings)}`),
    );
  }

  bar(name) {
    const [title, hint] = BARS[name];
    const fill = el("div");
    const share = el("span", { class: "mono dim" });
    const row = { class: "bar-row", title: hint, "data-test": `calibration-bar-${name}` };
    const meter = el("div", { class: "meter" }, fill);
    return { fill, share, row: el("div", row, el("span", {}, title), meter, share) };
  }

  /** @param {any} state */
  show(state) {
    setText(this.words, state.state);
    this.words.classList.toggle("good", /^kept|enough/.test(state.state));
    for (const [name, { fill, share, row }] of this.bars) {
      const value = state.progress[name];
      fill.style.width = `${100 * value}%`;
      row.classList.toggle("full", value >= 1);
      setText(share, `${Math.round(100 * value)} %`);
    }
    const seen = state.coverage.flat();
    this.cells.forEach((cell, index) => cell.classList.toggle("seen", Boolean(seen[index])));
    if (state.size[0]) this.coverage.style.aspectRatio = state.size.join(" / ");
    setText(this.views, viewsText(state));
    const names = Object.keys(BARS);
    const lacking = names.reduce((a, b) => (state.progress[b] < state.progress[a] ? b : a));
    setText(this.tip, state.enough ? "All that is needed has been shown." : BARS[lacking][1]);
    this.solve.disabled = state.views < state.needed || state.solving;
    setText(this.solve, state.solving ? "Computing ..." : "Compute the camera");
    this.solve.classList.toggle("primary", state.enough);
  }
}

function viewsText({ views, needed, enough }) {
  const count = `${views} ${views === 1 ? "view" : "views"}`;
  if (views < needed) return `${count}, ${needed} are needed at least`;
  return enough ? `${count}, which is enough` : `${count}, more make it better`;
}

/** @param {any} settings @returns {string} what is looked for */
export function boardText({ kind, columns, rows, square }) {
  return `${KINDS[kind].title}, ${columns} x ${rows}, ${Number((square * 1000).toFixed(3))} mm`;
}

/**
 * Draws the points of a board in the order in which they are counted.
 * @param {CanvasRenderingContext2D} context its unit is a pixel of the image
 * @param {number} scale px of the canvas for one of the image
 * @param {number[][]} corners px of the image
 */
export function drawCorners(context, scale, corners) {
  if (!corners?.length) return;
  const unit = devicePixelRatio / scale;
  context.beginPath();
  corners.forEach(([x, y], index) => context[index ? "lineTo" : "moveTo"](x + 0.5, y + 0.5));
  for (const [width, color] of /** @type {[number, string][]} */ ([
    [3, CASING],
    [1.5, LINE],
  ])) {
    Object.assign(context, { lineWidth: width * unit, strokeStyle: color });
    context.stroke();
  }
  context.fillStyle = POINT;
  for (const [x, y] of corners) {
    context.fillRect(x + 0.5 - 2 * unit, y + 0.5 - 2 * unit, 4 * unit, 4 * unit);
  }
}
