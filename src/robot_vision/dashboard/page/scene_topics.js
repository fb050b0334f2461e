/** The topics that are shown in space: their streams and frames, and why some are not. */

import { shapeOf } from "./scene_messages.js";

export const POINTS = "sensor_msgs/PointCloud2";
export const RATE = 10; // Hz, of messages and frames
const FRAME_RATE = 0.1; // Hz, of clouds of which only the frame is wanted
const MAX_POINTS = 60000;
const MAX_LINES = 4; // of what is told

export class SceneTopics {
  /**
   * @param {any} app
   * @param {import("./scene_view.js").SceneView} view
   */
  constructor(app, view) {
    this.connection = app.connection;
    this.view = view;
    /** @type {Map<string, () => void>} what closes each */
    this.open = new Map();
    /** @type {Map<string, string>} the frames of their newest messages */
    this.frames = new Map();
    /** @type {Map<string, string>} */
    this.errors = new Map();
  }

  /** @param {{name: string, type: string}} topic */
  show({ name, type }) {
    if (this.open.has(name)) return;
    this.open.set(name, type === POINTS ? this.openPoints(name) : this.openMessages(name, type));
  }

  openMessages(topic, type) {
    const onMessage = (message) => {
      const shape = shapeOf(type, message, topic);
      this.frames.set(topic, shape.frame);
      this.errors.delete(topic);
      this.view.set(topic, shape);
    };
    return this.channel("messages", { topic, rate: RATE }, onMessage);
  }

  /** A cloud; now and then a message is asked for its frame, which the points do not say. */
  openPoints(topic) {
    let closePoints = null;
    const onPoints = (data) => {
      this.errors.delete(topic);
      if (data.payload) this.view.setPoints(topic, this.frames.get(topic), data);
    };
    const closeFrame = this.channel("messages", { topic, rate: FRAME_RATE }, ({ header }) => {
      this.frames.set(topic, header.frame_id.replace(/^\//, ""));
      closePoints ??= this.channel("points", { topic, max_points: MAX_POINTS }, onPoints);
    });
    return () => {
      closeFrame();
      closePoints?.();
    };
  }

  channel(op, fields, onData) {
    const onError = (text) => this.errors.set(fields.topic, text);
    return this.connection.channel(op, fields, onData, onError);
  }

  /** @param {string} name */
  hide(name) {
    this.open.get(name)?.();
    for (const map of [this.open, this.frames, this.errors]) map.delete(name);
    this.view.remove(name);
  }

  /** @param {(name: string) => boolean} isWanted hides all others */
  keep(isWanted) {
    for (const name of this.open.keys()) if (!isWanted(name)) this.hide(name);
  }

  /** @returns {string} of which topics nothing can be shown, and why */
  problems() {
    const { root, frames } = this.view;
    const lines = [...this.errors].map(([name, text]) => `${name}: ${text}`);
    for (const [name, frame] of this.frames) {
      if (!frame) lines.push(`${name} does not say in which frame it is.`);
      else if (root && !frames.has(frame)) {
        lines.push(`${name}: there is no transform from ${root} to ${frame}.`);
      }
    }
    if (!root && this.frames.size) {
      lines.push("No transforms come on /tf: all is shown as if it were in one frame.");
    }
    return lines.slice(0, MAX_LINES).join("\n");
  }

  close() {
    this.keep(() => false);
  }
}
