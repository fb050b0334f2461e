/** Sliders: places on them and values. Nothing here knows the page. */

// Times that a range is wider than its default value, from where on the slider is finer at its low
// end.
const WIDE = 60;
const POWER = 3;
const STEPS = 1000; // places of a slider

/**
 * @typedef {Object} Range
 * @property {"int"|"double"|"bool"|"str"} type
 * @property {number|null} min null: there is no limit
 * @property {number|null} max
 * @property {number|null} default null: it is not finite
 */

/** @param {Range} range @returns {boolean} whether a slider can show it */
export function hasSlider({ type, min, max }) {
  return (type === "int" || type === "double") && min !== null && max !== null && max > min;
}

/** @param {Range} range */
function power(range) {
  const from = Math.abs(range.default - range.min);
  return from > 0 && range.max - range.min > WIDE * from ? POWER : 1;
}

/** @param {Range} range @returns {number} places of its slider */
export function sliderSteps(range) {
  const whole = range.type === "int" && power(range) === 1;
  return whole && range.max - range.min < STEPS ? range.max - range.min : STEPS;
}

/**
 * @param {Range} range
 * @param {number|null} value null, which is not finite, is where 0 is
 * @returns {number} 0 to sliderSteps
 */
export function toSlider(range, value) {
  const share = Math.min(1, Math.max(0, (value - range.min) / (range.max - range.min)));
  return Math.round(share ** (1 / power(range)) * sliderSteps(range));
}

/**
 * @param {Range} range
 * @param {number} place
 * @returns {number} a value as round as the slider can tell apart
 */
export function fromSlider(range, place) {
  const at = (step) =>
    range.min + (step / sliderSteps(range)) ** power(range) * (range.max - range.min);
  const value = at(place);
  if (range.type === "int") return Math.round(value);
  if (place <= 0) return range.min;
  if (place >= sliderSteps(range)) return range.max;
  const apart = Math.min(Math.abs(at(place + 1) - value), Math.abs(value - at(place - 1))) || 1;
  const digits = Math.max(0, Math.min(12, Math.ceil(-Math.log10(apart))));
  return Math.min(range.max, Math.max(range.min, Number(value.toFixed(digits))));
}

/**
 * @param {number|null} value null: it is not finite, which JSON cannot say
 * @returns {string} as short as it is exact enough for people, integers with all their digits; ""
 *   for null
 */
export function shortNumber(value) {
  if (value === null) return "";
  return String(Number.isInteger(value) ? value : Number(value.toPrecision(9)));
}

/**
 * @param {any} a
 * @param {any} b
 * @returns {boolean} whether two values of a parameter are the same, integers exactly, others but
 *   for the last digits
 */
export function sameValue(a, b) {
  if (typeof a !== "number" || typeof b !== "number") return a === b;
  if (Number.isInteger(a) && Number.isInteger(b)) return a === b;
  return Math.abs(a - b) <= 1e-9 * Math.max(Math.abs(a), Math.abs(b));
}
