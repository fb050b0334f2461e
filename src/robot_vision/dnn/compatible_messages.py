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
    message.bbox = _box_of(detection)
    return message


def _box_of(detection: Detection) -> BoundingBox2D:
    """The upright box; or, of a turned one, that of its corners, whose first side is its x axis."""
    theta, width, height = 0.0, float(detection.box.width), float(detection.box.height)
    if len(detection.outline) == 4 and not detection.mask:
        first, second, third = detection.outline[:3]
        theta = math.atan2(second.y - first.y, second.x - first.x)
        if theta != 0.0:  # An upright outline is of pixels, and narrower than their box.
            width = math.hypot(second.x - first.x, second.y - first.y)
            height = math.hypot(third.x - second.x, third.y - second.y)
    return BoundingBox2D(Pose2D(detection.center.x, detection.center.y, theta), width, height)
