/** What messages look like in space. */

import { IDENTITY, poseMatrix, transform } from "./gl_matrices.js";
import { colorOf } from "./overlay_pen.js";
import { Shape } from "./scene_shape.js";

const FRUSTUM = 0.25; // m, from a camera to its image

/** @param {string} text #rrggbb @returns {number[]} */
const rgb = (text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));
const finite = (...values) => values.every(Number.isFinite);

/** @param {any} pose geometry_msgs/Pose @returns {number[]|null} its matrix; null: it has a NaN */
function matrixOf({ position: p, orientation: q }) {
  return finite(p.x, p.y, p.z, q.x, q.y, q.z, q.w)
    ? poseMatrix([p.x, p.y, p.z], [q.x, q.y, q.z, q.w])
    : null;
}

const MAKERS = {
  "robot_vision/TagDetectionArray"(message, shape) {
    for (const tag of message.detections) {
      const pose = tag.has_pose && matrixOf(tag.pose.pose);
      if (!pose) continue;
      const half = tag.size / 2;
      const at = (x, y) => transform(pose, [x * half, y * half, 0]);
      const color = rgb(colorOf("tag", tag.id));
      shape.face([at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)], color, 110);
      shape.outline([at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)], color);
      // The upper left of an upright tag:
      shape.outline([at(-0.8, 0.8), at(-0.4, 0.8), at(-0.4, 0.4), at(-0.8, 0.4)], color);
      shape.axes(pose, half);
      shape.label(at(0, 0), String(tag.id), colorOf("tag", tag.id));
    }
    for (const bundle of message.bundles) {
      const pose = matrixOf(bundle.pose.pose);
      if (!pose) continue;
      shape.axes(pose, 0.1);
      shape.label(transform(pose, [0, 0, 0]), bundle.name);
    }
  },

  "robot_vision/Detection3DArray"(message, shape) {
    for (const found of message.detections) {
      const pose = matrixOf(found.pose.pose);
      if (!pose || !finite(found.size.x, found.size.y, found.size.z)) continue;
      const text = colorOf(found.label, found.id);
      const half = [found.size.x / 2, found.size.y / 2, found.size.z / 2];
      shape.box(
        pose,
        half.map((value) => -value),
        half,
        rgb(text),
      );
      shape.ellipsoid(transform(pose, [0, 0, 0]), found.pose.covariance, [200, 200, 210]);
      const name = [found.label, found.id >= 0 ? found.id : ""].join(" ").trim();
      shape.label(transform(pose, [0, 0, 0]), name, text);
    }
  },

  "robot_vision/TableArray"(message, shape) {
    message.tables.forEach((table, index) => {
      const pose = matrixOf(table.pose);
      if (!pose) return;
      const text = colorOf("table", index + 2);
      const hull = table.convex_hull.map(({ x, y, z }) => transform(pose, [x, y, z]));
      shape.face(hull, rgb(text), 50);
      shape.outline(hull, rgb(text));
      shape.axes(pose, 0.15);
      shape.label(transform(pose, [0, 0, 0]), `table ${index}`, text);
    });
  },

  "robot_vision/RecognizedObjectArray"(message, shape) {
    for (const object of message.objects) {
      const pose = matrixOf(object.pose.pose.pose);
      if (!pose) continue;
      const text = colorOf(object.type.key);
      const corners = object.bounding_contours.map(({ x, y, z }) => [x, y, z]);
      const limit = (pick) =>
        [0, 1, 2].map((axis) => pick(...corners.map((corner) => corner[axis])));
      if (corners.length) shape.box(pose, limit(Math.min), limit(Math.max), rgb(text));
      shape.axes(pose, 0.08);
      shape.label(
        transform(pose, [0, 0, 0]),
        `${object.type.key.slice(0, 6)} ${Math.round(100 * object.confidence)} %`,
        text,
      );
    }
  },

  "sensor_msgs/CameraInfo"(message, shape, topic) {
    const [fx, , cx, , fy, cy] = message.K;
    const color = [150, 165, 185];
    if (!(fx > 0 && fy > 0)) return shape.axes(IDENTITY, FRUSTUM / 2);
    const corner = (u, v) => [((u - cx) / fx) * FRUSTUM, ((v - cy) / fy) * FRUSTUM, FRUSTUM];
    const [w, h] = [message.width, message.height];
    const corners = [corner(0, 0), corner(w, 0), corner(w, h), corner(0, h)];
    shape.outline(corners, color);
    for (const one of corners) shape.line([0, 0, 0], one, color);
    shape.image = {
      corners: [corners[0], corners[1], corners[3], corners[2]],
      beside: topic.slice(0, topic.lastIndexOf("/") + 1),
    };
    return undefined;
  },

  "geometry_msgs/PoseStamped"(message, shape) {
    const pose = matrixOf(message.pose);
    if (pose) shape.axes(pose, 0.2);
  },

  "geometry_msgs/PoseWithCovarianceStamped"(message, shape) {
    const pose = matrixOf(message.pose.pose);
    if (!pose) return;
    shape.axes(pose, 0.2);
    shape.ellipsoid(transform(pose, [0, 0, 0]), message.pose.covariance, [200, 200, 210]);
  },
};
MAKERS["object_recognition_msgs/TableArray"] = MAKERS["robot_vision/TableArray"];
MAKERS["object_recognition_msgs/RecognizedObjectArray"] =
  MAKERS["robot_vision/RecognizedObjectArray"];

/** What a topic of each type is called in the list; the order is that of the list. */
export const TYPES = {
  "robot_vision/TagDetectionArray": "Tags",
  "robot_vision/Detection3DArray": "Things",
  "robot_vision/TableArray": "Tables",
  "object_recognition_msgs/TableArray": "Tables",
  "robot_vision/RecognizedObjectArray": "Objects",
  "object_recognition_msgs/RecognizedObjectArray": "Objects",
  "sensor_msgs/PointCloud2": "Points",
  "sensor_msgs/CameraInfo": "Cameras",
  "geometry_msgs/PoseStamped": "Poses",
  "geometry_msgs/PoseWithCovarianceStamped": "Poses",
};

/**
 * @param {string} type
 * @param {any} message
 * @param {string} topic
 * @returns {Shape}
 */
export function shapeOf(type, message, topic) {
  const shape = new Shape(message.header?.frame_id || "");
  MAKERS[type](message, shape, topic);
  return shape;
}
