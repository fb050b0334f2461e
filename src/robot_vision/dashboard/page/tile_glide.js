/** Lets tiles slide to their new places, so that the eye can follow. */

const DURATION = 160; // ms

/**
 * @param {Iterable<any>} tiles
 * @returns {Map<any, DOMRect>} where they are now
 */
export function placesOf(tiles) {
  return new Map([...tiles].map((tile) => [tile, tile.element.getBoundingClientRect()]));
}

/** @param {Map<any, DOMRect>} before where they were */
export function glide(before) {
  if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
  for (const [tile, from] of before) {
    const to = tile.element.getBoundingClientRect();
    const [x, y] = [from.left - to.left, from.top - to.top];
    if (!from.width || !to.width || (!x && !y)) continue;
    const frames = [{ transform: `translate(${x}px, ${y}px)` }, {}];
    tile.element.animate(frames, { duration: DURATION, easing: "ease-out" });
  }
}
