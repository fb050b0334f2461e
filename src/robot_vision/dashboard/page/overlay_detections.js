/** Things that were found: boxes, outlines, names. */

import { BAD, colorOf, number } from "./overlay_pen.js";

const VELOCITY_TIME = 0.3; // s that the arrow of a velocity looks ahead
const MIN_VELOCITY = 8; // px/s
const MIN_CONFIDENCE = 0.2; // of a keypoint

/** COCO's skeleton: which joints of the 17 are connected. */
const SKELETON = [
  [15, 13],
  [13, 11],
  [16, 14],
  [14, 12],
  [11, 12],
  [5, 11],
  [6, 12],
  [5, 6],
  [5, 7],
  [6, 8],
  [7, 9],
  [8, 10],
  [1, 2],
  [0, 1],
  [0, 2],
  [1, 3],
  [2, 4],
];

function drawKeypoints(pen, keypoints, color) {
  const sure = keypoints.map(({ z }) => !(z < MIN_CONFIDENCE));
  if (keypoints.length === 17) {
    for (const [a, b] of SKELETON)
      if (sure[a] && sure[b]) pen.line(keypoints[a], keypoints[b], color);
  }
  pen.dots(
    keypoints.filter((_, index) => sure[index]),
    color,
    3,
  );
}

/** @param {any} detection */
function nameOf({ label, id, score }) {
  const parts = [label || (id >= 0 ? "object" : "?")];
  if (id >= 0) parts.push(`#${id}`);
  if (score > 0 && score < 0.995) parts.push(`${number(100 * score)} %`);
  return parts.join("  ");
}

/** Whether a thing looks like a circle: one that only goes around it would cover much else. */
function isRound({ box, circle_radius: radius }) {
  const [short, long] = [box.width, box.height].sort((a, b) => a - b);
  return radius > 0 && short > 0.75 * long && radius < 0.58 * long;
}

/**
 * A mask is drawn as its outline, filled: most masks are too large to come with each image.
 * @param {import("./overlay_pen.js").Pen} pen
 */
function drawShape(pen, detection, color) {
  const { box, outline = [], circle_center: center, circle_radius: radius, mask, _cut } = detection;
  const style = { dashed: detection.predicted };
  const hasMask = Boolean(mask?.length || _cut?.mask);
  if (isRound(detection) && !hasMask) pen.circle(center, radius, color, style);
  else if (outline.length > 2 && !_cut?.outline)
    pen.polygon(outline, color, { ...style, fill: hasMask });
  else pen.box(box, color, style);
}

/** @param {import("./overlay_pen.js").Pen} pen */
export function drawDetections(pen, { detections }, all) {
  const identities = all.find(({ type }) => type === "robot_vision/FaceIdentityArray");
  for (const detection of detections) {
    const { box, center, velocity } = detection;
    const color = colorOf(detection.label, detection.id);
    drawShape(pen, detection, color);
    drawKeypoints(pen, detection.keypoints || [], color);
    if (detection.has_velocity && Math.hypot(velocity.x, velocity.y) > MIN_VELOCITY) {
      const end = {
        x: center.x + VELOCITY_TIME * velocity.x,
        y: center.y + VELOCITY_TIME * velocity.y,
      };
      pen.arrow(center, end, color);
    }
    const named = identities?.data.identities.some(({ id }) => id === detection.id && id >= 0);
    if (!named) pen.label(nameOf(detection), { x: box.x_offset, y: box.y_offset }, color);
  }
}

/** Names of faces: at the detections with their ids, or in their order if they have none. */
export function drawIdentities(pen, { identities }, all) {
  const found = all.find(({ type }) => type === "robot_vision/DetectionArray");
  identities.forEach((identity, index) => {
    const faces = found?.data.detections || [];
    const face = identity.id < 0 ? faces[index] : faces.find(({ id }) => id === identity.id);
    if (!face) return;
    const text = identity.known ? `${identity.name}  ${number(identity.distance, 2)}` : "unknown";
    pen.label(
      text,
      { x: face.box.x_offset, y: face.box.y_offset },
      colorOf(identity.name, face.id),
    );
  });
}

export function drawTracks(pen, { tracks }) {
  for (const { id, label, state, points = [], confidence } of tracks) {
    const name = `${label || "object"} #${id}`;
    if (state === 1) pen.dots(points, colorOf(label, id), 1.5);
    if (state === 1)
      pen.corner(`${name}  followed, ${number(100 * confidence)} %`, colorOf(label, id));
    else pen.corner(`${name}  lost, searched for`, BAD);
  }
}

/** As darknet_ros has them. */
export function drawBoundingBoxes(pen, { bounding_boxes: boxes }) {
  for (const { xmin, ymin, xmax, ymax, Class: label, probability } of boxes) {
    const color = colorOf(label);
    pen.box({ x_offset: xmin, y_offset: ymin, width: xmax - xmin, height: ymax - ymin }, color);
    pen.label(nameOf({ label, id: -1, score: probability }), { x: xmin, y: ymin }, color);
  }
}

/** As vision_msgs has them: boxes that may be turned. */
export function drawDetections2D(pen, { detections }) {
  for (const { bbox, results } of detections) {
    const { x, y, theta = 0 } = bbox.center;
    const [cos, sin] = [Math.cos(theta) / 2, Math.sin(theta) / 2];
    const corners = [
      [-1, -1],
      [1, -1],
      [1, 1],
      [-1, 1],
    ].map(([i, j]) => ({
      x: x + i * bbox.size_x * cos - j * bbox.size_y * sin,
      y: y + i * bbox.size_x * sin + j * bbox.size_y * cos,
    }));
    const best = results[0];
    const label = best ? `class ${best.id}` : "?";
    pen.polygon(corners, colorOf(label));
    pen.label(nameOf({ label, id: -1, score: best?.score }), corners[0], colorOf(label));
  }
}

/** Where things are in space: their distance, in words, at their boxes. */
export function drawDetections3D(pen, { detections }) {
  for (const { box, label, id, pose } of detections) {
    const { x, y, z } = pose.pose.position;
    const color = colorOf(label, id);
    pen.box(box, color);
    pen.label(
      `${label}  ${number(Math.hypot(x, y, z), 2)} m`,
      { x: box.x_offset, y: box.y_offset },
      color,
    );
  }
}
