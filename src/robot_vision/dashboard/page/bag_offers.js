/** What is worth recording, and how sizes and times of bags are written. Nothing knows the page. */

const COMPRESSED = "sensor_msgs/CompressedImage";
const MEMORY = "robot_vision/ShmImage"; // which a bag cannot hold
const OF_TRANSPORTS =
  /\/(compressed|compressedDepth|theora|shm)(\/|$)|\/parameter_(updates|descriptions)$/;
const FRAMES = ["/tf", "/tf_static"];
const NOTES = { compressed: "JPEG", compressedDepth: "compressedDepth" };
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
 * @property {string} topic what is recorded
 * @property {string} label how it is called
 * @property {string} note what it is
 * @property {string[]} beside topics that belong to it
 */

/**
 * What is worth recording: images in the form that needs least, with what belongs to them.
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
    if (published.has(name)) first.push({ topic: name, label: name, note: "frames", beside: [] });
  }
  const others = [...published]
    .filter(([name]) => !first.some((one) => one.topic === name))
    .map(([name, type]) => ({ topic: name, label: name, note: type, beside: [] }))
    .sort((a, b) => order(a) - order(b) || (a.topic < b.topic ? -1 : 1));
  return { first, others };
}

/** What belongs to a transport comes last. */
function order({ topic }) {
  return OF_TRANSPORTS.test(topic) ? 1 : 0;
}

/** The transport that keeps what is in an image: JPEG loses depths, and nothing takes a flow. */
function formOf(name) {
  if (/(^|\/)flow$/.test(name)) return "";
  return /depth|disparity/.test(name) ? "compressedDepth" : "compressed";
}

/**
 * @param {string} name
 * @param {Map<string, string>} published types by name
 * @returns {Offer}
 */
function imageOffer(name, published) {
  const form = formOf(name);
  const isThere = form && published.get(`${name}/${form}`) === COMPRESSED;
  const info = `${name.slice(0, name.lastIndexOf("/"))}/camera_info`;
  return {
    topic: isThere ? `${name}/${form}` : name,
    label: name,
    note: isThere ? NOTES[form] : "raw",
    beside: published.has(info) ? [info] : [],
  };
}
