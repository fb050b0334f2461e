"""The node detections_3d, which tells where things are that another node finds in images."""

import threading
from typing import Any, Dict, Optional

import rospy
from std_msgs.msg import Header
from visualization_msgs.msg import MarkerArray

from .. import CameraModel, DepthErrorParams, LocatorParams, RegionLocator, validate
from ..common.plain_text import printable
from ..common.throttle import Throttle
from ..msg import Detection, Detection3DArray, DetectionArray
from ..ros.camera_info import CameraInfoListener
from ..ros.configs import Detections3dConfig
from ..ros.context import current
from ..ros.depth_frames import DepthLook
from ..ros.frame_pairs import FramePairs
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.params import read_prefix
from ..ros.startup import run_node
from ..ros.transform_output import TransformOutput
from ..ros.transport import KEPT, Frame, ReportedFrameError, note_connections
from .depth_overlay import depth_colors, draw_places
from .detection_places import detection_3d, located, misfit
from .places import frame_ids, markers, transforms


class Detections3d:
    """Publishes ~detections, /tf, ~markers and ~processed_image (the depth with the boxes).

    Subscribes to detections, to depth, which is registered to the camera of the detections, and to
    camera_info beside the depth, or where that name is remapped to.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards all below: parameters come in another thread
        self._prefix = read_prefix()
        self._camera: Optional[CameraModel] = None  # that of the locator
        self._left_out = 0  # detections since the start
        self._unfit, self._apart, self._lacking = (Throttle() for _ in range(3))
        self._pairs = FramePairs()
        self._node = ImageNode(self._on_depth, encoding="", idle=self._pairs.clear, name="depth")
        self._look = DepthLook(self._node.topic)
        self._params = LiveParams(Detections3dConfig, self._configure)
        self._calibration = CameraInfoListener(self._node, "places of detections")
        self._node.subscriber("detections", DetectionArray, self._on_detections)
        self._found = self._node.publisher("~detections", Detection3DArray)
        self._markers = self._node.publisher("~markers", MarkerArray)
        self._tf = TransformOutput(self._node, lambda: self._publish_tf, self._topics())
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        params = filled(LocatorParams(), config), filled(DepthErrorParams(), config)
        for one in params:
            validate(one)
        with self._lock:
            self._values = params
            self._camera = None  # The locator is made anew.
            self._rectified = config["rectified"]
            self._predicted = config["predicted"]
            self._publish_tf = config["publish_tf"]
            self._pairs.slop = config["slop"]
        note_connections()  # because /tf may start or stop to count

    def _on_depth(self, depth: Frame) -> Any:
        self._look.check(depth)
        lack = self._report_missing("detections")
        detections = self._pairs.message_of(depth)
        if not lack and self._pairs.apart():
            lack = self._apart_text()
        self._node.set_lack(lack)
        return self._process(depth, detections) if detections else KEPT

    def _on_detections(self, detections: DetectionArray) -> None:
        depth = self._pairs.frame_of(detections)
        if depth:
            self._node.go_on(depth, lambda: self._process(depth, detections))
        elif not self._report_missing("depth") and self._pairs.apart() and self._apart.due():
            rospy.logwarn("no places of detections: %s", self._apart_text())

    def _apart_text(self) -> str:
        late = self._pairs.late_text(current().resolve("detections"), self._node.topic)
        return late or (
            f"the stamps on {self._topics()} do not meet: the nearest are "
            f"{self._pairs.distance():.3g} s apart, must be at most slop, {self._pairs.slop:g} s"
        )

    def _report_missing(self, name: str) -> str:
        missing = self._node.missing(only=name)
        if missing:
            rospy.logwarn_throttle(10.0, f"no places of detections: {missing}")
        return missing

    def _process(self, depth: Frame, detections: DetectionArray) -> Any:
        with self._lock:
            self._require_fit(depth, detections)
            camera = self._camera_of(depth)
            if camera is None:
                self._calibration.refuse()
                return KEPT
            if camera is not self._camera:
                self._camera, self._locator = camera, RegionLocator(camera, *self._values)
            self._publish(depth, self._located(depth, detections))
        return None

    def _require_fit(self, depth: Frame, detections: DetectionArray) -> None:
        problem = misfit(detections, depth, self._calibration.frame_id)
        if not problem:
            return
        text = (
            f"{self._topics()} do not fit: {problem}: the depth has to be registered to the camera "
            "of the detections"
        )
        if self._unfit.due():
            rospy.logerr("no places of detections: %s", text)
        raise ReportedFrameError(text)

    def _camera_of(self, depth: Frame) -> Optional[CameraModel]:
        return self._calibration.camera(depth.image.shape[1::-1], self._rectified)

    def _located(self, depth: Frame, detections: DetectionArray) -> Detection3DArray:
        header = detections.header
        frame_id = header.frame_id or depth.header.frame_id
        array = Detection3DArray(header=Header(header.seq, header.stamp, frame_id))
        seen = [one for one in detections.detections if self._predicted or not one.predicted]
        for one, name in zip(seen, frame_ids(seen, self._prefix)):
            try:
                found, reason = located(self._locator, depth.image, one), "too few depths there"
            except ValueError as error:
                found, reason = None, printable(str(error), 300)
            if found is None:
                self._note_lack(one, reason)
            else:
                array.detections.append(detection_3d(one, found, name))
        array.left_out = len(seen) - len(array.detections)
        return array

    def _note_lack(self, detection: Detection, reason: str) -> None:
        self._left_out += 1
        if self._lacking.due():
            rospy.logwarn(
                "left out '%s' %d, %dx%d at (%d, %d), of %s: %s; %d since the start",
                printable(detection.label),
                detection.id,
                detection.box.width,
                detection.box.height,
                detection.box.x_offset,
                detection.box.y_offset,
                self._topics(),
                reason,
                self._left_out,
            )

    def _publish(self, depth: Frame, array: Detection3DArray) -> None:
        self._found.publish(array)
        if self._markers.get_num_connections():
            self._markers.publish(markers(array))
        if self._tf.is_wanted():
            self._tf.publish(transforms(array))
        if self._processed.get_num_connections():
            overlay = depth_colors(depth.image)
            draw_places(overlay, array.detections)
            self._processed.publish(overlay, "bgr8", array.header)

    def _topics(self) -> str:
        return f"{current().resolve('detections')} and {self._node.topic}"


def main() -> None:
    run_node("detections_3d", Detections3d)
