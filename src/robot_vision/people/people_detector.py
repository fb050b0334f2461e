"""The node people_detector, which finds people by OpenCV's histograms of oriented gradients."""

from typing import Any, Dict, List

from .. import PeopleDetector as Detector
from .. import PeopleParams, Person, draw_outline
from ..msg import DetectionArray
from ..ros.configs import PeopleDetectorConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import box_detection, corners, detection_array
from ..ros.startup import run_node
from ..ros.transport import Frame, FrameError


class PeopleDetector:
    """Publishes ~people and ~processed_image (boxes with the score).

    Subscribes to image.
    """

    def __init__(self) -> None:
        self._params = LiveParams(PeopleDetectorConfig, self._configure)
        self._node = ImageNode(self._process)
        self._people = self._node.publisher("~people", DetectionArray)
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        self._detector = Detector(filled(PeopleParams(), config))

    def _process(self, frame: Frame) -> None:
        try:
            people = self._detector.detect(frame.image)
        except ValueError as error:  # The search would take too long in such a large image.
            raise FrameError(error) from None
        if self._people.get_num_connections():
            found = (box_detection(one.box, "person", score=one.score) for one in people)
            self._people.publish(detection_array(frame, found))
        if self._processed.get_num_connections():
            self._publish_overlay(frame, people)

    def _publish_overlay(self, frame: Frame, people: List[Person]) -> None:
        overlay = frame.image.copy()
        for person in people:
            draw_outline(overlay, corners(person.box), f"{person.score:.2f}")
        self._processed.publish(overlay, "bgr8", frame.header)


def main() -> None:
    run_node("people_detector", PeopleDetector)
