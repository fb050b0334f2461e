/** What is worth recording, and how sizes and times of bags are written. Nothing knows the page. */

const MEMORY = "robot_vision/ShmImage"; // which a bag cannot hold
const OF_TRANSPORTS =
  /\/(compressed|compressedDepth|theora|shm)(\/|$)|\/parameter_(updates|descriptions)$/;
const FRAMES = ["/tf", "/tf_static"];
const IMAGES = "images:";
const UNITS = ["bytes", "kB", "MB", "GB", "TB"];

/** @param {number} bytes */
export function sizeText(bytes) {
  const power = Math.min(Math.floor(Math.log10(Math.max(bytes, 1)) / 3), UNITS.length - 1);
  const value = bytes / 1000 ** power;
  return `${power === 0 || value >= 100 ? Math.round(value) : value.toFixed(1)} ${UNITS[power]}`;
}

/** @param {number} seconds */
export function timeText(seconds) {
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  const two = (value) => String(value).padStart(2, "0");
  return hours
    ? `${hours}:${two(minutes)}:${two(whole % 60)} h`
    : `${minutes}:${two(whole % 60)} min`;
}

/**
 * @typedef {Object} Offer
 * @property {string} key what tells it from others: the topic, or IMAGES and the topic if the node
 *   that records is to choose the form of the images
 * @property {string} label how it is called
 * @property {string} note what it is
 * @property {string[]} beside keys of what belongs to it
 */

/**
 * What is worth recording: images with what belongs to them, and all topics as they are.
 * @param {{name: string, type: string, publishers: string[]}[]} topics of a graph
 * @returns {{first: Offer[], others: Offer[]}}
 */
export function offers(topics) {
  const published = new Map(
    topics
      .filter((one) => one.publishers.length && one.type !== MEMORY)
      .map((one) => [one.name, one.type]),
  );
  const images = [...published].filter(([, type]) => type === "sensor_msgs/Image");
  const rank = ({ label }) => (label.endsWith("/image_raw") ? 0 : 1);
  const first = images
    .map(([name]) => imageOffer(name, published))
    .sort((a, b) => rank(a) - rank(b) || (a.label < b.label ? -1 : 1));
  for (const name of FRAMES) {
    if (published.has(name)) first.push({ key: name, label: name, note: "frames", beside: [] });
  }
  const others = [...published]
    .filter(([name]) => !first.some((one) => one.key === name))
    .map(([name, type]) => ({ key: name, label: name, note: type, beside: [] }))
    .sort((a, b) => order(a) - order(b) || (a.label < b.label ? -1 : 1));
  return { first, others };
}

/**
 * What the node is asked to record.
 * @param {Iterable<string>} keys of offers
 * @returns {{images: string[], topics: string[]}}
 */
export function requested(keys) {
  const all = [...keys];
  return {
    images: all.filter((key) => key.startsWith(IMAGES)).map((key) => key.slice(IMAGES.length)),
    topics: all.filter((key) => !key.startsWith(IMAGES)),
  };
}

/** Whether what a recording says at its end is only that it has ended. */
export function isWhole(state) {
  return state.startsWith("stopped") && !state.includes(";");
}

/** What belongs to a transport comes last. */
function order({ label }) {
  return OF_TRANSPORTS.test(label) ? 1 : 0;
}

/**
 * @param {string} name
 * @param {Map<string, string>} published types by name
 * @returns {Offer}
 */
function imageOffer(name, published) {
  const info = `${name.slice(0, name.lastIndexOf("/"))}/camera_info`;
  const beside = published.has(info) ? [info] : [];
  return { key: IMAGES + name, label: name, note: "images", beside };
}
