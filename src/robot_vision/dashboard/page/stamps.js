/** Which message belongs to which image, by their stamps. Nothing here knows the page. */

const EQUAL = 2e-6; // s, as much as numbers of this size differ after they were text
const MAX_AGE = 0.5; // s that a message may be from the image it is drawn on
const KEPT = 40; // messages, and images
const MAX_HOLD = 150; // ms that an image waits for its messages
const MIN_SHARE = 0.4; // of the images; a node that works on fewer is not waited for
const MIN_WALL_TIME = 1e9; // s, the year 2001

/** The last messages of a topic. */
export class StampBuffer {
  constructor() {
    /** @type {{stamp: number, data: any}[]} */
    this.items = [];
  }

  /** @param {number} stamp s @param {any} data */
  add(stamp, data) {
    this.items.push({ stamp, data });
    if (this.items.length > KEPT) this.items.shift();
  }

  /**
   * @param {number} stamp s
   * @returns {any} what was made of the image of this stamp, or null
   */
  at(stamp) {
    return this.items.findLast((item) => Math.abs(item.stamp - stamp) < EQUAL)?.data ?? null;
  }

  /**
   * @param {number} stamp s
   * @returns {any} the same, or the one that is nearest to it and not too far, or null
   */
  near(stamp) {
    let best = null;
    let least = MAX_AGE;
    for (const item of this.items) {
      const apart = Math.abs(item.stamp - stamp);
      if (apart > least) continue;
      least = apart;
      best = item.data;
    }
    return best;
  }
}

/** How long after an image what was made of it usually comes. */
export class Pairing {
  constructor() {
    /** @type {{stamp: number, at: number, lag: number|null}[]} */
    this.images = [];
    /** @type {number[]} stamps of messages that were here before their images */
    this.early = [];
  }

  /** @param {number} stamp s @param {number} now ms */
  image(stamp, now) {
    const early = this.early.some((other) => Math.abs(other - stamp) < EQUAL);
    this.images.push({ stamp, at: now, lag: early ? 0 : null });
    if (this.images.length > KEPT) this.images.shift();
  }

  /** @param {number} stamp s @param {number} now ms */
  message(stamp, now) {
    const image = this.images.findLast((other) => Math.abs(other.stamp - stamp) < EQUAL);
    if (image && image.lag === null) image.lag = now - image.at;
    if (image) return;
    this.early.push(stamp);
    if (this.early.length > KEPT) this.early.shift();
  }

  /**
   * @param {number} now ms
   * @returns {number} ms that an image should wait; 0: not at all
   */
  hold(now) {
    const settled = this.images.filter(
      (image) => image.lag !== null || now - image.at > 2 * MAX_HOLD,
    );
    const lags = settled
      .flatMap((image) => (image.lag === null ? [] : [image.lag]))
      .sort((a, b) => a - b);
    if (lags.length < 3 || lags.length < MIN_SHARE * settled.length) return 0;
    const usual = lags[Math.floor(0.9 * (lags.length - 1))];
    return usual > MAX_HOLD ? 0 : Math.min(MAX_HOLD, 1.3 * usual + 8);
  }
}

/**
 * Whether a stamp is of a simulator's time, which mostly begins at 0, and so tells no date.
 * @param {number} stamp s
 */
export function isSimulated(stamp) {
  return stamp < MIN_WALL_TIME;
}
