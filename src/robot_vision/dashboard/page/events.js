/** Who wants to hear of what. */
export class Events {
  constructor() {
    /** @type {Map<string, Set<Function>>} */
    this.listeners = new Map();
  }

  /**
   * @param {string} kind
   * @param {(data: any) => void} callback
   * @returns {() => void} ends it
   */
  on(kind, callback) {
    if (!this.listeners.has(kind)) this.listeners.set(kind, new Set());
    const set = this.listeners.get(kind);
    set.add(callback);
    return () => set.delete(callback);
  }

  /**
   * One listener's error keeps nothing from the others.
   * @param {string} kind
   * @param {any} [data]
   */
  emit(kind, data) {
    for (const callback of this.listeners.get(kind) || []) {
      try {
        callback(data);
      } catch (error) {
        console.error(error);
      }
    }
  }
}
