/**
 * Pixels of the screen and of images. Nothing here knows the page, so that it is tested by itself.
 */

/**
 * @typedef {Object} Point
 * @property {number} x
 * @property {number} y
 */

/**
 * @typedef {Object} Region px of an image
 * @property {number} x
 * @property {number} y
 * @property {number} width
 * @property {number} height
 */

// Px, few, so that tiles share their streams.
const WIDTH_STEPS = [320, 480, 640, 960, 1280, 1920, 2560];
// An image that is larger by less is not made smaller first: that would cost more than it saves.
const MAX_SCALING = 1.6;

/** @param {number} value @param {number} low @param {number} high */
export function clamp(value, low, high) {
  return Math.min(high, Math.max(low, value));
}

/**
 * The place in an image that is shown at a place of the window.
 * @param {Point} point CSS px in the window
 * @param {{left: number, top: number, width: number, height: number}} rect where the whole image
 *   is shown
 * @param {[number, number]} size px of the image
 * @returns {Point} px from the image's top left corner, fractions included, always inside of it
 */
export function toImage(point, rect, size) {
  const x = ((point.x - rect.left) / (rect.width || 1)) * size[0];
  const y = ((point.y - rect.top) / (rect.height || 1)) * size[1];
  return { x: clamp(x, 0, size[0]), y: clamp(y, 0, size[1]) };
}

/**
 * The pixel that contains a point.
 * @param {Point} point px, fractions included
 * @param {[number, number]} size
 * @returns {Point}
 */
export function pixelAt(point, size) {
  return {
    x: clamp(Math.floor(point.x), 0, Math.max(0, size[0] - 1)),
    y: clamp(Math.floor(point.y), 0, Math.max(0, size[1] - 1)),
  };
}

/**
 * The pixels of a rectangle that was dragged, both its ends included.
 * @param {Point} from
 * @param {Point} to
 * @param {[number, number]} size
 * @returns {Region} at least one pixel, inside of the image
 */
export function regionBetween(from, to, size) {
  const a = pixelAt({ x: Math.min(from.x, to.x), y: Math.min(from.y, to.y) }, size);
  const b = pixelAt({ x: Math.max(from.x, to.x), y: Math.max(from.y, to.y) }, size);
  return { x: a.x, y: a.y, width: b.x - a.x + 1, height: b.y - a.y + 1 };
}

/**
 * The width to ask for.
 * @param {number} shown px of the screen
 * @param {number} original px of the image; 0: not known yet
 * @returns {number} px; 0: as it is
 */
export function widthStep(shown, original) {
  if (original && original <= shown * MAX_SCALING) return 0;
  const step = WIDTH_STEPS.find((width) => width >= shown * 0.95) || 0;
  return original && step >= original ? 0 : step;
}

/**
 * The larger of two widths to ask for.
 * @param {number} a px; 0: as it is, the largest of all
 * @param {number} b
 */
export function widerStep(a, b) {
  return a === 0 || b === 0 ? 0 : Math.max(a, b);
}
