"""The node hough, which finds lines, segments or circles."""

from typing import Any, Dict

import numpy as np
import rospy
from geometry_msgs.msg import Point

from .. import (
    HoughCircle,
    HoughLine,
    HoughParams,
    HoughResult,
    HoughTransform,
    draw_ball,
    draw_outline,
    draw_text,
)
from ..common.drawing import CIRCLE
from ..msg import Detection, DetectionArray
from ..ros.configs import HoughConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import box_around, detection_array, points
from ..ros.startup import run_node
from ..ros.transport import Frame, FrameError

LABELS = {"lines": "line", "segments": "segment"}  # of the methods that find something straight


class Hough:
    """Publishes ~objects, ~edges (mono8, those that vote) and ~processed_image (what was found).

    Subscribes to image.
    """

    def __init__(self) -> None:
        self._params = LiveParams(HoughConfig, self._configure)
        self._node = ImageNode(self._process)
        self._objects = self._node.publisher("~objects", DetectionArray)
        self._edges = self._node.image_publisher("~edges")
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        transform = HoughTransform(filled(HoughParams(), config))
        # Replaced in one step, because another thread may be processing a frame.
        self._tools = transform, LABELS.get(config["method"], "")

    def _process(self, frame: Frame) -> None:
        transform, label = self._tools
        with_edges = self._edges.get_num_connections() > 0
        try:
            result = transform.apply(frame.image, "bgr8", with_edges)
        except ValueError as error:  # The steps may be too fine for the image or its edges.
            raise FrameError(error) from None
        if result.too_many_edges:
            rospy.logwarn_throttle(
                5.0,
                "no circles are looked for in so many edges: raise canny_high or blur_size, "
                "or min_distance with gradient_alt",
            )
        if self._objects.get_num_connections():
            found = [line_detection(line, label, frame.image) for line in result.lines]
            found += [circle_detection(circle, frame.image) for circle in result.circles]
            self._objects.publish(detection_array(frame, found))
        if with_edges:
            self._edges.publish(result.edges, "mono8", frame.header)
        if self._processed.get_num_connections():
            overlay = frame.image.copy()
            draw_found(overlay, result)
            self._processed.publish(overlay, "bgr8", frame.header)


def line_detection(line: HoughLine, label: str, image: np.ndarray) -> Detection:
    """Returns a line or a segment as a Detection, whose outline has its two ends."""
    ends = np.array([line.begin, line.end])
    return Detection(
        label=label,
        id=-1,
        score=line.score,
        box=box_around(ends, image),
        center=Point(*ends.mean(axis=0), 0.0),
        outline=points(ends),
    )


def circle_detection(circle: HoughCircle, image: np.ndarray) -> Detection:
    """Returns a circle as a Detection, whose box is clipped to the image."""
    outline = circle.center + circle.radius * CIRCLE
    center = Point(*circle.center, 0.0)
    return Detection(
        label="circle",
        id=-1,
        score=circle.score,
        box=box_around(outline, image),
        center=center,
        outline=points(outline),
        circle_center=center,
        circle_radius=circle.radius,
        area=np.pi * circle.radius**2,
    )


def draw_found(overlay: np.ndarray, result: HoughResult) -> None:
    """Draws lines, segments and circles."""
    for line in result.lines:
        draw_outline(overlay, np.rint([line.begin, line.end]).astype(int))
    for circle in result.circles:
        draw_ball(overlay, circle.center, circle.radius)
    if result.too_many_edges:
        draw_text(overlay, "too many edges", (10, 20))


def main() -> None:
    run_node("hough", Hough)
