/** How old images are when they are on the screen. */

const KEPT = 2000; // frames of each topic

/**
 * @param {number[]} sorted
 * @param {number} share 0 to 1
 */
function quantile(sorted, share) {
  return sorted.length
    ? sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))]
    : null;
}

/** @param {number[]} values */
function summary(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return { p50: quantile(sorted, 0.5), p90: quantile(sorted, 0.9), p99: quantile(sorted, 0.99) };
}

/**
 * @typedef {Object} Age of a frame when it was drawn
 * @property {number} stamp ms since the image's stamp
 * @property {number} received ms since the server had received it
 * @property {boolean} waits whether the image may wait for what is drawn over it
 */

export class Statistics {
  constructor() {
    /** @type {Map<string, Age[]>} by topic */
    this.frames = new Map();
    this.drawn = 0;
  }

  /**
   * A frame has been drawn.
   * @param {string} topic
   * @param {Age} age
   */
  add(topic, age) {
    if (!this.frames.has(topic)) this.frames.set(topic, []);
    const frames = this.frames.get(topic);
    frames.push(age);
    if (frames.length > KEPT) frames.splice(0, KEPT / 2);
    document.body.dataset.frames = String(++this.drawn);
  }

  /** Forgets what was measured, to begin a measurement. */
  clear() {
    this.frames.clear();
  }

  /**
   * How old the frames of a topic were when they were drawn, of all tiles that show it.
   * @param {string} topic
   * @param {boolean} [waits] of tiles whose images may wait for what is drawn over them, or of the
   *   others
   * @returns {{count: number, stamp: Object, received: Object}} ms: p50, p90 and p99 since the
   *   image's stamp, and since the server had received it
   */
  latency(topic, waits = false) {
    const frames = (this.frames.get(topic) || []).filter((frame) => frame.waits === waits);
    return {
      count: frames.length,
      stamp: summary(frames.map((frame) => frame.stamp)),
      received: summary(frames.map((frame) => frame.received)),
    };
  }
}
