/** What is drawn over an image, by the type of the message that says it. */

import {
  drawDetections,
  drawDetections2D,
  drawBoundingBoxes,
  drawDetections3D,
  drawIdentities,
  drawTracks,
} from "./overlay_detections.js";
import {
  drawContours,
  drawFlow,
  drawGroundTruth,
  drawKeypoints,
  drawLane,
  drawLine,
  drawMatches,
  drawMotion,
} from "./overlay_features.js";
import { drawHistogram } from "./overlay_histogram.js";
import { Pen } from "./overlay_pen.js";
import { drawTags } from "./overlay_tags.js";

/** @type {Object<string, (pen: Pen, message: any, all: {type: string, data: any}[]) => void>} */
const DRAWERS = {
  "robot_vision/DetectionArray": drawDetections,
  "robot_vision/Detection3DArray": drawDetections3D,
  "robot_vision/TagDetectionArray": drawTags,
  "robot_vision/TrackStateArray": drawTracks,
  "robot_vision/FaceIdentityArray": drawIdentities,
  "robot_vision/Line": drawLine,
  "robot_vision/LaneState": drawLane,
  "robot_vision/ContourArray": drawContours,
  "robot_vision/KeypointMatches": drawMatches,
  "robot_vision/Keypoints": drawKeypoints,
  "robot_vision/Flow": drawFlow,
  "robot_vision/MotionState": drawMotion,
  "robot_vision/Histogram": drawHistogram,
  "robot_vision/GroundTruth": drawGroundTruth,
  "robot_vision/BoundingBoxes": drawBoundingBoxes,
  "darknet_ros_msgs/BoundingBoxes": drawBoundingBoxes,
  "robot_vision/Detection2DArray": drawDetections2D,
  "vision_msgs/Detection2DArray": drawDetections2D,
};

/** Copies for other programs: they are drawn only where a node has nothing that says more. */
const COPIES = new Set([
  "robot_vision/BoundingBoxes",
  "darknet_ros_msgs/BoundingBoxes",
  "robot_vision/Detection2DArray",
  "vision_msgs/Detection2DArray",
]);

const DETECTIONS = "robot_vision/DetectionArray";
/** What a node has followed over time: the same things as in its detections, with numbers. */
const OBJECTS = "/objects";

const ERROR_COLOR = "#ff6b6b";

/** Types whose messages could not be drawn; that is told once. */
const broken = new Set();

/** @param {string} type of a message */
export function canDraw(type) {
  return type in DRAWERS;
}

/**
 * Those topics of a view that are drawn.
 * @param {string[]} topics
 * @param {(topic: string) => string} typeOf "" if the topic is not there
 * @returns {{topic: string, type: string}[]}
 */
export function chooseOverlays(topics, typeOf) {
  const known = topics
    .map((topic) => ({ topic, type: typeOf(topic) }))
    .filter(({ type }) => canDraw(type));
  const own = known.filter(({ type }) => !COPIES.has(type));
  if (!own.some(({ type }) => type === DETECTIONS)) return known;
  const objects = own.filter(({ topic, type }) => type === DETECTIONS && topic.endsWith(OBJECTS));
  const raw = objects.map(({ topic }) => topic.slice(0, -OBJECTS.length) + "/detections");
  return own.filter(({ topic }) => !raw.includes(topic));
}

/**
 * @param {CanvasRenderingContext2D} context its unit is a pixel of the image
 * @param {{type: string, data: any}[]} messages all of one image
 * @param {{scale: number, ratio: number, size: [number, number]}} view see Pen
 * @param {Iterable<string>} [errors] why others cannot be drawn
 */
export function drawOverlays(context, messages, view, errors = []) {
  const pen = new Pen(context, view);
  for (const text of errors) pen.corner(text, ERROR_COLOR);
  for (const { type, data } of messages) {
    try {
      DRAWERS[type](pen, data, messages);
    } catch (error) {
      if (!broken.has(type)) console.warn(type, error); // the message lacks what its type has
      broken.add(type);
    }
  }
  pen.finish();
}
