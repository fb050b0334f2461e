/** Where words are put so that they do not cover each other. Nothing here knows the page. */

const STEPS = [0, 1, -1, 2, -2, 3, -3]; // heights up or down, the first that is free is taken

/**
 * @typedef {Object} Rect CSS px
 * @property {number} left
 * @property {number} top
 * @property {number} width
 * @property {number} height
 */

/** @param {Rect} a @param {Rect} b */
function overlap(a, b) {
  return (
    a.left < b.left + b.width &&
    b.left < a.left + a.width &&
    a.top < b.top + b.height &&
    b.top < a.top + a.height
  );
}

/**
 * Moves a rectangle into the bounds, and up or down until it covers no other.
 * @param {Rect} wanted
 * @param {Rect[]} taken
 * @param {{width: number, height: number}} bounds
 * @returns {Rect} where it was wanted if there is no room near it
 */
export function freePlace(wanted, taken, bounds) {
  const within = (value, most) => Math.max(0, Math.min(value, most));
  const left = within(wanted.left, bounds.width - wanted.width);
  const at = (step) => {
    const top = wanted.top + step * (wanted.height + 1);
    return { ...wanted, left, top: within(top, bounds.height - wanted.height) };
  };
  const places = STEPS.map(at);
  return places.find((place) => !taken.some((other) => overlap(place, other))) || places[0];
}
