/** The lines of the log as the page shows them. */

import { el } from "./dom.js";
import { isSimulated } from "./stamps.js";

export const LEVELS = {
  1: ["debug", "dim"],
  2: ["info", ""],
  4: ["warning", "warn"],
  8: ["error", "bad"],
  16: ["fatal", "bad"],
};

/** @param {number} stamp s */
function clockTime(stamp) {
  if (isSimulated(stamp)) return `${stamp.toFixed(3)} s`;
  const time = new Date(stamp * 1000);
  const two = (value) => String(value).padStart(2, "0");
  const ms = String(time.getMilliseconds()).padStart(3, "0");
  return `${two(time.getHours())}:${two(time.getMinutes())}:${two(time.getSeconds())}.${ms}`;
}

/**
 * @param {any[]} entries
 * @returns {number} how many lines these are, with those that are missing
 */
export function countOf(entries) {
  return entries.reduce((count, { left_out }) => count + (left_out || 1), 0);
}

/**
 * @param {any} entry a line of the log, or {left_out}: so many are missing there
 * @returns {HTMLElement}
 */
export function rowOf(entry) {
  if (entry.left_out) {
    const lines = entry.left_out === 1 ? "1 line is" : `${entry.left_out} lines are`;
    const attributes = { class: "log-gap warn", "data-test": "log-gap" };
    return el("div", attributes, `${lines} left out here: more came than is shown`);
  }
  const [name, kind] = LEVELS[entry.level] || LEVELS[2];
  return el(
    "div",
    {
      class: `log-line ${kind}`,
      title: [entry.function, entry.file && `${entry.file}:${entry.line}`]
        .filter(Boolean)
        .join("  "),
    },
    el("time", {}, clockTime(entry.stamp)),
    el("span", { class: "log-level" }, name),
    el("span", { class: "log-node" }, entry.node.replace(/^\//, "")),
    el("span", { class: "log-text" }, entry.text),
  );
}
