"""The node object_detector, which finds things by a neural network and follows them."""

import functools
import math
import threading
import time
from typing import Any, Callable, Dict, List, NoReturn, Sequence, Tuple

import numpy as np
import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from .. import BoxTrack, FoundObject, to_bgr
from ..msg import BoundingBoxes, DetectionArray
from ..recordings.image_pixels import pixels_of
from ..ros.configs import ObjectDetectorConfig
from ..ros.frame_calls import FrameCalls
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams
from ..ros.messages import detection_array
from ..ros.params import read_param
from ..ros.startup import run_node
from ..ros.transport import Frame, FrameError
from .check_for_objects import CheckForObjects
from .compatible_messages import bounding_boxes
from .detect_objects import DetectService
from .detection_messages import Seen, object_detection, seen_object, seen_track
from .detection_outputs import DARKNET, DetectionOutputs
from .detection_overlay import draw_seen
from .detection_settings import settings_of
from .detector import NetworkDetector
from .frame_follower import FrameFollower, Pace
from .network_report import NetworkReport, facts_of
from .network_settings import network_settings

MakeArray = Callable[[], DetectionArray]


class ObjectDetector:
    """Publishes ~objects, which are followed, ~detections of the network, and ~processed_image.

    Subscribes to image. ~detections_2d, ~bounding_boxes and ~found_object are ~detections in the
    messages of vision_msgs and darknet_ros. ~detect searches a file or the next frame, the action
    ~check_for_objects an image that comes with the goal. The network is that of ~model;
    /diagnostics tells what runs it, how long it takes, and what it has failed with.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards the network, which frames and calls share
        self._detector = opened()
        self._report = NetworkReport(facts_of(self._detector.network))
        self._follower = FrameFollower(self._look, self._tell, self._report.add_failure)
        self._pace = Pace()
        self._params = LiveParams(ObjectDetectorConfig, self._configure)
        self._node = ImageNode(self._process, idle=self._follower.clear)
        self._calls = FrameCalls(self._node)
        names = read_param("darknet_names", False)
        self._found = DetectionOutputs(self._node, names)
        self._objects = self._node.publisher("~objects", DetectionArray)
        overlays = ["~processed_image"] + ([DARKNET + "detection_image"] if names else [])
        self._overlays = [self._node.image_publisher(name) for name in overlays]
        self._service = DetectService(self._calls, self._search)
        actions = ["~check_for_objects"] + ([DARKNET + "check_for_objects"] if names else [])
        self._actions = [CheckForObjects(name, self._search_message) for name in actions]
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        settings = settings_of(config, self._detector.names)
        self._detector.configure(settings.detection)
        self._follower.configure(settings.tracker, settings.period, settings.tracker_score)
        self._pace.period = settings.period
        self._report.period = settings.period
        self._report.max_age = settings.tracker.max_age if settings.track else math.inf
        self._settings = settings
        if not settings.track:
            self._follower.clear()

    def _process(self, frame: Frame) -> None:
        try:
            self._require_region(frame)
            if self._settings.track:
                self._follower.offer(frame, self._calls.waiting)
            elif self._pace.is_due(frame.time, self._calls.waiting):
                self._look_at_once(frame)
        finally:
            self._report.publish()

    def _require_region(self, frame: Frame) -> None:
        try:
            self._settings.region(frame.image)
        except ValueError as error:
            self._calls.offer(functools.partial(_raise, error))
            raise FrameError(error) from None

    def _look_at_once(self, frame: Frame) -> None:
        try:
            found, array = self._looked(frame)
        except Exception as error:  # Of any kind, as the runtimes raise what they like.
            self._report.add_failure(error)
            raise FrameError(f"the network has failed: {error}") from None
        self._show(frame, self._seen(found), array)

    def _look(self, frame: Frame) -> List[FoundObject]:
        """Returns what the network finds in a frame, and publishes it."""
        return self._looked(frame)[0]

    def _looked(self, frame: Frame) -> Tuple[List[FoundObject], MakeArray]:
        """Looks at a frame; also returns a function that makes the message, at most once."""
        begin = time.monotonic()
        try:
            with self._report.running(), self._calls.processing():
                found = self._find(frame.image)
        except Exception as error:  # Of any kind, as the runtimes raise what they like.
            self._calls.offer(functools.partial(_raise, error), begin)
            raise
        self._report.add_run(time.monotonic() - begin)
        array = functools.lru_cache(None)(lambda: self._array(frame, found))
        self._calls.offer(array, begin)
        if self._found.wanted:
            self._found.publish(array())
        return found, array

    def _find(self, bgr: np.ndarray) -> List[FoundObject]:
        settings = self._settings
        with self._lock:
            found = self._detector.detect(bgr, settings.region(bgr))
        return [one for one in found if settings.thresholds.wants(one.class_id)]

    def _array(self, frame: Frame, found: Sequence[FoundObject]) -> DetectionArray:
        return _array_of(frame, self._seen(found))

    def _seen(self, found: Sequence[FoundObject]) -> List[Seen]:
        return [seen_object(one, self._detector.name_of(one)) for one in self._settings.sure(found)]

    def _tell(self, frame: Frame, tracks: List[BoxTrack], found: Sequence[FoundObject]) -> None:
        settings = self._settings
        seen = [
            seen_track(one, found, self._detector.name_of(one), settings.score_of_track(one))
            for one in settings.reported(tracks)
        ]
        self._show(frame, seen, lambda: _array_of(frame, seen))

    def _show(self, frame: Frame, seen: List[Seen], array: MakeArray) -> None:
        if self._objects.get_num_connections():
            self._objects.publish(array())
        watched = [overlay for overlay in self._overlays if overlay.get_num_connections()]
        if watched:
            drawn = frame.image.copy()
            draw_seen(drawn, seen)
            for overlay in watched:
                overlay.publish(drawn, "bgr8", frame.header)

    def _search(self, bgr: np.ndarray, header: Header) -> DetectionArray:
        return self._array(Frame(bgr, "bgr8", header), self._find(bgr))

    def _search_message(self, image: Image) -> BoundingBoxes:
        bgr = to_bgr(pixels_of(image), image.encoding)
        return bounding_boxes(self._search(bgr, image.header))


def opened() -> NetworkDetector:
    """Returns the network that the parameters name; says in the log what it is.

    Raises:
        ValueError: A parameter or a file cannot be used.
    """
    try:
        detector = NetworkDetector(network_settings())
    except OSError as error:
        raise ValueError(str(error)) from None
    rospy.loginfo("%s", detector.network)
    for line in (*detector.network.model.warnings, detector.network.advice):
        if line:
            rospy.loginfo("%s", line)
    return detector


def _raise(error: Exception) -> NoReturn:
    """Answers a call that waits for a frame which cannot be searched."""
    raise error


def _array_of(frame: Frame, seen: Sequence[Seen]) -> DetectionArray:
    size = frame.image.shape[1::-1]
    return detection_array(frame, [object_detection(one, size) for one in seen])


def main() -> None:
    run_node("object_detector", ObjectDetector)
