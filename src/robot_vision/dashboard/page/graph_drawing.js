/**
 * The drawing of the graph: nodes and topics in layers, from what gives images to what uses
 * results.
 */

import { svg } from "./dom.js";
import { layoutGraph } from "./graph_layout.js";

const ROW = 34; // px from one to the next
const HEIGHT = 24;
const LETTER = { node: 7.4, topic: 6.6 }; // px of a letter, about
const SPACE = 46; // px between layers
const MAX_LETTERS = 30;
const SMALLEST = 0.65; // of its size, that it is made smaller to fit; then it is scrolled

/** @param {string} name */
function shortName(name) {
  const text = name.replace(/^\//, "");
  return text.length > MAX_LETTERS ? "…" + text.slice(1 - MAX_LETTERS) : text;
}

/** Places of all items in px. */
function place(items) {
  const widths = [];
  const counts = [];
  for (const item of items) {
    item.text = shortName(item.name);
    item.width = item.text.length * LETTER[item.kind] + (item.kind === "node" ? 30 : 18);
    widths[item.layer] = Math.max(widths[item.layer] || 0, item.width);
    counts[item.layer] = (counts[item.layer] || 0) + 1;
  }
  const height = Math.max(...counts) * ROW;
  const lefts = [8];
  widths.forEach((width, layer) => (lefts[layer + 1] = lefts[layer] + width + SPACE));
  for (const item of items) {
    item.x = lefts[item.layer];
    item.y = (height - counts[item.layer] * ROW) / 2 + item.place * ROW + ROW / 2 + 4;
  }
  return { width: lefts[widths.length] - SPACE + 8, height: height + 8 };
}

function edgePath(from, to) {
  const [x1, y1, x2, y2] = [from.x + from.width, from.y, to.x, to.y];
  const bend = Math.max(24, Math.abs(x2 - x1) / 2);
  return `M${x1} ${y1}C${x1 + bend} ${y1} ${x2 - bend} ${y2} ${x2} ${y2}`;
}

/**
 * @typedef {Object} Shown of the graph
 * @property {any[]} topics
 * @property {string[]} nodes
 * @property {boolean} all nodes without a topic, too
 * @property {import("./graph_rates.js").GraphRates} rates
 * @property {string} chosen "n" or "t", and the name
 * @property {(node: string) => string} levelOf the class of the color of its state
 * @property {(id: string) => void} choose
 */

/**
 * @param {Shown} shown
 * @returns {SVGElement}
 */
export function drawGraph({ topics, nodes, all, rates, chosen, levelOf, choose }) {
  const { items, edges } = layoutGraph(topics, nodes, all);
  const { width, height } = place(items);
  const byId = new Map(items.map((item) => [item.id, item]));
  const near = new Set(
    edges.flatMap(([from, to]) => (from === chosen || to === chosen ? [from, to] : [])),
  );
  const lines = edges.map(([from, to]) =>
    svg("path", {
      d: edgePath(byId.get(from), byId.get(to)),
      class: from === chosen || to === chosen ? "edge near" : "edge",
    }),
  );
  const boxes = items.map((item) => {
    const { id, kind, name, x, y } = item;
    const rate = kind === "topic" && rates.get(name);
    const state = kind === "node" ? levelOf(name) : "";
    return svg(
      "g",
      {
        class: ["item", kind, id === chosen && "chosen", near.size && !near.has(id) && "far"]
          .filter(Boolean)
          .join(" "),
        tabindex: 0,
        role: "button",
        "aria-label": `${kind} ${name} ${rate || ""}`,
        "data-id": id,
        onclick: () => choose(id),
        onkeydown: (event) => {
          if (event.key !== "Enter" && event.key !== " ") return;
          event.preventDefault();
          choose(id);
        },
      },
      svg("title", {}, rate ? `${name}\n${rate}` : name),
      svg("rect", {
        x,
        y: y - HEIGHT / 2,
        width: item.width,
        height: HEIGHT,
        rx: kind === "node" ? 6 : HEIGHT / 2,
      }),
      kind === "node" && svg("circle", { cx: x + 12, cy: y, r: 4, class: state }),
      svg("text", { x: x + (kind === "node" ? 22 : 9), y: y + 4 }, item.text),
      rate && svg("text", { x: x + item.width / 2, y: y + 21, class: "rate" }, rate.split(",")[0]),
    );
  });
  const drawing = svg(
    "svg",
    { width, height, viewBox: `0 0 ${width} ${height}`, class: "graph-drawing" },
    lines,
    boxes,
  );
  drawing.style.minWidth = `${SMALLEST * width}px`;
  return drawing;
}
