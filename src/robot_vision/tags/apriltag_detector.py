"""The node apriltag_detector, which finds AprilTags and their poses."""

import threading
import time
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
import rospy
from std_msgs.msg import Header
from visualization_msgs.msg import MarkerArray

from .. import CameraModel, DepthErrorParams, Tag, TagDetectorParams, TagPoseParams, to_bgr, to_gray
from .. import TagDetector as Detector
from ..msg import TagDetectionArray
from ..ros.camera_info import CameraInfoListener
from ..ros.configs import ApriltagDetectorConfig
from ..ros.context import current
from ..ros.depth_input import DepthFrame, DepthInput
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.params import read_any, read_param
from ..ros.startup import run_node
from ..ros.transform_output import TransformOutput
from ..ros.transport import Frame, FrameError, note_connections
from .depth_report import DepthReport
from .detect_service import DetectService
from .tag_depth import TagDepth
from .tag_layout import TagLayout
from .tag_messages import markers, tag_array, transforms
from .tag_overlay import draw_tags
from .tag_poses import LocatedBundle, LocatedTag, TagLocator

WITHOUT_DEPTH = "poses of tags are from the corners alone"


class Sighting(NamedTuple):
    """A frame and the tags that were found in it, which may wait for their depth.

    Attributes:
        taken: When the node took the frame, s of the monotonic clock.
    """

    taken: float
    frame: Frame
    gray: np.ndarray
    found: List[Tag]


class ApriltagDetector:
    """Publishes ~tags, /tf, ~markers and ~processed_image (outlines, ids, axes and distances).

    Subscribes to image, and to camera_info beside it, or where that name is remapped to. Poses need
    the camera_info of a calibrated camera, and an image that is not rectified. If the name depth is
    remapped to a registered depth image, poses are of both, and /diagnostics has how wrong it is.
    ~detect (robot_vision/DetectTags) searches a file, or the next frame.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards the tools
        self._layout = TagLayout(
            read_any("families", "tag36h11"),
            read_param("tag_size", 0.1),
            read_any("standalone_tags", []),
            read_any("tag_bundles", []),
        )
        self._detector = Detector()
        self._poses: Optional[Tuple[TagPoseParams, bool]] = None  # and whether corners are measured
        self._depth_errors = DepthErrorParams()
        self._node = ImageNode(self._search, encoding="", idle=lambda: self._depth.clear())
        self._depth = DepthInput(self._node, self._process, WITHOUT_DEPTH)
        self._depth_report = DepthReport(self._node, self._depth)
        self._params = LiveParams(ApriltagDetectorConfig, self._configure)
        self._calibration = CameraInfoListener(self._node, "poses of tags")
        self._tags = self._node.publisher("~tags", TagDetectionArray)
        self._markers = self._node.publisher("~markers", MarkerArray)
        self._tf = TransformOutput(self._node, lambda: self._publish_tf)
        self._processed = self._node.image_publisher("~processed_image")
        self._service = DetectService(self._node, self._calibration, self._detect)
        # A search of a large image takes longer than the time that a node has to end.
        current().on_end(self._detector.abandon_search)
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        params = filled(TagDetectorParams(), config)
        params.families = self._layout.families
        params.background = True
        with self._lock:
            self._detector.configure(params)
            self._detector_params = params
            poses = filled(TagPoseParams(), config), config["measure_corners"]
            if poses != self._poses:  # A new locator forgets all poses.
                self._poses = poses
                self._locator = TagLocator(self._layout, poses[0])
            self._publish_tf = config["publish_tf"]
        self._depth_errors = filled(DepthErrorParams(), config)
        self._depth.set_slop(config["depth_slop"])
        self._depth_report.max_error = config["max_depth_error"]
        note_connections()  # because /tf may start or stop to count

    def _search(self, frame: Frame) -> Any:
        taken = time.monotonic()
        try:
            with self._lock:
                gray = to_gray(frame.image, frame.encoding)
                found = self._detector.update(frame.time, gray, "mono8")
        except (TypeError, ValueError) as error:
            self._service.offer(taken, frame)  # which answers with the error
            raise FrameError(error) from None
        return self._depth.offer(frame, Sighting(taken, frame, gray, found))

    def _process(self, sighting: Sighting, depth: Optional[DepthFrame]) -> None:
        taken, frame, gray, found = sighting
        if depth is not None or not self._depth.may_begin():
            self._service.offer(taken, frame, depth)
        size = frame.image.shape[1::-1]
        camera = self._calibration.camera(size)
        with self._lock:
            tags, bundles = self._locator.locate(
                frame.time, found, camera, self._for_corners(gray), self._of_tags(depth, camera)
            )
        if camera is not None and depth is not None:
            self._depth_report.add(tags, camera, self._poses[0], self._depth_errors)
        lacks = camera is None and not self._calibration.is_on_its_way
        self._depth_report.publish(self._calibration.problem if lacks else "")
        self._publish(frame, camera, tags, bundles)

    def _publish(
        self,
        frame: Frame,
        camera: Optional[CameraModel],
        tags: List[LocatedTag],
        bundles: List[LocatedBundle],
    ) -> None:
        size = frame.image.shape[1::-1]
        if self._detector.lacks_threads:
            rospy.logwarn_once("no thread can be started: frames wait for searches of all of one")
        for twin in (tag.tag for tag in tags if not tag.unique):
            rospy.logwarn_throttle(
                10.0, f"tag {twin.id} of {twin.family} is there more than once: no transform of it"
            )
        if self._tags.get_num_connections():
            self._tags.publish(tag_array(frame.header, size, tags, bundles))
        if self._tf.is_wanted():
            self._tf.publish(transforms(frame.header, tags, bundles))
        if self._markers.get_num_connections():
            self._markers.publish(markers(frame.header, tags))
        if self._processed.get_num_connections():
            overlay = to_bgr(frame.image, frame.encoding)
            draw_tags(overlay, tags, camera)
            self._processed.publish(overlay, "bgr8", frame.header)

    def _for_corners(self, gray: np.ndarray) -> Optional[np.ndarray]:
        return gray if self._poses[1] else None

    def _of_tags(
        self, depth: Optional[DepthFrame], camera: Optional[CameraModel]
    ) -> Optional[TagDepth]:
        if depth is None or camera is None:
            return None
        own = depth.camera or camera
        if (own.width, own.height) != depth.image.shape[1::-1]:  # Images just got another size.
            return None
        return TagDepth(depth.image, own, self._depth_errors)

    def _detect(
        self, image: np.ndarray, encoding: str, header: Header, depth: Optional[DepthFrame]
    ) -> Tuple[TagDetectionArray, str]:
        """Returns the tags of a single image, and the reason if they have no poses."""
        size = image.shape[1::-1]
        camera, problem = None, ""
        try:
            camera = self._calibration.camera_at_once(size)
        except ValueError as error:
            problem = str(error)
        with self._lock:
            params, locator = self._detector_params, self._locator
        # A large image takes seconds, in which frames go on: this detector is of the call alone.
        gray = to_gray(image, encoding)
        found = Detector(params).detect(gray, "mono8")
        tags, bundles = locator.locate_at_once(
            found, camera, self._for_corners(gray), self._of_tags(depth, camera)
        )
        return tag_array(header, size, tags, bundles), problem


def main() -> None:
    run_node("apriltag_detector", ApriltagDetector)
