/** Sets parameters while somebody drags: one request at a time, and of what waits the newest. */

export class LiveValues {
  /**
   * @param {any} app
   * @param {string} node
   * @param {(values: Object<string, any>, refused: Object<string, string>) => void} onAnswer what
   *   the node has now, but
   *   for what is being set anew already; and why what was refused
   */
  constructor(app, node, onAnswer) {
    this.app = app;
    this.node = node;
    this.onAnswer = onAnswer;
    /** @type {Object<string, any>} */
    this.waiting = {};
    this.busy = false;
  }

  /** @param {Object<string, any>} values */
  set(values) {
    Object.assign(this.waiting, values);
    if (!this.busy) this.send();
  }

  async send() {
    this.busy = true;
    const values = this.waiting;
    this.waiting = {};
    try {
      const answer = await this.app.connection.request("set_parameters", {
        node: this.node,
        values,
      });
      this.tell(answer.values, answer.refused);
    } catch (error) {
      const refused = Object.fromEntries(Object.keys(values).map((name) => [name, error.message]));
      this.tell({}, refused);
    }
    this.busy = false;
    if (Object.keys(this.waiting).length) this.send();
  }

  tell(values, refused) {
    const newer = (entries) =>
      Object.fromEntries(Object.entries(entries).filter(([name]) => !(name in this.waiting)));
    this.onAnswer(newer(values), newer(refused));
  }
}
