/** The canvas of the view in space: what is in it, where frames are, and the words over it. */

import { el } from "./dom.js";
import { Renderer } from "./gl.js";
import { IDENTITY, multiply, perspective, poseMatrix, transform } from "./gl_matrices.js";
import { Orbit } from "./orbit.js";
import { requestPaint } from "./painter.js";
import { showLabels } from "./scene_labels.js";
import { shapeOfFrames, shapeOfGrid } from "./scene_shape.js";

const MAX_RATIO = 2; // px of the canvas for one of CSS
const PAINT_PERIOD = 100; // ms between images of what comes by itself
const IMAGE_PERIOD = 250; // ms between the images of a camera
const FIT_TIME = 2500; // ms, after the start and another fixed frame
const SAMPLES = 200; // points of a cloud that tell where it is
const GL_KINDS = ["lines", "triangles"];

export class SceneView {
  /** @throws {Error} there is no WebGL */
  constructor() {
    this.canvas = el("canvas", {
      class: "scene-canvas",
      tabindex: 0,
      role: "img",
      "data-test": "scene",
      "aria-label": "View in space. Arrows turn, shift and arrows move, + and - zoom.",
    });
    this.renderer = new Renderer(this.canvas);
    this.words = el("div", { class: "scene-labels", "aria-hidden": "true" });
    this.element = el("div", { class: "scene" }, this.canvas, this.words);
    /** @type {Map<string, any>} what is shown by topic: {frame, batches, labels, points, image} */
    this.things = new Map();
    this.frames = new Map(); // matrix by name, in the fixed frame
    this.root = "";
    this.showsFrames = true;
    this.painted = 0; // ms
    this.timer = 0;
    this.fitUntil = performance.now() + FIT_TIME;
    this.imageOf = (_beside) => null;
    this.onRestored = () => {}; // what had come is lost
    this.orbit = new Orbit(this.canvas, () => requestPaint(this));
    this.observer = new ResizeObserver(() => requestPaint(this));
    this.observer.observe(this.element);
    this.theme = new MutationObserver(() => this.setGrid());
    this.theme.observe(document.documentElement, {
      attributes: true,
      attributeFilter: ["data-theme"],
    });
    this.canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.isLost = true;
    });
    this.canvas.addEventListener("webglcontextrestored", () => {
      this.isLost = false;
      this.renderer = new Renderer(this.canvas);
      this.things.clear();
      this.setGrid();
      if (this.lastFrames) this.setFrames(this.lastFrames);
      this.onRestored();
    });
    this.setGrid();
  }

  setGrid() {
    const style = getComputedStyle(document.documentElement);
    const color = (name) =>
      [1, 3, 5].map(
        (at) =>
          parseInt(
            style
              .getPropertyValue(name)
              .trim()
              .slice(at, at + 2),
            16,
          ) || 0,
      );
    this.background = color("--bg").map((value) => value / 255);
    this.set("grid", shapeOfGrid(this.orbit.up, 0.5, color("--line")));
  }

  /** @param {any} data of the operation `frames` */
  setFrames(data) {
    if (data.root !== this.root) {
      this.root = data.root;
      this.orbit.touched = false;
      this.fitUntil = performance.now() + FIT_TIME;
    }
    this.frames = new Map(
      data.frames.map((frame) => [frame.name, poseMatrix(frame.position, frame.orientation)]),
    );
    this.frames.set(data.root, IDENTITY);
    this.lastFrames = data;
    this.set("frames", this.showsFrames ? shapeOfFrames(data, 0.2) : null);
  }

  /** What is up in the fixed frame: optical frames have y down, all others z up. */
  setUp() {
    const things = [...this.things.values()];
    const frame = this.root || things.find((thing) => thing.frame)?.frame || "";
    const isCamera = things.some((thing) => thing.image && thing.frame === frame);
    const up = isCamera || frame.endsWith("optical_frame") ? [0, -1, 0] : [0, 0, 1];
    if (up[1] === this.orbit.up[1]) return;
    this.orbit.up = up;
    this.setGrid();
  }

  showFrames(on) {
    this.showsFrames = on;
    if (this.lastFrames) this.setFrames(this.lastFrames);
  }

  /**
   * @param {string} name of a topic
   * @param {import("./scene_shape.js").Shape|null} shape null: nothing
   */
  set(name, shape) {
    const before = this.things.get(name);
    if (!shape) this.remove(name);
    else {
      const packed = shape.packed();
      const batches = GL_KINDS.map((kind, at) =>
        this.renderer.batch(
          packed[kind].data,
          packed[kind].count,
          /** @type {any} */ (kind),
          before?.batches[at],
        ),
      );
      this.things.set(name, {
        drawn: before?.drawn,
        frame: shape.frame,
        batches,
        labels: shape.labels,
        image: shape.image,
        places: shape.kinds.lines.positions,
      });
      if (name !== "grid") this.arranged();
    }
    this.paintSoon();
  }

  /**
   * @param {string} name
   * @param {string} frame
   * @param {{header: any, payload: Uint8Array}} data
   */
  setPoints(name, frame, { header, payload }) {
    const before = this.things.get(name);
    const batch = this.renderer.batch(payload, header.width, "points", before?.batches[0]);
    const places = sampled(payload, header.width);
    this.things.set(name, { frame, batches: [batch], labels: [], image: null, places });
    this.arranged();
    this.paintSoon();
  }

  remove(name) {
    const thing = this.things.get(name);
    if (!thing) return;
    [...thing.batches, thing.drawn].forEach((batch) => batch && this.renderer.forget(batch));
    this.things.delete(name);
    this.paintSoon();
  }

  /** Turns to what there is, in the first moments and as long as the user has not. */
  arranged() {
    this.setUp();
    if (!this.orbit.touched && performance.now() < this.fitUntil) this.fit();
  }

  /** Looks at all there is. */
  fit() {
    const points = [];
    for (const [name, thing] of this.things) {
      const model = this.model(thing);
      if (name === "grid" || !model) continue;
      for (let at = 0; at < thing.places.length; at += 3)
        points.push(transform(model, thing.places.slice(at, at + 3)).slice(0, 3));
    }
    this.orbit.fit(points);
  }

  model(thing) {
    return thing.frame === "" || !this.root ? IDENTITY : this.frames.get(thing.frame);
  }

  paint() {
    if (this.isLost || !this.canvas.isConnected) return;
    this.painted = performance.now();
    const ratio = Math.min(devicePixelRatio, MAX_RATIO);
    const [width, height] = [this.element.clientWidth, this.element.clientHeight];
    if (!width || !height) return;
    const size = [Math.round(width * ratio), Math.round(height * ratio)];
    if (this.canvas.width !== size[0] || this.canvas.height !== size[1])
      [this.canvas.width, this.canvas.height] = size;
    const { distance } = this.orbit;
    const eye = multiply(
      perspective(width / height, distance / 100, distance * 100 + 50),
      this.orbit.view(),
    );
    this.renderer.begin(size[0], size[1], this.background);
    /** @type {[any, number[]][]} */
    const labels = [];
    const seeThrough = [];
    for (const thing of this.things.values()) {
      const model = this.model(thing);
      if (!model) continue;
      const view = multiply(eye, model);
      this.drawImage(thing, view);
      for (const batch of thing.batches) {
        if (batch.kind === "triangles") seeThrough.push([batch, view]);
        else this.renderer.draw(batch, view, 9 * ratio);
      }
      for (const label of thing.labels) labels.push([label, view]);
    }
    labels.reverse(); // The frames were the first, and give way.
    for (const [batch, view] of seeThrough) this.renderer.draw(batch, view);
    showLabels(this.words, labels, width, height);
  }

  /** The image of a camera, if a tile shows it; only now and then a new one. */
  drawImage(thing, view) {
    const image = thing.image && this.imageOf(thing.image.beside);
    if (!image) return;
    const isDue = !thing.drawn || this.painted - thing.drawn.at > IMAGE_PERIOD;
    const { corners } = thing.image;
    thing.drawn = this.renderer.drawImage(isDue ? image : null, corners, view, thing.drawn);
    if (isDue) thing.drawn.at = this.painted;
  }

  /** Paints what has come, not more often than messages come: images have the time between. */
  paintSoon() {
    if (this.timer) return;
    const wait = Math.max(0, this.painted + PAINT_PERIOD - performance.now());
    this.timer = setTimeout(() => {
      this.timer = 0;
      requestPaint(this);
    }, wait);
  }

  close() {
    clearTimeout(this.timer);
    this.observer.disconnect();
    this.theme.disconnect();
    this.renderer.gl.getExtension("WEBGL_lose_context")?.loseContext();
    this.isLost = true;
  }
}

/**
 * @param {Uint8Array} payload positions, then colors
 * @param {number} count
 * @returns {number[]} the positions of some of the points
 */
function sampled(payload, count) {
  const view = new DataView(payload.buffer, payload.byteOffset);
  const step = 12 * Math.max(1, Math.floor(count / SAMPLES));
  const places = [];
  for (let at = 0; at < 12 * count; at += step) {
    for (const offset of [0, 4, 8]) places.push(view.getFloat32(at + offset, true));
  }
  return places;
}
