/** A picture of a calibration board, with what is counted and measured on it. */

import { svg } from "./dom.js";

const MAX_COUNT = 24; // rows and columns that are drawn; more could not be told apart

/** What each kind of board is called, and what is counted and measured on it. */
export const KINDS = {
  chessboard: {
    title: "Chessboard",
    columns: "Corners across",
    rows: "Corners down",
    square: "Square, mm",
    words: "Count the corners where four squares meet, and measure the side of a square.",
  },
  circles: {
    title: "Circles",
    columns: "Circles across",
    rows: "Circles down",
    square: "Distance, mm",
    words: "Count the circles; measure from the middle of one to the middle of the next.",
  },
  acircles: {
    title: "Circles in shifted rows",
    columns: "Circles in a row",
    rows: "Rows",
    square: "Row to row, mm",
    words: "Count the circles of one row, and all rows, the shifted ones, too.",
  },
  charuco: {
    title: "ChArUco",
    columns: "Squares across",
    rows: "Squares down",
    square: "Square, mm",
    words: "Count all squares, black and white ones, and measure a side.",
  },
};

/**
 * @param {string} kind
 * @param {number} columns
 * @param {number} rows
 * @returns {SVGElement} the board, what is counted in orange, and the length that is measured
 */
export function boardPicture(kind, columns, rows) {
  const [across, down] = [columns, rows].map((count) =>
    Math.max(1, Math.min(Math.round(count) || 1, MAX_COUNT)),
  );
  const draw = kind.endsWith("circles") ? circles : squares;
  const { parts, width, height, from, to } = draw(kind, across, down);
  const unit = Math.max(width, height) / 16;
  const y = -0.55 * unit;
  const ends = [from, to].map((x) => `M${x} ${y - 0.3 * unit}v${0.6 * unit}`).join("");
  const margin = 1.1 * unit;
  return svg(
    "svg",
    {
      class: "board-picture",
      role: "img",
      "aria-label": `${KINDS[kind].title} of ${columns} by ${rows}`,
      viewBox: [-margin, -1.4 * margin, width + 2 * margin, height + 2.4 * margin].join(" "),
    },
    svg("rect", {
      class: "paper",
      x: -0.3 * unit,
      y: -0.2 * unit,
      width: width + 0.6 * unit,
      height: height + 0.4 * unit,
    }),
    parts,
    svg("path", { class: "measure", "stroke-width": 0.16 * unit, d: `M${from} ${y}H${to}${ends}` }),
  );
}

function squares(kind, columns, rows) {
  const [across, down] = kind === "charuco" ? [columns, rows] : [columns + 1, rows + 1];
  let black = "";
  let markers = "";
  const dots = [];
  for (let y = 0; y < down; y++) {
    for (let x = 0; x < across; x++) {
      if ((x + y) % 2 === 0) black += `M${x} ${y}h1v1h-1z`;
      else if (kind === "charuco")
        markers += `M${x + 0.2} ${y + 0.2}h.6v.6h-.6zM${x + 0.4} ${y + 0.3}v.2h.3v-.2z`;
      if (kind !== "charuco" && x > 0 && y > 0) {
        dots.push(
          svg("circle", { class: y === 1 || x === 1 ? "counted" : "point", cx: x, cy: y, r: 0.15 }),
        );
      }
    }
  }
  const frame =
    kind === "charuco"
      ? svg("path", { class: "measure", "stroke-width": 0.1, d: `M0 0H${across}M0 0V${down}` })
      : null;
  const parts = [
    svg("path", { class: "ink", d: black }),
    svg("path", { class: "ink", d: markers, "fill-rule": "evenodd" }),
    frame,
    dots,
  ];
  return { parts, width: across, height: down, from: 0, to: 1 };
}

function circles(kind, columns, rows) {
  const shifted = kind === "acircles";
  const parts = [];
  for (let y = 0; y < rows; y++) {
    for (let x = 0; x < columns; x++) {
      const cx = shifted ? 2 * x + (y % 2) + 0.5 : x + 0.5;
      parts.push(
        svg("circle", { class: y === 0 || x === 0 ? "counted" : "ink", cx, cy: y + 0.5, r: 0.28 }),
      );
    }
  }
  return { parts, width: shifted ? 2 * columns : columns, height: rows, from: 0.5, to: 1.5 };
}
