/** The menus of a tile, of the arrangement of all, and the list of image topics. */

import { captureItems } from "./capture.js";
import { showMenu } from "./menu.js";
import { saveImage } from "./tile_file.js";
import { moveSelected } from "./tile_keys.js";

const QUALITIES = { Small: 50, Normal: 80, Best: 95 };

/** @param {any} tiles @param {any} tile @param {HTMLElement} anchor */
export function showTileMenu(tiles, tile, anchor) {
  const doubled = tiles.kept("double").includes(tile.key);
  const { source, options } = tile;
  tiles.select(tile);
  const items = [
    {
      text: "Drawings over the image",
      note: "o",
      checked: options.overlays,
      run: () => tile.toggle("overlays"),
      disabled: !tile.drawable.length || tile.processed,
    },
    {
      text: "The node's own image",
      note: "i",
      checked: tile.processed,
      run: () => tile.toggle("processed"),
      disabled: !source.processed,
    },
    {
      text: "Double size",
      note: doubled ? "-" : "+",
      checked: doubled,
      run: () => tiles.setDouble(tile, !doubled),
    },
    {
      text: "Move to the front",
      run: () => tiles.setOrder([tile.key, ...tiles.order.filter((key) => key !== tile.key)]),
    },
    { text: "Move backward", note: "Alt ←", run: () => moveSelected(tiles, -1) },
    { text: "Move forward", note: "Alt →", run: () => moveSelected(tiles, 1) },
    ...captureItems(tiles.app, tile.node),
    { text: "Save the image", run: () => saveImage(tile), disabled: !tile.view.drawn },
    { text: tile.node ? "Hide" : "Remove", note: "h", run: () => tiles.hide(tile) },
  ];
  if (tile.node)
    items.unshift({
      text: "Parameters",
      note: "p",
      run: () => tiles.app.panels.open("parameters"),
    });
  showMenu(anchor, items, { label: tile.title.textContent });
}

/** @param {any} tiles @param {HTMLElement} anchor */
export function showLayoutMenu(tiles, anchor) {
  const { storage } = tiles.app;
  const hidden = tiles.kept("hidden");
  const quality = storage.get("quality", 80);
  const items = [
    {
      text: "As it was at first",
      run: () => {
        for (const name of ["order", "hidden", "double"]) storage.set(name, null);
        tiles.update();
      },
    },
    { text: "Quality of the images" },
    ...Object.entries(QUALITIES).map(([text, value]) => ({
      text,
      note: `${value} %`,
      checked: value === quality,
      run: () => {
        storage.set("quality", value);
        tiles.streams.updateAll();
      },
    })),
    { text: "Shown" },
    ...tiles.order.map((key) => ({
      text: tiles.tiles.get(key).title.textContent,
      checked: !hidden.includes(key),
      run: () => {
        storage.set(
          "hidden",
          hidden.includes(key) ? hidden.filter((other) => other !== key) : [...hidden, key],
        );
        tiles.update();
      },
    })),
  ];
  showMenu(anchor, items, { label: "Arrangement" });
}

/** @param {any} tiles @param {HTMLElement} anchor */
export function showPicker(tiles, anchor) {
  const added = tiles.kept("added");
  const topics = (tiles.app.graph?.topics || []).filter(({ image }) => image);
  const items = topics.map(({ name }) => ({
    text: name,
    checked: added.includes(name),
    run: () => {
      tiles.app.storage.set(
        "added",
        added.includes(name) ? added.filter((other) => other !== name) : [...added, name],
      );
      tiles.update();
    },
  }));
  if (!items.length)
    items.push({ text: "There is no topic with images.", checked: undefined, run: undefined });
  showMenu(anchor, items, { label: "Image topics", filter: "Find a topic" });
}
