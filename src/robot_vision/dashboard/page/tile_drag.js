/** Arranging tiles by dragging their headers. */

import { moved } from "./layout.js";

const THRESHOLD = 6; // CSS px until it is a drag

/**
 * @param {any} tiles
 * @param {any} tile
 */
export function dragByHeader(tiles, tile) {
  const { head, element } = tile;
  let start = null;
  head.addEventListener("pointerdown", (event) => {
    if (
      event.button ||
      event.pointerType === "touch" ||
      event.target.closest("button") ||
      tile.enlarged
    )
      return;
    tiles.select(tile);
    head.setPointerCapture(event.pointerId);
    start = { x: event.clientX, y: event.clientY, dragging: false, before: tiles.order };
  });
  head.addEventListener("pointermove", (event) => {
    if (!start) return;
    const [x, y] = [event.clientX - start.x, event.clientY - start.y];
    if (!start.dragging && Math.hypot(x, y) < THRESHOLD) return;
    start.dragging = true;
    tiles.dragged = tile;
    element.classList.add("dragging");
    const under = tiles.visible().find((other) => {
      const rect = other.element.getBoundingClientRect();
      return (
        other !== tile &&
        event.clientX > rect.left &&
        event.clientX < rect.right &&
        event.clientY > rect.top &&
        event.clientY < rect.bottom
      );
    });
    if (under) tiles.setOrder(moved(tiles.order, tile.key, tiles.order.indexOf(under.key)), true);
  });
  const end = (keep) => {
    tiles.dragged = null;
    if (start?.dragging) {
      tiles.setOrder(keep ? tiles.order : start.before);
      element.classList.remove("dragging");
    }
    start = null;
  };
  head.addEventListener("pointerup", () => end(true));
  head.addEventListener("pointercancel", () => end(false));
  head.addEventListener(
    "dblclick",
    (event) => !event.target.closest("button") && tiles.enlarge(tile.enlarged ? null : tile),
  );
}
