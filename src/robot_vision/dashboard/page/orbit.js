/** Looking around in space by mouse, fingers and keys. */

import { cross, lookAt, unit } from "./gl_matrices.js";

const STEP = 0.1; // rad, of a key
const ZOOM = 1.2; // of a key
const MAX_PITCH = 1.55; // rad
const START = { yaw: 2.5, pitch: 0.5, distance: 4, target: [0, 0, 0] };
const OPTICAL_YAW = 2; // rad, behind a camera that looks along z

export class Orbit {
  /** @param {HTMLElement} element @param {() => void} onChange */
  constructor(element, onChange) {
    this.element = element;
    this.onChange = onChange;
    this.up = [0, 0, 1];
    this.pointers = new Map();
    this.touched = false; // by the user, who is then left alone
    this.yaw = START.yaw; // rad
    this.pitch = START.pitch; // rad
    this.distance = START.distance; // m
    this.target = START.target; // m
    const on = (name, run, options) => element.addEventListener(name, run, options);
    on("pointerdown", (event) => {
      element.setPointerCapture(event.pointerId);
      element.focus({ preventScroll: true });
      this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const name of ["pointerup", "pointercancel"])
      on(name, (event) => this.pointers.delete(event.pointerId));
    on("pointermove", (event) => this.moved(event));
    on(
      "wheel",
      (event) => {
        event.preventDefault();
        this.zoom(
          Math.exp(Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), 100) * 0.002),
        );
      },
      { passive: false },
    );
    on("contextmenu", (event) => event.preventDefault());
    on("keydown", (event) => this.key(event));
  }

  moved(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    this.pointers.set(event.pointerId, now);
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    if (other) {
      const length = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]) || 1;
      this.pan(dx / 2, dy / 2);
      this.zoom(length(before) / length(now));
    } else if (event.shiftKey || event.buttons > 1) this.pan(dx, dy);
    else this.turn(-dx * 0.007, dy * 0.007);
  }

  key(event) {
    const { key, shiftKey } = event;
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[
      key
    ];
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (arrow && shiftKey) this.pan(-40 * arrow[0], -40 * arrow[1]);
    else if (arrow) this.turn(STEP * arrow[0], -STEP * arrow[1]);
    else if (key === "+") this.zoom(1 / ZOOM);
    else if (key === "-") this.zoom(ZOOM);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.max(-MAX_PITCH, Math.min(MAX_PITCH, this.pitch + pitch));
    this.change();
  }

  zoom(factor) {
    this.distance = Math.max(0.05, Math.min(1000, this.distance * factor));
    this.change();
  }

  /** @param {number} dx CSS px @param {number} dy */
  pan(dx, dy) {
    const back = this.back();
    const right = unit(cross(this.up, back));
    const top = cross(back, right);
    // m for one of CSS px, at the target
    const scale = (0.93 * this.distance) / Math.max(this.element.clientHeight, 1);
    this.target = this.target.map(
      (value, axis) => value - right[axis] * dx * scale + top[axis] * dy * scale,
    );
    this.change();
  }

  change() {
    this.touched = true;
    this.onChange();
  }

  /**
   * Looks at all of some points.
   * @param {number[][]} points m
   */
  fit(points) {
    const good = points.filter((point) => point.every((value) => Math.abs(value) < 1e4));
    Object.assign(this, START, this.up[2] ? {} : { yaw: OPTICAL_YAW });
    if (good.length) {
      const limits = [Math.min, Math.max].map((pick) =>
        [0, 1, 2].map((axis) => pick(...good.map((point) => point[axis]))),
      );
      this.target = limits[0].map((low, axis) => (low + limits[1][axis]) / 2);
      this.distance = Math.max(
        1,
        0.9 * Math.hypot(...limits[0].map((low, axis) => limits[1][axis] - low)),
      );
    }
    this.touched = false;
    this.onChange();
  }

  /** @returns {number[]} the direction from the target to the eye */
  back() {
    const side = unit(cross(Math.abs(this.up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0], this.up));
    const ahead = cross(this.up, side);
    const [flat, high] = [Math.cos(this.pitch), Math.sin(this.pitch)];
    return this.up.map(
      (value, axis) =>
        value * high + flat * (Math.cos(this.yaw) * ahead[axis] + Math.sin(this.yaw) * side[axis]),
    );
  }

  /** @returns {number[]} a matrix from the fixed frame to the eye */
  view() {
    const back = this.back();
    return lookAt(
      this.target.map((value, axis) => value + this.distance * back[axis]),
      this.target,
      this.up,
    );
  }
}
