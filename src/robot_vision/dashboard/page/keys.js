/** Shortcuts of the whole page, and the window that lists them. */

import { el, iconButton } from "./dom.js";
import { ICONS } from "./icons.js";

/**
 * @typedef {Object} Shortcut
 * @property {string} key KeyboardEvent.key, with "Shift+" or "Alt+" before it
 * @property {string} text what it does; shortcuts of the same text share a line
 * @property {() => void|boolean} run false: it was not for this
 */

/** @type {Shortcut[]} */
const shortcuts = [];

/**
 * @param {string} key
 * @param {string} text
 * @param {() => void|boolean} run
 */
export function shortcut(key, text, run) {
  shortcuts.push({ key, text, run });
}

/** @param {any} target */
function takesText(target) {
  return target.matches?.(
    "textarea, select, [contenteditable], input:not([type=checkbox], [type=range])",
  );
}

/** @param {KeyboardEvent} event */
function name(event) {
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const shifted = event.shiftKey && event.key.length > 1;
  return (event.altKey ? "Alt+" : "") + (shifted ? "Shift+" : "") + key;
}

/** @param {KeyboardEvent} event */
function pressed(event) {
  const target = /** @type {any} */ (event.target);
  if (event.defaultPrevented || event.ctrlKey || event.metaKey) return;
  if (event.key === "Escape" && takesText(target)) {
    target.blur();
    return;
  }
  if (takesText(target) || document.querySelector("dialog[open]")) return;
  const ownKeys =
    target.matches?.("button, a, input, summary") && ["Enter", " "].includes(event.key);
  const slider = target.matches?.("input[type=range]") && event.key.startsWith("Arrow");
  const menu = target.closest?.(".menu, [role=tablist]");
  if (ownKeys || slider || (menu && event.key !== "Escape")) return;
  for (const { key, run } of shortcuts) {
    if (key === name(event) && run() !== false) {
      event.preventDefault();
      return;
    }
  }
}

const WORDS = { ArrowLeft: "←", ArrowRight: "→", ArrowUp: "↑", ArrowDown: "↓", Escape: "Esc" };

/** Shows all shortcuts. */
export function showHelp() {
  const lines = new Map();
  for (const { key, text } of shortcuts) {
    if (!lines.has(text)) lines.set(text, []);
    lines.get(text).push(key);
  }
  const rows = [...lines].map(([text, keys]) =>
    el(
      "div",
      { class: "shortcut" },
      el(
        "span",
        {},
        keys.map((key) => [
          el(
            "kbd",
            {},
            key.replace(/\w+$/, (word) => WORDS[word] || word),
          ),
          " ",
        ]),
      ),
      el("span", {}, text),
    ),
  );
  const dialog = el(
    "dialog",
    { class: "dialog", "aria-label": "Keyboard shortcuts", onclose: () => dialog.remove() },
    el(
      "div",
      { class: "row" },
      el("h2", { class: "grow" }, "Keyboard"),
      iconButton(ICONS.close, "Close", () => dialog.close()),
    ),
    el("div", { class: "shortcuts" }, rows),
  );
  dialog.onclick = (event) => event.target === dialog && dialog.close();
  document.body.append(dialog);
  dialog.showModal();
}

/** Begins to listen. */
export function listenToKeys() {
  shortcut("?", "These shortcuts", showHelp);
  document.addEventListener("keydown", pressed);
}
