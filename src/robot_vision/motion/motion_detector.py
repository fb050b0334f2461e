"""The node motion_detector, which finds what moves in the view of a fixed camera."""

import math
import threading
import time
from typing import Any, Dict

import rospy
from std_srvs.srv import Trigger, TriggerResponse

from .. import Motion, MotionParams, draw_outline, draw_text
from .. import MotionDetector as Detector
from ..msg import DetectionArray, MotionState
from ..ros.configs import MotionDetectorConfig
from ..ros.context import current
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import corners, detection, detection_array
from ..ros.startup import run_node
from ..ros.transport import Frame

KEPT_METHOD = "first_frame"  # its background stays while nobody subscribes


class MotionDetector:
    """Publishes ~motion, ~state, ~mask (mono8) and ~processed_image (boxes, state and time).

    Subscribes to image. ~reset_background (std_srvs/Trigger) makes the next frame the background.
    """

    def __init__(self) -> None:
        self._moved = -math.inf  # s, the last motion
        self._shall_reset = False
        self._lock = threading.Lock()  # guards the detector
        self._detector = Detector()
        self._params = LiveParams(MotionDetectorConfig, self._configure)
        self._node = ImageNode(self._process, idle=self._on_idle)
        self._motion = self._node.publisher("~motion", DetectionArray)
        self._state = self._node.publisher("~state", MotionState)
        self._mask = self._node.image_publisher("~mask")
        self._processed = self._node.image_publisher("~processed_image")
        current().service("~reset_background", Trigger, self._on_reset)
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        with self._lock:
            self._detector.configure(filled(MotionParams(), config))  # The background stays.
        self._method = config["method"]
        self._hold = config["hold"]

    def _process(self, frame: Frame) -> None:
        now = frame.time
        with self._lock:
            if self._shall_reset:
                self._shall_reset = False
                self._detector.reset()
            motion = self._detector.update(now, frame.image)
        if motion.everywhere:
            rospy.logwarn_throttle(5.0, "the whole image changes: the light, or the camera moves")
        if motion.regions or now < self._moved:
            self._moved = now if motion.regions else -math.inf
        occupied = now - self._moved <= self._hold
        if self._motion.get_num_connections():
            found = (detection(region, "motion") for region in motion.regions)
            self._motion.publish(detection_array(frame, found))
        self._state.publish(MotionState(frame.header, occupied, motion.everywhere, motion.changed))
        self._mask.publish(motion.mask, "mono8", frame.header)
        if self._processed.get_num_connections():
            self._publish_overlay(frame, motion, occupied, now)

    def _publish_overlay(self, frame: Frame, motion: Motion, occupied: bool, now: float) -> None:
        overlay = frame.image.copy()
        for region in motion.regions:
            draw_outline(overlay, corners(region.box))
        state = "Occupied" if occupied else "Unoccupied"
        draw_text(overlay, "whole image changes" if motion.everywhere else state, (10, 20))
        when = time.strftime("%A %d %B %Y %H:%M:%S", time.localtime(now))
        draw_text(overlay, when, (10, overlay.shape[0] - 10))
        self._processed.publish(overlay, "bgr8", frame.header)

    def _on_idle(self) -> None:
        # The next frame may come much later, and what has changed until then is no motion.
        if self._method != KEPT_METHOD:
            self._shall_reset = True

    def _on_reset(self, _request: Any) -> TriggerResponse:
        self._shall_reset = True  # Only the thread of the images may use the detector.
        return TriggerResponse(True, "the next frame is the background")


def main() -> None:
    run_node("motion_detector", MotionDetector)
