/** Saves what a tile shows, with what is drawn over it, as a file. */

import { el } from "./dom.js";

const KEPT = 10000; // ms, until the browser has surely taken the file

/** @param {import("./tile.js").Tile} tile */
export async function saveImage(tile) {
  const { canvas, overlay, drawn } = tile.view;
  if (!drawn) return;
  const both = new OffscreenCanvas(canvas.width, canvas.height);
  const context = both.getContext("2d");
  context.drawImage(canvas, 0, 0);
  context.drawImage(overlay, 0, 0, canvas.width, canvas.height);
  const blob = await both.convertToBlob({ type: "image/png" });
  const name = (tile.node || tile.image).replace(/\W+/g, "_").replace(/^_/, "");
  const link = el("a", { href: URL.createObjectURL(blob), download: `${name}.png` });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEPT);
}
