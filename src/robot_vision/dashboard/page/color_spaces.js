/** The colour spaces of the nodes, in 8 bits as OpenCV has them, and how browsers name colours. */

/** Channels by space: short name, meaning and highest limit; a hue is in half degrees. */
export const SPACES = {
  hsv: [["H", "hue", 180], ["S", "saturation", 255], ["V", "value", 255]],
  hls: [["H", "hue", 180], ["L", "lightness", 255], ["S", "saturation", 255]],
  lab: [["L", "lightness", 255], ["a", "green to red", 255], ["b", "blue to yellow", 255]],
  ycrcb: [["Y", "luma", 255], ["Cr", "red difference", 255], ["Cb", "blue difference", 255]],
  bgr: [["B", "blue", 255], ["G", "green", 255], ["R", "red", 255]],
  rgb: [["R", "red", 255], ["G", "green", 255], ["B", "blue", 255]],
};

export const TITLES = {
  hsv: "HSV", hls: "HLS", lab: "Lab", ycrcb: "YCrCb", bgr: "BGR", rgb: "RGB",
};

const STOPS = 12; // of a gradient
const ROOM = 20; // beyond a colour that a range is made to hold

const percent = (value) => `${((100 * value) / 255).toFixed(1)}%`;

const CSS = {
  rgb: ([r, g, b]) => `rgb(${Math.round(r)}, ${Math.round(g)}, ${Math.round(b)})`,
  bgr: ([b, g, r]) => CSS.rgb([r, g, b]),
  hls: ([h, l, s]) => `hsl(${2 * h}, ${percent(s)}, ${percent(l)})`,
  hsv: ([h, s, v]) => {
    const lightness = v * (1 - s / 510);
    const room = Math.min(lightness, 255 - lightness);
    return CSS.hls([h, lightness, room ? (255 * (v - lightness)) / room : 0]);
  },
  lab: ([l, a, b]) => `lab(${percent(l)} ${a - 128} ${b - 128})`,
  ycrcb: ([y, cr, cb]) => CSS.rgb([
    y + 1.403 * (cr - 128),
    y - 0.714 * (cr - 128) - 0.344 * (cb - 128),
    y + 1.773 * (cb - 128),
  ]),
};

/**
 * A colour as style sheets name it.
 * @param {string} space
 * @param {number[]} values of its three channels
 * @returns {string}
 */
export const cssColor = (space, values) => CSS[space](values);

/** @param {string} space @param {number} channel @returns {boolean} whether it is on a circle */
export const isHue = (space, channel) => channel === 0 && (space === "hsv" || space === "hls");

/**
 * The colours along a channel: all hues as they are seen, else with the range's other channels.
 * @param {string} space
 * @param {number} channel 0 to 2
 * @param {{low: number[], high: number[]}} range
 * @returns {string} a background-image
 */
export function gradient(space, channel, range) {
  const highest = SPACES[space][channel][2];
  const middle = range.low.map((low, index) => middleOf(space, index, low, range.high[index]));
  const pure = space === "hsv" ? [0, 255, 255] : [0, 128, 255];
  const colors = [];
  for (let stop = 0; stop <= STOPS; stop++) {
    const values = [...(isHue(space, channel) ? pure : middle)];
    values[channel] = (highest * stop) / STOPS;
    colors.push(cssColor(space, values));
  }
  return `linear-gradient(to right, ${colors.join(", ")})`;
}

/**
 * The range proposed for a colour, made wide enough to hold it: what is proposed leaves out pale
 * and dark colours, as most of them are not the thing.
 * @param {string} space
 * @param {{low: number[], high: number[]}} range
 * @param {number[]} color
 * @returns {{space: string, low: number[], high: number[], widened: boolean}}
 */
export function holding(space, range, color) {
  const found = { space, low: [...range.low], high: [...range.high], widened: false };
  color.forEach((value, index) => {
    if (isHue(space, index)) return; // it is proposed around the colour's own
    if (value < found.low[index]) found.low[index] = Math.max(0, value - ROOM);
    else if (value > found.high[index]) {
      found.high[index] = Math.min(SPACES[space][index][2], value + ROOM);
    } else return;
    found.widened = true;
  });
  return found;
}

function middleOf(space, channel, low, high) {
  return isHue(space, channel) && low > high ? ((low + high + 180) / 2) % 180 : (low + high) / 2;
}
