/** How much comes by topics, measured when somebody asks. */

/** @param {number} bytes in a second */
export function bandwidthText(bytes) {
  const units = ["B/s", "kB/s", "MB/s", "GB/s"];
  let step = 0;
  for (; bytes >= 1000 && step < units.length - 1; ++step) bytes /= 1000;
  return `${bytes.toFixed(bytes < 10 && step ? 1 : 0)} ${units[step]}`;
}

export class GraphRates {
  /** @param {any} app */
  constructor(app) {
    this.app = app;
    /** @type {Map<string, string>} by topic */
    this.texts = new Map();
  }

  /** @param {string} topic @returns {string} "" if it was not measured */
  get(topic) {
    return this.texts.get(topic) || "";
  }

  /**
   * Listens to a topic for about two seconds.
   * @param {string} topic
   * @returns {Promise<string>} what there is to say of it
   */
  async measure(topic) {
    try {
      const { rate, bandwidth } = await this.app.connection.request("rate", { topic });
      const text = rate ? `${rate.toFixed(1)} Hz, ${bandwidthText(bandwidth)}` : "nothing in 2 s";
      this.texts.set(topic, text);
      return text;
    } catch (error) {
      return error.message;
    }
  }
}
