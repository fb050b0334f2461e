"""What a network found as messages of darknet_ros_msgs and of vision_msgs of ROS 1."""

import math

from geometry_msgs.msg import Pose2D

from ..msg import (
    BoundingBox,
    BoundingBox2D,
    BoundingBoxes,
    Detection,
    Detection2D,
    Detection2DArray,
    DetectionArray,
    ObjectCount,
    ObjectHypothesisWithPose,
)

MAX_COUNT = 127  # what the field of ObjectCount can hold


def bounding_boxes(detections: DetectionArray) -> BoundingBoxes:
    """Returns detections as darknet_ros publishes them, with the stamp and frame of the image."""
    boxes = [_bounding_box(one) for one in detections.detections]
    return BoundingBoxes(detections.header, detections.header, boxes)


def object_count(detections: DetectionArray) -> ObjectCount:
    """Returns how many there are."""
    return ObjectCount(detections.header, min(len(detections.detections), MAX_COUNT))


def detections_2d(detections: DetectionArray) -> Detection2DArray:
    """Returns detections as vision_msgs has them."""
    return Detection2DArray(
        detections.header, [_detection_2d(detections, one) for one in detections.detections]
    )


def _bounding_box(detection: Detection) -> BoundingBox:
    box = detection.box
    return BoundingBox(
        probability=detection.score,
        xmin=box.x_offset,
        ymin=box.y_offset,
        xmax=box.x_offset + box.width,
        ymax=box.y_offset + box.height,
        id=detection.class_id,
        Class=detection.label,
    )


def _detection_2d(detections: DetectionArray, detection: Detection) -> Detection2D:
    message = Detection2D(header=detections.header)
    message.results = [ObjectHypothesisWithPose(id=detection.class_id, score=detection.score)]
    box, center = detection.box, detection.center
    message.bbox = BoundingBox2D(Pose2D(center.x, center.y, 0.0), box.width, box.height)
    if len(detection.outline) == 4 and not detection.mask:
        message.bbox = _of_corners(detection)
    return message


def _of_corners(detection: Detection) -> BoundingBox2D:
    """The box of an outline of four corners, of which the first side is along its x axis."""
    first, second, third = detection.outline[:3]
    theta = math.atan2(second.y - first.y, second.x - first.x)
    if theta == 0.0:  # An upright outline has pixels, but a box the space between their corners.
        width, height = detection.box.width, detection.box.height
    else:
        width = math.hypot(second.x - first.x, second.y - first.y)
        height = math.hypot(third.x - second.x, third.y - second.y)
    center = detection.center
    return BoundingBox2D(Pose2D(center.x, center.y, theta), width, height)
