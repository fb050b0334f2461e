/** Lines, faces and words in space, in the frame of each; frames and the grid are made of them. */

import { cross, IDENTITY, poseMatrix, transform, unit } from "./gl_matrices.js";

const AXES = [
  [235, 87, 87],
  [76, 190, 110],
  [82, 143, 255],
]; // x, y, z
const DEVIATIONS = 2; // of an ellipsoid of uncertainty: inside it in 74 % of the cases
const CIRCLE = 24; // corners
const FACES = [
  [0, 1, 3, 2],
  [4, 5, 7, 6],
  [0, 1, 5, 4],
  [2, 3, 7, 6],
  [0, 2, 6, 4],
  [1, 3, 7, 5],
];
const EDGES = [
  [0, 1],
  [2, 3],
  [4, 5],
  [6, 7],
  [0, 2],
  [1, 3],
  [4, 6],
  [5, 7],
  [0, 4],
  [1, 5],
  [2, 6],
  [3, 7],
];

/** Collects what is drawn of one message. */
export class Shape {
  /** @param {string} frame of all positions */
  constructor(frame) {
    this.frame = frame.replace(/^\//, "");
    this.kinds = { lines: { positions: [], colors: [] }, triangles: { positions: [], colors: [] } };
    /** @type {{at: number[], text: string, color: string}[]} */
    this.labels = [];
    this.image = null; // {corners, topic} of a camera
  }

  add(kind, points, color, alpha = 255) {
    for (const point of points) {
      this.kinds[kind].positions.push(point[0], point[1], point[2]);
      this.kinds[kind].colors.push(...color, alpha);
    }
  }

  line(a, b, color) {
    this.add("lines", [a, b], color);
  }

  /** @param {number[][]} corners of a flat convex shape */
  face(corners, color, alpha) {
    for (let at = 1; at + 1 < corners.length; at++)
      this.add("triangles", [corners[0], corners[at], corners[at + 1]], color, alpha);
  }

  outline(corners, color) {
    corners.forEach((corner, at) => this.line(corner, corners[(at + 1) % corners.length], color));
  }

  /** @param {number[]} pose a matrix @param {number} length m */
  axes(pose, length) {
    const origin = transform(pose, [0, 0, 0]);
    AXES.forEach((color, axis) =>
      this.line(
        origin,
        transform(
          pose,
          [0, 1, 2].map((one) => (one === axis ? length : 0)),
        ),
        color,
      ),
    );
  }

  /** @param {number[]} pose of the middle @param {number[]} low @param {number[]} high m */
  box(pose, low, high, color) {
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((bits) =>
      transform(
        pose,
        [0, 1, 2].map((axis) => ((bits >> axis) & 1 ? high : low)[axis]),
      ),
    );
    for (const [a, b] of EDGES) this.line(corners[a], corners[b], color);
    for (const face of FACES)
      this.face(
        face.map((corner) => corners[corner]),
        color,
        40,
      );
  }

  /** The ellipsoid of a covariance, by its three great circles. */
  ellipsoid(middle, covariance, color) {
    const root = cholesky(
      [0, 1, 2].map((row) => [0, 1, 2].map((column) => covariance[6 * row + column])),
    );
    if (!root) return;
    for (const [a, b] of [
      [0, 1],
      [1, 2],
      [2, 0],
    ]) {
      this.outline(
        Array.from({ length: CIRCLE }, (_, at) => {
          const round = [0, 0, 0];
          round[a] = DEVIATIONS * Math.cos((2 * Math.PI * at) / CIRCLE);
          round[b] = DEVIATIONS * Math.sin((2 * Math.PI * at) / CIRCLE);
          return root.map(
            (row, axis) => middle[axis] + row[0] * round[0] + row[1] * round[1] + row[2] * round[2],
          );
        }),
        color,
      );
    }
  }

  label(at, text, color = "") {
    this.labels.push({ at: at.slice(0, 3), text, color });
  }

  /** @returns {Object<string, {data: Uint8Array, count: number}>} for Renderer.batch */
  packed() {
    return Object.fromEntries(
      Object.entries(this.kinds).map(([kind, { positions, colors }]) => {
        const count = positions.length / 3;
        const data = new Uint8Array(16 * count);
        new Float32Array(data.buffer, 0, 3 * count).set(positions);
        data.set(colors, 12 * count);
        return [kind, { data, count }];
      }),
    );
  }
}

/**
 * @param {number[][]} m symmetric, 3x3
 * @returns {number[][]|null} the lower triangle whose square it is; null: there is none
 */
export function cholesky(m) {
  const root = [
    [0, 0, 0],
    [0, 0, 0],
    [0, 0, 0],
  ];
  for (let row = 0; row < 3; row++) {
    for (let column = 0; column <= row; column++) {
      let sum = m[row][column];
      for (let k = 0; k < column; k++) sum -= root[row][k] * root[column][k];
      if (!Number.isFinite(sum) || (row === column && sum < 0)) return null;
      root[row][column] =
        row === column ? Math.sqrt(sum) : root[column][column] && sum / root[column][column];
    }
  }
  return root;
}

/**
 * All frames, with a line to the parent of each.
 * @param {any} data of the operation `frames`
 * @param {number} length m, of the axes
 */
export function shapeOfFrames(data, length) {
  const shape = new Shape(data.root);
  const places = new Map(data.frames.map((frame) => [frame.name, frame.position]));
  places.set(data.root, [0, 0, 0]);
  shape.axes(IDENTITY, length);
  if (data.root) shape.label([0, 0, 0], data.root);
  for (const { name, parent, position, orientation } of data.frames) {
    if (name === data.root) continue;
    const pose = poseMatrix(position, orientation);
    shape.axes(pose, length);
    shape.label(position, name);
    if (places.has(parent)) shape.line(places.get(parent), position, [120, 130, 145]);
  }
  return shape;
}

/**
 * @param {number[]} up a unit vector
 * @param {number} step m
 * @param {number[]} color
 * @returns {Shape} a grid across it
 */
export function shapeOfGrid(up, step, color) {
  const shape = new Shape("");
  const right = unit(cross(Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0], up));
  const ahead = cross(up, right);
  const at = (a, b) => right.map((value, axis) => (value * a + ahead[axis] * b) * step);
  for (let line = -10; line <= 10; line++) {
    shape.line(at(line, -10), at(line, 10), color);
    shape.line(at(-10, line), at(10, line), color);
  }
  return shape;
}
