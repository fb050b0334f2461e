/**
 * What the page remembers in this browser. Without a storage (private windows, a full disk) it
 * forgets at the end.
 */

const PREFIX = "robot_vision.";
const memory = new Map();

export const storage = {
  /**
   * @param {string} key
   * @param {any} fallback what it is if nothing, or nothing readable, is kept
   */
  get(key, fallback) {
    try {
      const text = memory.has(key) ? memory.get(key) : localStorage.getItem(PREFIX + key);
      return text === null ? fallback : JSON.parse(text);
    } catch {
      return fallback;
    }
  },

  /**
   * @param {string} key
   * @param {any} value null forgets it
   */
  set(key, value) {
    const text = JSON.stringify(value);
    try {
      if (value === null) localStorage.removeItem(PREFIX + key);
      else localStorage.setItem(PREFIX + key, text);
      memory.delete(key);
    } catch {
      memory.set(key, text);
    }
  },
};
