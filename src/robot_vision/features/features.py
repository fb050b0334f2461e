"""The node features, which finds keypoints, and matches them with a reference or the last frame."""

from typing import Any, Dict, Optional

import rospy

from .. import KeypointMatcher, KeypointParams, MatchedFrame, MatchParams
from ..common.image_files import name_of
from ..msg import DetectionArray, KeypointMatches, Keypoints
from ..ros.configs import FeaturesConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import detection_array
from ..ros.startup import run_node
from ..ros.transport import Frame
from .feature_messages import keypoints_message, matches_message, reference_detection
from .feature_overlay import draw_keypoints, draw_motion, draw_reference
from .reference_file import ReferenceFile


class Work:
    """What the present parameters make of frames."""

    def __init__(self, config: Dict[str, Any], file: ReferenceFile):
        self.detector, self.match = config["detector"], config["match"]
        keypoints = filled(KeypointParams(), config)
        self.matcher = KeypointMatcher(keypoints, filled(MatchParams(), config))
        self.label = ""
        if self.match == "reference":
            self.matcher.set_reference(file.image(config["reference"]))
            self.label = name_of(config["reference"])
        self._last: Optional[rospy.Time] = None  # stamp of the last frame that was matched

    def forget_if_later(self, stamp: rospy.Time) -> None:
        """Forgets the last frame if it is later than this stamp: a bag has begun anew."""
        if self._last and stamp < self._last:
            self.forget()

    def stamp_of_reference(self, frame: Frame) -> rospy.Time:
        """Returns the stamp of the frame that this one is matched with, if it is not a file."""
        last, self._last = self._last, frame.header.stamp
        return last if last and self.match == "last_frame" else rospy.Time()

    def forget(self) -> None:
        """Forgets the last frame."""
        self.matcher.reset()
        self._last = None


class Features:
    """Publishes ~keypoints, ~matches, ~objects (the reference) and ~processed_image.

    Subscribes to image.
    """

    def __init__(self) -> None:
        self._file = ReferenceFile()
        self._params = LiveParams(FeaturesConfig, self._configure)
        self._node = ImageNode(self._process, idle=lambda: self._work.forget())
        self._keypoints = self._node.publisher("~keypoints", Keypoints)
        self._matches = self._node.publisher("~matches", KeypointMatches)
        self._objects = self._node.publisher("~objects", DetectionArray)
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        self._work = Work(config, self._file)  # in one step: another thread may process a frame

    def _process(self, frame: Frame) -> None:
        work = self._work
        outputs = (self._matches, self._objects, self._processed)
        matches = any(output.get_num_connections() for output in outputs)
        work.forget_if_later(frame.header.stamp)
        found = work.matcher.update(frame.image, matches=matches)
        if self._keypoints.get_num_connections():
            self._keypoints.publish(keypoints_message(frame, work.detector, found.keypoints))
        if matches:
            self._publish_matches(frame, work, found)
        else:
            work.forget()  # The next frame is not matched with one long ago.
        if self._processed.get_num_connections():
            self._publish_overlay(frame, work, found)

    def _publish_matches(self, frame: Frame, work: Work, found: MatchedFrame) -> None:
        stamp = work.stamp_of_reference(frame)
        if self._matches.get_num_connections():
            self._matches.publish(matches_message(frame, work.label, stamp, found.matches))
        if self._objects.get_num_connections():
            is_there = work.match == "reference" and found.matches.pose
            there = [reference_detection(frame, work.label, found.matches)] if is_there else []
            self._objects.publish(detection_array(frame, there))

    def _publish_overlay(self, frame: Frame, work: Work, found: MatchedFrame) -> None:
        overlay = frame.image.copy()
        if work.match == "reference":
            draw_reference(overlay, found.matches, work.label)
        elif work.match == "last_frame":
            draw_motion(overlay, found.matches)
        else:
            draw_keypoints(overlay, found.keypoints)
        self._processed.publish(overlay, "bgr8", frame.header)


def main() -> None:
    run_node("features", Features)
