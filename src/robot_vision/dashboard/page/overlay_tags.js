/** Tags: their outlines, ids, distances and axes. */

import { colorOf, number } from "./overlay_pen.js";

/**
 * The image of a point of a tag's plane, by the homography of its four corners.
 * @param {{x: number, y: number}[]} corners bottom left, bottom right, top right, top left
 * @returns {(u: number, v: number) => {x: number, y: number}} u to the right, v up, 0 to 1
 */
export function squareToImage(corners) {
  const [a, b, c, d] = corners;
  const sx = a.x - b.x + c.x - d.x;
  const sy = a.y - b.y + c.y - d.y;
  const [dx1, dy1, dx2, dy2] = [b.x - c.x, b.y - c.y, d.x - c.x, d.y - c.y];
  const determinant = dx1 * dy2 - dx2 * dy1 || 1e-9;
  const g = (sx * dy2 - dx2 * sy) / determinant;
  const h = (dx1 * sy - sx * dy1) / determinant;
  const [m, n] = [b.x - a.x + g * b.x, d.x - a.x + h * d.x];
  const [p, q] = [b.y - a.y + g * b.y, d.y - a.y + h * d.y];
  return (u, v) => {
    const w = g * u + h * v + 1;
    return { x: (m * u + n * v + a.x) / w, y: (p * u + q * v + a.y) / w };
  };
}

/**
 * The ends of a tag's axes in the image: x and y by its corners; z by its pose, along the line of
 * sight's change.
 * @param {any} tag
 * @returns {{x: number, y: number}[]}
 */
export function axisEnds(tag) {
  const at = squareToImage(tag.corners);
  const ends = [at(0.95, 0.5), at(0.5, 0.95)];
  if (!tag.has_pose) return ends;
  const { position, orientation } = tag.pose.pose;
  const { x, y, z, w } = orientation;
  const columns = [
    // the tag's axes in the camera's frame
    [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
    [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
    [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
  ];
  const origin = [position.x, position.y, position.z];
  const length = 0.45 * tag.size;
  const ray = (axis) => {
    const point = origin.map((value, index) => value + length * (axis ? axis[index] : 0));
    return [point[0] / point[2], point[1] / point[2]];
  };
  const center = at(0.5, 0.5);
  const [o, rx, ry, rz] = [ray(null), ...columns.map(ray)];
  const [ex, ey] = ends;
  // Near the tag pixels are an affine map of rays; x and y tell which.
  const [ax, ay, bx, by] = [rx[0] - o[0], rx[1] - o[1], ry[0] - o[0], ry[1] - o[1]];
  const determinant = ax * by - ay * bx;
  if (Math.abs(determinant) < 1e-12) return ends;
  const [cx, cy] = [rz[0] - o[0], rz[1] - o[1]];
  const s = (cx * by - cy * bx) / determinant;
  const t = (ax * cy - ay * cx) / determinant;
  ends.push({
    x: center.x + s * (ex.x - center.x) + t * (ey.x - center.x),
    y: center.y + s * (ex.y - center.y) + t * (ey.y - center.y),
  });
  return ends;
}

/** @param {import("./overlay_pen.js").Pen} pen */
export function drawTags(pen, { detections }) {
  for (const tag of detections) {
    const color = colorOf(tag.family, tag.id);
    pen.polygon(tag.corners, color);
    pen.axes(squareToImage(tag.corners)(0.5, 0.5), axisEnds(tag));
    const { x, y, z } = tag.pose?.pose.position || {};
    const distance = tag.has_pose ? `  ${number(Math.hypot(x, y, z), 2)} m` : "";
    const left = Math.min(...tag.corners.map((corner) => corner.x));
    const top = Math.min(...tag.corners.map((corner) => corner.y));
    pen.label(`${tag.id}${distance}`, { x: left, y: top }, color);
  }
}
