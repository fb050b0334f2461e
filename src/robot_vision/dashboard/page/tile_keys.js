/** Shortcuts for the selected image. */

import { shortcut } from "./keys.js";
import { moved, neighbor } from "./layout.js";

/** Selects the neighbor in a direction. */
function go(tiles, direction) {
  const shown = tiles.visible();
  if (!shown.length || shown.some(({ enlarged }) => enlarged)) return false;
  const from = shown.indexOf(tiles.selected);
  const centers = shown.map(({ element }) => {
    const { left, top, width, height } = element.getBoundingClientRect();
    return { x: left + width / 2, y: top + height / 2 };
  });
  const next = from < 0 ? 0 : neighbor(centers, from, direction);
  if (next < 0) return true;
  tiles.select(shown[next]); // the focus does that, too, but not in a window that has none
  shown[next].element.focus();
  return true;
}

/**
 * Moves the selected tile among those that are shown.
 * @param {any} tiles
 * @param {number} step places, to the back if it is positive
 */
export function moveSelected(tiles, step) {
  const shown = tiles.visible();
  const other = shown[shown.indexOf(tiles.selected) + step];
  if (!tiles.selected || !other) return;
  tiles.setOrder(moved(tiles.order, tiles.selected.key, tiles.order.indexOf(other.key)));
}

/** @param {any} tiles */
export function addTileShortcuts(tiles) {
  for (const direction of ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"]) {
    shortcut(direction, "Select another image", () => go(tiles, direction));
    const step = /Left|Up/.test(direction) ? -1 : 1;
    shortcut("Alt+" + direction, "Move the image", () => moveSelected(tiles, step));
  }
  const withSelected = (run) => () => (tiles.selected ? run(tiles.selected) : false);
  const enlarge = (tile) => tiles.enlarge(tile.enlarged ? null : tile);
  shortcut("Enter", "Enlarge the image", withSelected(enlarge));
  shortcut(
    "+",
    "Double size",
    withSelected((tile) => tiles.setDouble(tile, true)),
  );
  shortcut(
    "-",
    "Normal size",
    withSelected((tile) => tiles.setDouble(tile, false)),
  );
  shortcut(
    "o",
    "Drawings over the image",
    withSelected((tile) => tile.toggle("overlays")),
  );
  const own = (tile) => tile.source.processed && tile.toggle("processed");
  shortcut("i", "The node's own image", withSelected(own));
  shortcut(
    "h",
    "Hide the image",
    withSelected((tile) => tiles.hide(tile)),
  );
  const button = document.querySelector.bind(document, "[data-test=add-image]");
  shortcut("a", "Add an image topic", () => tiles.showPicker(button()));
}
