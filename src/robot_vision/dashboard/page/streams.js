/** Images and messages that come from the server: one stream of each topic, whoever shows it. */

import { widerStep } from "./geometry.js";
import { afterPaint } from "./painter.js";
import { StampBuffer } from "./stamps.js";

const KEPT_FRAMES = 5; // decoded, for tiles that wait for what was made of them

/**
 * @typedef {Object} Frame
 * @property {ImageBitmap} bitmap
 * @property {any} header see channels.js
 * @property {number} at ms, when it was decoded
 */

/**
 * @typedef {Object} FrameListener
 * @property {number} width px to ask for, 0: as it is
 * @property {(frame: Frame) => void} onFrame
 * @property {(text: string) => void} onError
 */

/**
 * @typedef {Object} MessageListener
 * @property {(stamp: number) => void} onMessage a message has come
 * @property {(text: string) => void} onError why there is none that can be read
 */

/**
 * The images of one topic. All who show it share the channel of the largest of the sizes that they
 * need.
 */
class ImageStream {
  /** @param {any} app @param {string} topic */
  constructor(app, topic) {
    this.app = app;
    this.topic = topic;
    /** @type {Set<FrameListener>} */
    this.listeners = new Set();
    /** @type {Frame[]} */
    this.frames = [];
    this.arrivals = 0;
    this.newest = 0; // the arrival that was decoded last
    this.width = -1;
    this.close = null;
    this.closeOld = null; // the channel of another size, until an image of the new one is there
  }

  /** Opens the channel that is needed now. */
  update() {
    if (!this.listeners.size) {
      this.end();
      return;
    }
    const width = [...this.listeners].map((listener) => listener.width).reduce(widerStep);
    const quality = this.app.storage.get("quality", 80);
    if (this.close && width === this.width && quality === this.quality) return;
    this.width = width;
    this.quality = quality;
    if (this.closeOld) this.close?.();
    else this.closeOld = this.close;
    const close = this.app.connection.channel(
      "image",
      { topic: this.topic, width, quality },
      (data) => this.receive(data, close),
      (text) => this.listeners.forEach((listener) => listener.onError(text)),
    );
    this.close = close;
  }

  /** @param {any} data @param {() => void} close what closes the channel that it came by */
  async receive({ header, payload }, close) {
    const arrival = ++this.arrivals;
    const type = header.kind === 3 ? "image/png" : "image/jpeg";
    const bitmap = await createImageBitmap(new Blob([payload], { type })).catch(() => null);
    if (!bitmap) {
      this.listeners.forEach((listener) => listener.onError("The browser cannot read this image."));
      return;
    }
    if (!this.listeners.size || arrival < this.newest) {
      bitmap.close(); // a later one was decoded sooner, or nobody looks any more
      return;
    }
    this.newest = arrival;
    if (close === this.close) {
      this.closeOld?.();
      this.closeOld = null;
    }
    const frame = { bitmap, header, at: performance.now() };
    this.frames.push(frame);
    while (this.frames.length > KEPT_FRAMES) this.frames.shift().bitmap.close();
    for (const listener of this.listeners) listener.onFrame(frame);
    await afterPaint();
  }

  end() {
    this.close?.();
    this.closeOld?.();
    this.close = this.closeOld = null;
    this.width = -1;
    for (const { bitmap } of this.frames) bitmap.close();
    this.frames = [];
  }
}

/** The messages of one topic. */
class MessageStream {
  /** @param {any} app @param {string} topic */
  constructor(app, topic) {
    this.buffer = new StampBuffer();
    /** @type {Set<MessageListener>} */
    this.listeners = new Set();
    // The channel's stamp is that of the message, or when it came if it has none.
    this.close = app.connection.channel(
      "messages",
      { topic, rate: 0 },
      (data, { stamp }) => {
        this.buffer.add(stamp, data);
        for (const { onMessage } of this.listeners) onMessage(stamp);
      },
      (text) => this.listeners.forEach(({ onError }) => onError(text)),
    );
  }
}

export class Streams {
  /** @param {any} app */
  constructor(app) {
    this.app = app;
    /** @type {Map<string, ImageStream>} */
    this.images = new Map();
    /** @type {Map<string, MessageStream>} */
    this.messages = new Map();
  }

  /**
   * @param {string} topic
   * @param {FrameListener} listener
   */
  openImage(topic, listener) {
    if (!this.images.has(topic)) this.images.set(topic, new ImageStream(this.app, topic));
    const stream = this.images.get(topic);
    stream.listeners.add(listener);
    stream.update();
    return {
      stream,
      resize: (width) => {
        if (width === listener.width) return;
        listener.width = width;
        stream.update();
      },
      close: () => {
        stream.listeners.delete(listener);
        stream.update();
        if (!stream.listeners.size && this.images.get(topic) === stream) this.images.delete(topic);
      },
    };
  }

  /**
   * @param {string} topic
   * @param {MessageListener} listener
   * @returns {{buffer: StampBuffer, close: () => void}}
   */
  openMessages(topic, listener) {
    if (!this.messages.has(topic)) this.messages.set(topic, new MessageStream(this.app, topic));
    const stream = this.messages.get(topic);
    stream.listeners.add(listener);
    return {
      buffer: stream.buffer,
      close: () => {
        stream.listeners.delete(listener);
        if (stream.listeners.size) return;
        stream.close();
        this.messages.delete(topic);
      },
    };
  }

  /** Asks for all images anew, because the wanted quality is another one. */
  updateAll() {
    for (const stream of this.images.values()) stream.update();
  }
}
