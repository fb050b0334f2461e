/** The mask of a node, drawn over its image while it is looked at. */

const WIDTH = 640; // px, the width that masks are sent with
const TINT = [255, 0, 200, 150]; // RGBA of what is in the mask
const SET = 127; // a pixel above this is in the mask
const PNG = 3; // kind of a payload

/**
 * Shows the topic ~mask of a node over the tiles of that node.
 * @param {object} app
 * @param {string} node
 * @returns {() => void} ends it
 */
export function liveMask(app, node) {
  const canvas = document.createElement("canvas");
  const size = { width: 0, height: 0 };
  const paint = (context) => {
    if (size.width) context.drawImage(canvas, 0, 0, size.width, size.height);
  };
  let layers = new Map();
  let closed = false;
  const redraw = () => {
    const tiles = app.tiles.list().filter((tile) => tile.node === node);
    const kept = new Map();
    for (const tile of tiles) {
      kept.set(tile.key, app.tiles.draw(tile, "mask", paint));
      layers.delete(tile.key);
    }
    layers.forEach((remove) => remove());
    layers = kept;
  };
  const close = app.connection.channel(
    "image", { topic: `${node}/mask`, width: WIDTH, quality: 80 },
    async ({ header, payload }) => {
      await tint(canvas, header, payload);
      if (closed) return; // or the last mask would stay
      size.width = header.width;
      size.height = header.height;
      redraw();
    },
  );
  return () => {
    closed = true;
    close();
    layers.forEach((remove) => remove());
  };
}

/** Draws what is in the mask in the tint, and nothing elsewhere. */
async function tint(canvas, header, payload) {
  const type = header.kind === PNG ? "image/png" : "image/jpeg";
  const bitmap = await createImageBitmap(new Blob([payload], { type }));
  canvas.width = bitmap.width;
  canvas.height = bitmap.height;
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  const pixels = context.getImageData(0, 0, canvas.width, canvas.height);
  const { data } = pixels;
  for (let at = 0; at < data.length; at += 4) {
    const set = data[at] > SET;
    for (let channel = 0; channel < 4; channel++) data[at + channel] = set ? TINT[channel] : 0;
  }
  context.putImageData(pixels, 0, 0);
}
