"""The node object_recognizer, which recognizes learned objects and tells where they are."""

import time
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
import rospy
from std_srvs.srv import Trigger, TriggerResponse
from visualization_msgs.msg import MarkerArray

from .. import CameraModel, draw_text
from ..common.plain_text import printable, to_ascii
from ..msg import DetectionArray, RecognizedObjectArray, TableArray
from ..ros.camera_info import NOT_CALIBRATED, CameraInfoListener
from ..ros.configs import ObjectRecognizerConfig
from ..ros.context import current
from ..ros.depth_input import DepthFrame, DepthInput
from ..ros.frame_calls import FrameCalls
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams
from ..ros.params import read_param, read_prefix
from ..ros.startup import run_node
from ..ros.transform_output import TransformOutput
from ..ros.transport import Frame, FrameError, note_connections
from .found import Found, Limits
from .looks import Looks
from .missing_depth import MissingDepth
from .object_info_service import ObjectInfoService
from .object_numbers import ObjectNumbers
from .object_source import ObjectSource
from .recognition_markers import ObjectMarkers
from .recognition_messages import clouds_of, detection_array, object_array, transforms
from .recognition_overlay import draw_objects
from .recognition_report import RecognitionReport
from .recognition_settings import read_methods, settings_of
from .recognize_action import RecognizeAction
from .recognizer import Recognizer
from .straight_images import StraightImages
from .tables_below import TablesBelow

WITHOUT_DEPTH = "nothing is recognized"
NEEDS_DEPTH = "what was learned of the objects needs depth, and the name 'depth' is not remapped"
NOTHING_ON_TABLES = "not found: nothing stands on a table"
WITHOUT_METHODS = "methods names none, so that nothing but tables is looked for"
ORK_NAMES = {  # of object_recognition_core, which are not private
    "~recognized_object_array": "recognized_object_array",
    "~tables": "table_array",
    "~recognize_objects": "recognize_objects",
    "~get_object_info": "get_object_info",
}


class Seen(NamedTuple):
    """What was recognized in a frame."""

    frame: Frame
    camera: CameraModel  # of its image
    depth: Optional[np.ndarray]  # of each pixel of the image without distortion
    straight: CameraModel  # of that image
    found: List[Found]
    taken: float  # s of the monotonic clock, of the frame


class ObjectRecognizer:
    """Publishes ~recognized_object_array, ~detections, ~tables, ~markers, /tf, ~processed_image.

    Subscribes to image, and to camera_info beside it, or where that name is remapped to. If the
    name depth is remapped to a registered depth image, objects are recognized by both, else by
    the image alone. The objects are those of ~database that were learned by ~methods. The action
    ~recognize_objects recognizes those in the next image, ~get_object_info tells what is known of
    an object, ~reload loads them anew, which is done by itself when the database has changed.
    """

    def __init__(self) -> None:
        names = _names(read_param("ork_names", False))
        self._prefix = read_prefix()
        self._report = RecognitionReport()
        self._markers_of, self._looks, self._straight_looks = ObjectMarkers(), Looks(), Looks()
        self._numbers = ObjectNumbers()
        self._straight: Optional[StraightImages] = None
        self._node = ImageNode(self._on_image, idle=self._on_idle)
        self._depth = DepthInput(self._node, self._process, WITHOUT_DEPTH)
        self._missing_depth = MissingDepth(self._node, self._depth, WITHOUT_DEPTH)
        self._tables_of = TablesBelow()
        self._calls = FrameCalls(self._node)
        self._params = LiveParams(ObjectRecognizerConfig, self._configure)
        self._source = ObjectSource(read_methods(), lambda: self._settings, self._report)
        self._calibration = CameraInfoListener(self._node, "objects")
        self._outputs(names)
        self._action = RecognizeAction(names("~recognize_objects"), self._calls)
        self._info = ObjectInfoService(names("~get_object_info"), self._source.path)
        current().service("~reload", Trigger, self._on_reload)
        self._node.start()

    def _outputs(self, names: Callable[[str], List[str]]) -> None:
        node = self._node
        self._arrays = [
            node.publisher(name, RecognizedObjectArray)
            for name in names("~recognized_object_array")
        ]
        self._tables = [node.publisher(name, TableArray) for name in names("~tables")]
        self._detections = node.publisher("~detections", DetectionArray)
        self._markers = node.publisher("~markers", MarkerArray)
        self._tf = TransformOutput(node, lambda: self._settings.publish_tf, listens=True)
        self._processed = node.image_publisher("~processed_image")

    def _configure(self, config: Dict[str, Any]) -> None:
        self._settings = settings_of(config)
        self._depth.set_slop(config["depth_slop"])
        self._depth.set_rectified(config["depth_rectified"])
        note_connections()  # because /tf may start or stop to count

    def _on_idle(self) -> None:
        self._depth.clear()
        self._missing_depth.end()
        self._tables_of.clear()
        self._numbers.clear()
        self._markers_of.end()
        self._report.end()

    def _on_reload(self, _request: Any) -> TriggerResponse:
        return TriggerResponse(*self._source.reload())

    def _on_image(self, frame: Frame) -> Any:
        return self._depth.offer(frame, frame)

    def _process(self, frame: Frame, depth: Optional[DepthFrame]) -> None:
        try:
            with self._calls.processing():
                self._recognize(frame, depth)
        finally:
            self._report.publish()

    def _recognize(self, frame: Frame, depth: Optional[DepthFrame]) -> None:
        taken = time.monotonic()
        settings = self._settings
        camera = self._calibration.camera(frame.image.shape[1::-1], settings.rectified)
        recognizer = self._source.recognizer()
        if camera is None:
            if not self._calibration.is_on_its_way:
                self._cannot(frame, self._calibration.problem, NOT_CALIBRATED)
            return
        if depth is None and self._depth.topic:
            lack = self._missing_depth.reason()
            if lack:
                self._report.set_frame_problem(lack)
            self._refuse(frame, self._report.problem or lack)
            return
        self._missing_depth.end()
        straight = self._straighten(camera, depth and depth.camera)
        bgr, depths = straight.apply(frame.image, depth and depth.image)
        on_tables = settings.on_tables and recognizer is not None and depths is not None
        try:
            mask = self._find_tables(depths, straight.camera, frame, on_tables)
        except FrameError as error:
            self._cannot(frame, str(error))
            return
        if recognizer is None:
            self._report.set_frame({}, 0)
            self._refuse(frame, self._report.problem or WITHOUT_METHODS)
            return
        if depths is None and recognizer.needs_depth:
            self._cannot(frame, NEEDS_DEPTH)
            return
        if on_tables and mask is None:
            return  # The transform that is missing may come before the next image.
        seen = bgr, depths, straight.camera, mask if on_tables else None
        found, told = _recognized(recognizer, seen, settings.limits)
        self._report.set_frame(told, len(found))
        self._publish(Seen(frame, camera, depths, straight.camera, found, taken))

    def _find_tables(
        self, depths: Optional[np.ndarray], camera: CameraModel, frame: Frame, needed: bool
    ) -> Optional[np.ndarray]:
        """Publishes the tables; returns a mask of what stands on them, if that can be known.

        Raises:
            FrameError: They are needed, and it cannot be known what is up.
        """
        if depths is None or not (needed or any(one.get_num_connections() for one in self._tables)):
            return None
        try:
            seen = self._tables_of.find(depths, camera, frame, self._settings)
        except FrameError as error:
            if needed:
                raise
            rospy.logwarn_throttle(10.0, f"no tables: {error}")
            return None
        if seen is None:
            return None
        tables, mask = seen
        for output in self._tables:
            output.publish(tables)
        return mask

    def _straighten(
        self, camera: CameraModel, depth_camera: Optional[CameraModel]
    ) -> StraightImages:
        if self._straight is None or self._straight.made_of != (camera, depth_camera):
            self._straight = StraightImages(camera, depth_camera)
        return self._straight

    def _shows(self) -> bool:
        return self._processed.get_num_connections() > 0

    def _publish(self, seen: Seen) -> None:
        header, errors = seen.frame.header, self._settings.params.errors

        def array_of(limits: Optional[Limits]) -> RecognizedObjectArray:
            found = [one for one in seen.found if limits is None or limits.holds(one.pose)]
            clouds = clouds_of(found, seen.depth, seen.straight, self._straight_looks, errors)
            return object_array(header, found, self._source.path, clouds)

        self._calls.offer(lambda: array_of, seen.taken)
        if any(output.get_num_connections() for output in self._arrays):
            array = array_of(None)
            for output in self._arrays:
                output.publish(array)
        self._publish_looks(seen, self._detections.get_num_connections() > 0, self._shows())
        self._markers_of.note_image()
        if self._markers.get_num_connections():
            self._markers.publish(self._markers_of.of(header, seen.found))
        if self._tf.is_wanted():
            numbers = self._numbers.of(seen.found)  # which also counts images without objects
            if seen.found:
                self._tf.publish(transforms(header, seen.found, numbers, self._prefix))

    def _publish_looks(self, seen: Seen, detects: bool, shows: bool) -> None:
        """Publishes ~detections and ~processed_image, for which the objects are drawn."""
        if not (detects or shows):
            return
        looks = [self._looks.of(one, seen.camera, shows) for one in seen.found]
        header, image = seen.frame.header, seen.frame.image
        if detects:
            self._detections.publish(detection_array(header, image.shape[1::-1], seen.found, looks))
        if shows:
            overlay = image.copy()
            draw_objects(overlay, seen.found, looks)
            self._processed.publish(overlay, "bgr8", header)

    def _cannot(self, frame: Frame, reason: str, shown: str = "") -> None:
        """Tells why nothing can be recognized in a frame."""
        self._report.set_frame_problem(reason)
        self._refuse(frame, reason, shown)

    def _refuse(self, frame: Frame, reason: str, shown: str = "") -> None:
        """Tells all who wait for a frame why nothing is recognized in it, if there is a reason."""
        if not reason:
            return
        if self._shows():
            overlay = frame.image.copy()
            draw_text(overlay, shown or to_ascii(printable(reason)), (10, 20))
            self._processed.publish(overlay, "bgr8", frame.header)
        self._calls.refuse(reason)


def _recognized(
    recognizer: Recognizer, seen: Tuple[Any, ...], limits: Optional[Limits]
) -> Tuple[List[Found], Dict[str, str]]:
    """Returns what was recognized: image, depths, camera and mask are seen."""
    mask = seen[-1]
    if mask is None or mask.any():
        return recognizer.recognize(*seen, limits)
    return [], dict.fromkeys(recognizer.titles, NOTHING_ON_TABLES)


def _names(with_ork: bool) -> Callable[[str], List[str]]:
    """Returns a function that gives the names under which something private is offered."""

    def names(private: str) -> List[str]:
        return [private, ORK_NAMES[private]] if with_ork else [private]

    return names


def main() -> None:
    run_node("object_recognizer", ObjectRecognizer)
