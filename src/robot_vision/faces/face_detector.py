"""The node face_detector, which finds faces by OpenCV's cascades and follows them."""

import re
import threading
from typing import Any, Dict, List, Optional, Tuple

import rospy
from geometry_msgs.msg import Vector3

from .. import Face, FaceParams, draw_outline
from .. import FaceDetector as Detector
from ..msg import Detection, DetectionArray
from ..ros.configs import FaceDetectorConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, attribute_of, filled
from ..ros.messages import Box, box_detection, corners, detection_array
from ..ros.startup import run_node
from ..ros.transport import Frame

COURSE = "haar_"  # what the course writes in front of the names of some parameters
SEEN, PREDICTED, EYE = (0, 255, 0), (0, 200, 255), (255, 200, 0)  # BGR, colours of the boxes


class FaceDetector:
    """Publishes ~faces, ~eyes and ~processed_image (boxes with id and score).

    Subscribes to image.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards the detector
        self._detector: Optional[Detector] = None
        self._params = LiveParams(FaceDetectorConfig, self._configure)
        self._node = ImageNode(self._process)
        self._faces = self._node.publisher("~faces", DetectionArray)
        self._eyes = self._node.publisher("~eyes", DetectionArray)
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        params = filled(FaceParams(), config, COURSE)
        try:
            with self._lock:
                if self._detector:
                    self._detector.configure(params)  # The faces keep their ids.
                else:
                    self._detector = Detector(params)
        except ValueError as error:
            raise ValueError(with_course_names(str(error))) from None
        self._period = config["max_search_period"]

    def _process(self, frame: Frame) -> None:
        drawn = self._processed.get_num_connections() > 0
        with_eyes = drawn or self._eyes.get_num_connections() > 0
        time = frame.time
        with self._lock:
            faces = self._detector.update(time, frame.image)
            looked_at = faces if with_eyes else []
            eyes = [(face, box) for face in looked_at for box in self._detector.find_eyes(face)]
            slowness = slowness_text(self._detector.search_time, self._period)
        if slowness:
            rospy.logwarn_throttle(60.0, slowness)
        found = (face_detection(face) for face in faces)
        self._faces.publish(detection_array(frame, found))
        found = (box_detection(box, "eye", face.id) for face, box in eyes)
        self._eyes.publish(detection_array(frame, found))
        if drawn:
            self._publish_overlay(frame, faces, eyes)

    def _publish_overlay(
        self, frame: Frame, faces: List[Face], eyes: List[Tuple[Face, Box]]
    ) -> None:
        overlay = frame.image.copy()
        for face in faces:
            label = f"{face.id}: {face.score:.2f}"
            color = PREDICTED if face.predicted else SEEN
            draw_outline(overlay, corners(face.box), label, color)
        for _, box in eyes:
            draw_outline(overlay, corners(box), color=EYE)
        self._processed.publish(overlay, "bgr8", frame.header)


def slowness_text(search_time: float, period: float) -> str:
    """Returns why new faces are found later than `max_search_period` says, or an empty text.

    Args:
        search_time: s, that a search of the whole image takes.
        period: s, within which a new face is to be found; 0: one search follows the other.
    """
    longest = 2.0 * search_time  # A face may appear just after a search has begun.
    if not longest > period > 0.0:
        return ""
    return (
        f"a new face may be found after {longest:.2f} s only, max_search_period is {period:g} s: "
        "a larger haar_minSize or haar_scaleFactor makes the search faster"
    )


def with_course_names(text: str) -> str:
    """Replaces the names of the core's parameters in an error by those of the live ones."""
    for name in FaceDetectorConfig.defaults:
        text = re.sub(rf"\b{attribute_of(name, COURSE)}\b", name, text)
    return text


def face_detection(face: Face) -> Detection:
    """Returns a face as a Detection."""
    message = box_detection(face.box, "face", face.id, face.score)
    message.has_velocity = True
    message.velocity = Vector3(*face.velocity, 0.0)
    message.predicted = face.predicted
    return message


def main() -> None:
    run_node("face_detector", FaceDetector)
