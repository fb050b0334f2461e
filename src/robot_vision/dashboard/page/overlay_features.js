/** Lines, lanes, contours, keypoints, motion. */

import { BAD, GOOD, PALETTE, colorOf, number } from "./overlay_pen.js";

const FLOW_TIME = 0.15; // s that the arrow of a velocity looks ahead
const LANE_AHEAD = 2.5; // m that the drawing of a lane shows
const degrees = (angle) => `${number((angle * 180) / Math.PI)}°`;

/** @param {import("./overlay_pen.js").Pen} pen */
export function drawLine(pen, { found, center, offset, angle, confidence }) {
  if (!found) {
    pen.corner("no line", BAD);
    return;
  }
  const length = 0.18 * pen.size[1];
  const tip = { x: center.x + length * Math.sin(angle), y: center.y - length * Math.cos(angle) };
  const middle = { x: (pen.size[0] - 1) / 2, y: center.y };
  pen.line(middle, center, PALETTE[1], { dashed: true });
  pen.arrow(center, tip, GOOD, { width: 3 });
  pen.dots([center], GOOD, 4);
  pen.corner(`offset ${number(offset, 2)}  ${degrees(angle)}  ${number(100 * confidence)} %`, GOOD);
}

/** A lane is known on the floor, in metres: it is drawn as seen from above, in the corner. */
export function drawLane(pen, { found, offset, heading, width, middle, left, right }) {
  if (!found) {
    pen.corner("no lane", BAD);
    return;
  }
  pen.corner(
    `offset ${number(100 * offset)} cm  ${degrees(heading)}  width ${number(100 * width)} cm`,
    GOOD,
  );
  const { unit, size, context } = pen;
  const box = {
    width: Math.min(110 * unit, 0.3 * size[0]),
    height: Math.min(130 * unit, 0.5 * size[1]),
  };
  const x = size[0] - box.width - 6 * unit;
  const y = size[1] - box.height - 6 * unit;
  const scale = box.height / LANE_AHEAD;
  const place = (point) => ({
    x: x + box.width / 2 - point.y * scale,
    y: y + box.height - point.x * scale,
  });
  context.save();
  context.fillStyle = "rgb(10 13 17 / 70%)";
  context.fillRect(x, y, box.width, box.height);
  context.beginPath();
  context.rect(x, y, box.width, box.height);
  context.clip();
  const style = { open: true, origin: 0 };
  for (const line of [left, right])
    if (line.found) pen.polygon(line.points.map(place), PALETTE[4], style);
  pen.polygon(middle.map(place), GOOD, { ...style, dashed: true });
  pen.dots([place({ x: 0, y: 0 })], "#fff", 4, 0);
  context.restore();
}

/** Tells that not all is drawn: the server cuts what is too long, and says of how many. */
function tellPart(pen, count, total, name) {
  if (count < total) pen.corner(`${count} of ${total} ${name}`, BAD);
}

export function drawContours(pen, { contours, has_point: hasPoint, point, _cut: cut }) {
  contours.forEach(({ outline, box, label, hole, depth, _cut }) => {
    const color = label ? colorOf(label) : PALETTE[depth % PALETTE.length];
    // Of an outline that was cut the beginning is right; what would close it is not.
    pen.polygon(outline, color, { dashed: hole, width: 1.5, open: Boolean(_cut?.outline) });
    if (label) pen.label(label, { x: box.x_offset, y: box.y_offset }, color);
  });
  const whole = contours.filter(({ _cut }) => !_cut?.outline);
  tellPart(pen, whole.length, cut?.contours ?? contours.length, "contours are drawn whole");
  if (hasPoint) pen.dots([point], "#fff", 4);
}

/** Apply a homography, row by row, to a point. @param {number[]} h @param {number[]} point */
function mapped(h, [x, y]) {
  const w = h[6] * x + h[7] * y + h[8] || 1e-9;
  return { x: (h[0] * x + h[1] * y + h[2]) / w, y: (h[3] * x + h[4] * y + h[5]) / w };
}

export function drawMatches(
  pen,
  { reference, reference_points: from, points, inliers, found, homography, _cut },
) {
  const fits = points.filter((_, index) => inliers[index]);
  const others = points.filter((_, index) => !inliers[index]);
  if (!reference)
    from.forEach((start, index) =>
      pen.line(start, points[index], inliers[index] ? GOOD : BAD, { width: 1 }),
    );
  pen.dots(others, BAD, 2);
  pen.dots(fits, GOOD, 2.5);
  if (found && reference && from.length) {
    const right = Math.max(...from.map(({ x }) => x));
    const bottom = Math.max(...from.map(({ y }) => y));
    const [left, top] = [Math.min(...from.map(({ x }) => x)), Math.min(...from.map(({ y }) => y))];
    const corners = [
      [left, top],
      [right, top],
      [right, bottom],
      [left, bottom],
    ];
    pen.polygon(
      corners.map((corner) => mapped(homography, corner)),
      GOOD,
    );
  }
  const name = reference || "frame before";
  pen.corner(`${name}: ${fits.length} of ${points.length} points agree`, found ? GOOD : BAD);
  tellPart(pen, points.length, _cut?.points, "points are drawn");
}

export function drawKeypoints(pen, { x, y, size, angle, _cut }) {
  const { context } = pen;
  pen.stroke(
    PALETTE[1],
    () =>
      x.forEach((left, index) => {
        const radius = Math.max(2 * pen.unit, (size[index] || 0) / 2);
        context.moveTo(left + radius, y[index]);
        context.arc(left, y[index], radius, 0, 2 * Math.PI);
        if (angle[index] >= 0) {
          context.moveTo(left, y[index]);
          context.lineTo(
            left + radius * Math.cos(angle[index]),
            y[index] + radius * Math.sin(angle[index]),
          );
        }
      }),
    { width: 1 },
  );
  tellPart(pen, x.length, _cut?.x, "keypoints are drawn");
}

export function drawFlow(pen, { points, velocities, _cut }) {
  points.forEach((point, index) => {
    const { x, y } = velocities[index];
    pen.arrow(point, { x: point.x + FLOW_TIME * x, y: point.y + FLOW_TIME * y }, PALETTE[1], {
      width: 1.5,
    });
  });
  tellPart(pen, points.length, _cut?.points, "points are drawn");
}

export function drawMotion(pen, { occupied, everywhere, changed }) {
  const share = `${number(100 * changed, 1)} % changed`;
  if (everywhere) pen.corner(`everything changed: light or camera  ${share}`, BAD);
  else
    pen.corner(
      `${occupied ? "something moves" : "nothing moves"}  ${share}`,
      occupied ? PALETTE[1] : GOOD,
    );
}

export function drawGroundTruth(pen, { objects }) {
  for (const { name, outline, center, visible } of objects) {
    if (!visible) continue;
    pen.polygon(outline, "#ffffff", { dashed: true, width: 1 });
    pen.label(name, center, "#ffffff");
  }
}
