/** What is wrong with the image of a tile, in words. */

const STALE = 3000; // ms without an image, after which the tile says so
const LATE = 1000; // ms, in which earlier images are drawn after it is told what is wrong

/**
 * @param {import("./tile.js").Tile} tile
 * @returns {string} nothing if all is well
 */
export function problemOf(tile) {
  const { view, image, error, app, tiles } = tile;
  if (app.connection.state !== "open") return view.drawn ? "" : "Connecting ..."; // a bar says more
  if (!image) return "It is not known yet on which image it works.";
  const now = performance.now();
  const last = view.times[view.times.length - 1];
  const fails = error && !(last > tile.failedAt + LATE);
  if (!fails && view.isOpen && last && now - last < STALE) return "";
  if (!tiles.isPublished(image)) {
    const gone = "has gone. It comes back by itself with its node.";
    return `${image} ${view.drawn ? gone : "is not published."}`;
  }
  if (error) return error;
  if (!view.drawn) return "Waiting for the first image ...";
  const since = Math.max(last || 0, tile.openedAt);
  if (!view.isOpen || document.hidden || now - since < STALE) return "";
  return last ? `No image for ${Math.round((now - last) / 1000)} s.` : "No new image.";
}
