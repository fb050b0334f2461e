/** Which tiles there are, in what order, and in how many columns. Nothing here knows the page. */

const CHROME = 78; // CSS px of a tile's height that are not its image
const MIN_WIDTH = 264; // CSS px of a tile
const PHONE_WIDTH = 560; // CSS px; below, there is one column

/** Which nodes a newcomer looks at first; others follow by name. */
const ORDER = [
  "camera",
  "usb_cam",
  "hsv_tracker",
  "ball_tracker",
  "face_detector",
  "face_recognizer",
  "object_tracker",
  "object_detector",
  "people_detector",
  "motion_detector",
  "apriltag",
  "code_reader",
  "line_follower",
  "lane_detector",
  "brightness",
  "edge_detector",
  "filter",
  "hough",
  "contours",
  "histogram",
  "features",
];

/**
 * @typedef {Object} View one image to show, as the server's graph has it
 * @property {string} node
 * @property {string} title
 * @property {string} image
 * @property {string[]} overlays
 * @property {string} processed
 */

/**
 * A name for each view, the same every time: its node's, with the image's if the node has several.
 * @param {View[]} views
 * @returns {Map<string, View>}
 */
export function keyViews(views) {
  const count = new Map();
  for (const { node } of views) count.set(node, (count.get(node) || 0) + 1);
  return new Map(
    views.map((view) => [
      count.get(view.node) > 1 ? `${view.node} ${view.image}` : view.node,
      view,
    ]),
  );
}

/**
 * Whether a view is among others, by whatever key: that changes with the number of a node's views.
 * @param {Map<string, View>} views
 * @param {View} view
 */
export function hasView(views, { node, image }) {
  return [...views.values()].some((other) => other.node === node && other.image === image);
}

/** @param {View} view */
function rank(view) {
  if (!view.overlays.length && !view.processed) return -1; // a camera
  const name = view.node.split("/").pop();
  const place = ORDER.findIndex((known) => name === known || name.startsWith(known + "_"));
  return place < 0 ? ORDER.length : place;
}

/**
 * The keys in the order to show them: as somebody has put them, new ones behind those they follow
 * by default.
 * @param {Map<string, View>} views
 * @param {string[]} kept
 * @returns {string[]}
 */
export function orderKeys(views, kept) {
  const byDefault = [...views.keys()].sort(
    (a, b) => rank(views.get(a)) - rank(views.get(b)) || (a < b ? -1 : a > b ? 1 : 0),
  );
  const order = kept.filter((key) => views.has(key));
  byDefault.forEach((key, index) => {
    if (order.includes(key)) return;
    const before = byDefault
      .slice(0, index)
      .reverse()
      .find((other) => order.includes(other));
    order.splice(before === undefined ? 0 : order.indexOf(before) + 1, 0, key);
  });
  return order;
}

/**
 * @param {string[]} order
 * @param {string} key
 * @param {number} place where it will be
 * @returns {string[]}
 */
export function moved(order, key, place) {
  const others = order.filter((other) => other !== key);
  others.splice(Math.max(0, Math.min(place, others.length)), 0, key);
  return others;
}

/**
 * The columns in which tiles are as large as they can be without scrolling; if they would get too
 * small, as many as fit.
 * @param {{width: number, height: number, gap: number}} room CSS px
 * @param {number} cells tiles, of which one of double size counts four times
 * @param {number} aspect width by height of most images
 * @returns {{columns: number, width: number}} width: CSS px of all columns together
 */
export function arrangement(room, cells, aspect) {
  const { width: whole, height, gap } = room;
  if (whole < PHONE_WIDTH) return { columns: 1, width: whole };
  let best = { columns: 0, width: MIN_WIDTH };
  for (let columns = 1; columns <= Math.max(1, cells); ++columns) {
    const rows = Math.ceil(cells / columns);
    const width = Math.min(
      (whole + gap) / columns - gap,
      ((height + gap) / rows - gap - CHROME) * aspect,
    );
    if (width > best.width) best = { columns, width };
  }
  if (best.columns)
    return { columns: best.columns, width: Math.floor(best.columns * (best.width + gap) - gap) };
  return {
    columns: Math.max(1, Math.floor((whole + gap) / (1.08 * MIN_WIDTH + gap))),
    width: whole,
  };
}

/**
 * The neighbor of a tile in a direction.
 * @param {{x: number, y: number}[]} centers CSS px of all tiles
 * @param {number} from index
 * @param {"ArrowLeft"|"ArrowRight"|"ArrowUp"|"ArrowDown"} direction
 * @returns {number} index; -1: there is none
 */
export function neighbor(centers, from, direction) {
  const [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[
    direction
  ];
  let best = -1;
  let least = Infinity;
  centers.forEach((center, index) => {
    const x = center.x - centers[from].x;
    const y = center.y - centers[from].y;
    const along = x * dx + y * dy;
    const across = Math.abs(x * dy) + Math.abs(y * dx);
    if (along > 1 && along + 3 * across < least) {
      least = along + 3 * across;
      best = index;
    }
  });
  return best;
}
