"""The node lane_detector, which finds the lane of a road, and where the robot is in it."""

import math
from typing import Any, Dict, Sequence, Tuple

from .. import GroundParams, Lane, LaneLine, LaneParams, draw_lane, draw_text
from .. import LaneDetector as Detector
from ..msg import LaneBoundary, LaneState
from ..ros.camera_info import NOT_CALIBRATED, CameraInfoListener
from ..ros.configs import LaneDetectorConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import points
from ..ros.startup import run_node
from ..ros.transport import KEPT, Frame, FrameError

STRAIGHT = 0.01  # a lane whose width is this share of its radius


class LaneDetector:
    """Publishes ~lanes, ~birds_eye and ~mask (the floor from above), and ~processed_image.

    Subscribes to image and, unless ~ground is points, to camera_info beside it, or where that name
    is remapped to.
    """

    def __init__(self) -> None:
        self._used: Tuple[Any, ...] = ()
        self._params = LiveParams(LaneDetectorConfig, self._configure)
        self._node = ImageNode(self._process)
        self._calibration = CameraInfoListener(self._node, "lanes")
        self._lanes = self._node.publisher("~lanes", LaneState)
        self._birds_eye = self._node.image_publisher("~birds_eye")
        self._mask = self._node.image_publisher("~mask")
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        used = filled(GroundParams(), config), filled(LaneParams(), config)
        if used != self._used:  # A new detector has to look for the lane anew.
            self._tools = Detector(*used), config["ground"]  # replaced in one step
            self._used = used

    def _process(self, frame: Frame) -> Any:
        detector, ground = self._tools
        camera = None
        if ground == "camera":
            camera = self._calibration.camera(frame.image.shape[1::-1])
            if camera is None:
                self._publish_overlay(frame, Lane(), (NOT_CALIBRATED,))
                self._calibration.refuse()
                return KEPT
        try:
            lane = detector.update(frame.time, frame.image, "bgr8", camera)
        except ValueError as error:
            raise FrameError(error) from None
        if self._lanes.get_num_connections():
            self._lanes.publish(lane_state(frame, lane))
        self._mask.publish(lane.mask, "mono8", frame.header)
        if self._birds_eye.get_num_connections():
            view = lane.view.copy()
            draw_lane(view, lane.left.from_above, lane.right.from_above)
            self._birds_eye.publish(view, "bgr8", frame.header)
        self._publish_overlay(frame, lane, summary(lane))
        return None

    def _publish_overlay(self, frame: Frame, lane: Lane, text: Sequence[str]) -> None:
        if not self._processed.get_num_connections():
            return
        overlay = frame.image.copy()
        draw_lane(overlay, lane.left.in_image, lane.right.in_image)
        for number, line in enumerate(text, 1):
            draw_text(overlay, line, (10, 20 * number))
        self._processed.publish(overlay, "bgr8", frame.header)


def lane_state(frame: Frame, lane: Lane) -> LaneState:
    """Returns the lane of a frame as a message."""
    return LaneState(
        header=frame.header,
        found=lane.found,
        offset=lane.offset,
        heading=lane.heading,
        curvature=lane.curvature,
        width=lane.width,
        middle=points(lane.middle),
        left=_boundary(lane.left),
        right=_boundary(lane.right),
    )


def summary(lane: Lane) -> Tuple[str, ...]:
    """Returns what is known of a lane in lines of text."""
    if not lane.found:
        return ("no lane",)
    straight = abs(lane.curvature) * lane.width < STRAIGHT
    bend = "straight" if straight else f"radius {1.0 / lane.curvature:+.2f} m"
    return (
        f"offset {lane.offset:+.3f} m",
        f"heading {math.degrees(lane.heading):+.1f} degrees",
        bend,
    )


def _boundary(line: LaneLine) -> LaneBoundary:
    return LaneBoundary(line.found, line.confidence, points(line.points))


def main() -> None:
    run_node("lane_detector", LaneDetector)
