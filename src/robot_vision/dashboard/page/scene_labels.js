/** Words over the view in space. */

import { el, setText } from "./dom.js";
import { transform } from "./gl_matrices.js";

const MAX_LABELS = 150;
const [LETTER, MAX_LETTERS, MARGIN, LINE] = [7, 26, 8, 16]; // CSS px, about, but the second

/**
 * Words that would cover others are left out until one looks from nearer; the first have the place.
 * @param {HTMLElement} parent
 * @param {[{at: number[], text: string, color: string}, number[]][]} labels each with the matrix
 *   from its frame to the view
 * @param {number} width CSS px of the view
 * @param {number} height
 */
export function showLabels(parent, labels, width, height) {
  const placed = [];
  for (const [{ at, text, color }, view] of labels) {
    const [px, py, , w] = transform(view, at);
    if (w <= 0 || Math.abs(px) > w || Math.abs(py) > w || placed.length >= MAX_LABELS) continue;
    const [x, y] = [((px / w + 1) / 2) * width, ((1 - py / w) / 2) * height];
    const length = LETTER * Math.min(text.length, MAX_LETTERS) + MARGIN;
    const covers = (one) =>
      Math.abs(one.y - y) < LINE && x < one.x + one.length && one.x < x + length;
    if (placed.some(covers)) continue;
    const span = parent.children[placed.length] || parent.appendChild(el("span"));
    placed.push({ x, y, length });
    setText(span, text);
    Object.assign(span, { hidden: false });
    Object.assign(/** @type {HTMLElement} */ (span).style, {
      color,
      transform: `translate(${x}px, ${y}px)`,
    });
  }
  for (const span of [...parent.children].slice(placed.length))
    Object.assign(span, { hidden: true });
}
