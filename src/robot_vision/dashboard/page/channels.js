/**
 * Streams of a connection: what comes with a number of its own, and is acknowledged when it is
 * drawn.
 */

const HEADER_BYTES = 32;
// Ms, until what was refused is asked for again: its topic may have come meanwhile.
const RETRY_DELAY = 3000;

/**
 * @typedef {Object} Header of a binary message
 * @property {number} kind 1 JPEG, 2 points, 3 PNG
 * @property {number} channel
 * @property {number} seq
 * @property {number} stamp s, ROS time
 * @property {number} received s, the server's clock when it had the message
 * @property {number} width px of the original image; the number of points
 * @property {number} height
 */

/**
 * @param {ArrayBuffer} buffer
 * @returns {{header: Header, payload: Uint8Array}}
 */
export function parseBinary(buffer) {
  const view = new DataView(buffer);
  const header = {
    kind: view.getUint8(0),
    channel: view.getUint16(2, true),
    seq: view.getUint32(4, true),
    stamp: view.getFloat64(8, true),
    received: view.getFloat64(16, true),
    width: view.getUint32(24, true),
    height: view.getUint32(28, true),
  };
  return { header, payload: new Uint8Array(buffer, HEADER_BYTES) };
}

export class Channel {
  /**
   * @param {any} connection
   * @param {string} op
   * @param {Object} fields
   * @param {(data: any, header: any) => void|Promise<void>} onData acknowledged when it is done
   * @param {(text: string) => void} [onError] why it could not be opened, which is tried again, or
   *   why a message could not be read
   */
  constructor(connection, op, fields, onData, onError = () => {}) {
    this.connection = connection;
    this.op = op;
    this.fields = fields;
    this.onData = onData;
    this.onError = onError;
    this.number = 0;
    this.closed = false;
    this.timer = 0;
  }

  async open() {
    clearTimeout(this.timer);
    const number = this.connection.newNumber(this);
    this.number = number;
    try {
      await this.connection.request(this.op, { channel: number, ...this.fields });
    } catch (error) {
      this.connection.channels.delete(number);
      if (this.closed || this.number !== number) return;
      this.number = 0;
      this.onError(error.message);
      if (this.connection.state === "open") this.timer = setTimeout(() => this.open(), RETRY_DELAY);
    }
  }

  close() {
    if (this.closed) return;
    this.closed = true;
    clearTimeout(this.timer);
    this.connection.forget(this);
    if (this.number && this.connection.state === "open") {
      this.connection.request("close_channel", { channel: this.number }).catch(() => {});
    }
  }

  /**
   * @param {any} data the message, {_error} if the node could not read it, or {header, payload}
   * @param {any} header with its number in the sequence
   */
  async receive(data, header) {
    const number = this.number;
    try {
      if (this.closed) return;
      if (data._error === undefined) await this.onData(data, header);
      else this.onError(data._error);
    } catch (error) {
      console.error(error);
    }
    if (number === this.number && !this.closed) {
      this.connection.send({ op: "ack", channel: number, seq: header.seq });
    }
  }
}
