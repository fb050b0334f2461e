/** What is wrong with the image of a tile, in words. */

const STALE = 3000; // ms without an image, after which the tile says so
const LATE = 1000; // ms, in which earlier images are drawn after it is told what is wrong

/**
 * How long ago the image that is shown had come, ms. The only one that was drawn may have come long
 * before that, as the dashboard keeps the newest.
 */
function ageOf({ times, drawn }, connection) {
  if (times.length > 1) return performance.now() - times[times.length - 1];
  return drawn ? 1000 * (connection.serverTime() - drawn.header.received) : Infinity;
}

/**
 * @param {import("./tile.js").Tile} tile
 * @returns {string} nothing if all is well
 */
export function problemOf(tile) {
  const { view, image, error, app, tiles } = tile;
  if (app.connection.state !== "open") return view.drawn ? "" : "Connecting ..."; // a bar says more
  if (!image) return "It is not known yet on which image it works.";
  const last = view.times[view.times.length - 1];
  const age = ageOf(view, app.connection);
  const fails = error && !(last > tile.failedAt + LATE);
  if (!fails && view.isOpen && age < STALE) return "";
  if (!tiles.isPublished(image)) {
    const gone = "has gone. It comes back by itself with its node.";
    return `${image} ${view.drawn ? gone : "is not published."}`;
  }
  if (error) return error;
  if (!view.drawn) return "Waiting for the first image ...";
  const since = Math.max(last || 0, tile.openedAt);
  if (!view.isOpen || document.hidden || performance.now() - since < STALE) return "";
  return `No image for ${Math.round(age / 1000)} s.`;
}
