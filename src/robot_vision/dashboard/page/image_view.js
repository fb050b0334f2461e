/**
 * An image with what is drawn over it: two canvases, the lower one with the pixels as they came.
 */

import { el } from "./dom.js";
import { widthStep } from "./geometry.js";
import { drawOverlays } from "./overlay.js";
import { requestPaint } from "./painter.js";
import { Pairing } from "./stamps.js";

export class ImageView {
  /**
   * @param {any} app
   * @param {import("./streams.js").Streams} streams
   * @param {(size: [number, number]) => void} onSize a first image, or one of another size
   * @param {(text: string) => void} onError
   */
  constructor(app, streams, onSize, onError) {
    this.app = app;
    this.streams = streams;
    this.onSize = onSize;
    this.onError = onError;
    this.canvas = el("canvas", { class: "pixels", "data-test": "image", width: 4, height: 3 });
    this.overlay = el("canvas", { class: "overlay", "aria-hidden": "true" });
    this.element = el("div", { class: "frame" }, this.canvas, this.overlay);
    /** @type {[number, number]} px of the original image; 0 until one came */
    this.size = [0, 0];
    this.topic = "";
    /** @type {{topic: string, type: string}[]} */
    this.overlays = [];
    /**
     * @type {Map<string, (context: CanvasRenderingContext2D, scale: number) => void>} drawn by
     *   tools
     */
    this.layers = new Map();
    this.feeds = [];
    this.isOpen = false;
    this.image = null;
    this.drawn = null; // the frame that is shown
    this.shown = []; // the messages that are drawn
    this.isDirty = true;
    this.times = []; // ms, when the last frames were drawn
    this.received = 0; // s, the server's clock when it had the last one
    this.latency = 0; // ms, of the last ones, since the server had them
    this.timer = 0;
    new ResizeObserver(() => this.resized()).observe(this.element);
  }

  /**
   * What to show; streams are opened by `open`.
   * @param {string} topic
   * @param {{topic: string, type: string}[]} overlays
   */
  show(topic, overlays) {
    const same = topic === this.topic && JSON.stringify(overlays) === JSON.stringify(this.overlays);
    if (same) return;
    const wasOpen = this.isOpen;
    this.close();
    this.topic = topic;
    this.overlays = overlays;
    this.redraw();
    if (wasOpen) this.open();
  }

  wantedWidth() {
    return widthStep(this.element.clientWidth * devicePixelRatio, this.size[0]);
  }

  /**
   * Opens the streams. Without an image's topic those of what is drawn have the node work, so that
   * it tells on which image it does.
   */
  open() {
    if (this.isOpen) return;
    this.isOpen = true;
    this.feeds = this.overlays.map((overlay) => this.feed(overlay));
    if (!this.topic) return;
    this.image = this.streams.openImage(this.topic, {
      width: this.wantedWidth(),
      onFrame: (frame) => this.arrived(frame),
      onError: (text) => this.onError(text),
    });
    const { frames } = this.image.stream;
    if (frames.length) this.arrived(frames[frames.length - 1]);
  }

  /** The messages of one topic, and why they cannot be drawn. */
  feed({ topic, type }) {
    const feed = { type, pairing: new Pairing(), error: "" };
    const fails = (text) => {
      if (text === feed.error) return;
      feed.error = text;
      this.redraw();
    };
    const onMessage = (stamp) => {
      feed.pairing.message(stamp, performance.now());
      fails("");
      requestPaint(this);
    };
    return Object.assign(feed, this.streams.openMessages(topic, { onMessage, onError: fails }));
  }

  close() {
    clearTimeout(this.timer);
    this.isOpen = false;
    this.image?.close();
    this.feeds.forEach((feed) => feed.close());
    this.image = null;
    this.feeds = [];
    this.times = [];
  }

  arrived(frame) {
    const { header } = frame;
    if (header.width !== this.size[0] || header.height !== this.size[1]) {
      this.size = [header.width, header.height];
      this.onSize(this.size);
      this.image?.resize(this.wantedWidth());
    }
    for (const feed of this.feeds) feed.pairing.image(header.stamp, frame.at);
    requestPaint(this);
  }

  resized() {
    const ratio = devicePixelRatio;
    this.overlay.width = Math.round(this.element.clientWidth * ratio);
    this.overlay.height = Math.round(this.element.clientHeight * ratio);
    this.image?.resize(this.wantedWidth());
    this.redraw();
  }

  /**
   * The frame to show now: the newest one of which all is there that is usually there in time.
   * @param {number} now ms
   * @returns {import("./streams.js").Frame|null} null: the one that is shown
   */
  choose(now) {
    const frames = this.image?.stream.frames || [];
    const fresh = frames.slice(frames.indexOf(this.drawn) + 1);
    const newest = fresh[fresh.length - 1];
    if (!newest) return null;
    const waited = this.feeds.filter((feed) => feed.pairing.hold(now) > 0);
    const whole = fresh.findLast(({ header }) =>
      waited.every((feed) => feed.buffer.at(header.stamp)),
    );
    clearTimeout(this.timer);
    if (whole === newest) return newest;
    const left = newest.at + Math.max(0, ...waited.map((feed) => feed.pairing.hold(now))) - now;
    if (left <= 1) return newest;
    this.timer = setTimeout(() => requestPaint(this), left);
    return whole || null;
  }

  /** @param {number} now ms */
  paint(now) {
    const frame = this.choose(now);
    if (frame) {
      const { bitmap } = frame;
      if (this.canvas.width !== bitmap.width) this.canvas.width = bitmap.width;
      if (this.canvas.height !== bitmap.height) this.canvas.height = bitmap.height;
      this.canvas.getContext("2d", { alpha: false }).drawImage(bitmap, 0, 0);
      this.drawn = frame;
      this.count(frame, now);
    }
    const messages = this.messages();
    const same =
      messages.length === this.shown.length &&
      messages.every(({ data }, index) => data === this.shown[index].data);
    if (!frame && same && !this.isDirty) return;
    this.shown = messages;
    this.isDirty = false;
    this.paintOverlay();
  }

  /** Draws all over the image again, because something else than messages is another. */
  redraw() {
    this.isDirty = true;
    requestPaint(this);
  }

  /** @returns {{type: string, data: any}[]} what belongs to the image that is shown */
  messages() {
    if (!this.drawn) return [];
    return this.feeds.flatMap(({ buffer, type }) => {
      const data = buffer.near(this.drawn.header.stamp);
      return data ? [{ type, data }] : [];
    });
  }

  count({ header }, now) {
    if (this.times.length && header.received === this.received) return; // the same in another size
    this.received = header.received;
    const time = this.app.connection.serverTime();
    const received = (time - header.received) * 1000;
    const stamp = (time - header.stamp) * 1000;
    this.app.statistics.add(this.topic, { stamp, received, waits: this.feeds.length > 0 });
    this.latency = this.times.length ? 0.85 * this.latency + 0.15 * received : received;
    this.times.push(now);
    if (this.times.length > 60) this.times.shift();
  }

  paintOverlay() {
    const { width, height } = this.overlay;
    const context = this.overlay.getContext("2d");
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
    if (!this.drawn || !width || !this.size[0]) return;
    const scale = width / this.size[0];
    context.setTransform(scale, 0, 0, height / this.size[1], 0, 0);
    const errors = new Set(this.feeds.map(({ error }) => error).filter(Boolean));
    const view = { scale, ratio: devicePixelRatio, size: this.size };
    drawOverlays(context, this.shown, view, errors);
    for (const draw of this.layers.values()) {
      context.save();
      draw(context, scale);
      context.restore();
    }
  }

  /**
   * @param {number} now ms
   * @returns {number} frames in a second, as they are drawn
   */
  frameRate(now) {
    const recent = this.times.filter((time) => now - time < 2000);
    if (recent.length < 2) return recent.length / 2;
    return (
      (recent.length - 1) / ((Math.max(now - 250, recent[recent.length - 1]) - recent[0]) / 1000)
    );
  }
}
