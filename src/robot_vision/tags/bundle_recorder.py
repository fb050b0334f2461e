"""Records the tags that a running detector publishes, for calibrate_bundle.py."""

import threading
from typing import Any, List, Optional, Tuple

import numpy as np
import rosgraph
import rospy
from sensor_msgs.msg import CameraInfo

from .. import CameraModel
from ..common.progress import Progress
from ..msg import TagDetectionArray
from ..ros.camera_info import camera_model, window_of
from ..ros.transport import remapped_camera_info
from .frame_collection import FrameCollection

PROGRESS = 1.0  # s between lines of progress


class BundleRecorder:
    """Offers the messages on the topic `tags` to a collection.

    The camera_info is expected on the topic camera_info if that name is remapped, and otherwise
    where the node that publishes the tags subscribes to it, unless that node has several, as of a
    depth camera, or of other nodes in its process. Frames of another size than the
    camera_info's are left out. So are frames after a change of the camera_info, because another
    lens would have taken them.
    """

    def __init__(self, family: str, collection: FrameCollection, progress: Progress):
        self._family = family
        self._collection = collection
        self._progress = progress
        self._lock = threading.Lock()  # guards the collection, as tags come in another thread
        self._ended = threading.Event()
        self._info: Optional[CameraInfo] = None
        self._camera: Optional[CameraModel] = None
        self._used: Tuple[Any, ...] = ()  # the values that the camera was made from
        self._arrived = False
        self._topic = rospy.resolve_name("tags")
        self._info_topic = ""
        self._candidates: List[str] = []  # to which the detector subscribes
        tags = rospy.Subscriber(self._topic, TagDetectionArray, self._on_tags, queue_size=10)
        self._subscribers = [tags]

    def run(self) -> CameraModel:
        """Collects until there are enough frames or on Ctrl-C, and returns the camera.

        Raises:
            ValueError: Nothing came, or there is no calibration that can be used.
        """
        try:
            while not self._ended.wait(PROGRESS) and not rospy.is_shutdown():
                if not self._info_topic:
                    self._subscribe_to_camera_info()
                self._progress.tell(self._state())
        except KeyboardInterrupt:
            print(flush=True)  # ends the line in which the terminal shows ^C
        with self._lock:
            self._ended.set()  # Frames that are still being processed come too late.
            error = "" if self._camera else self._missing_input()
        for subscriber in self._subscribers:
            subscriber.unregister()
        if error:
            raise ValueError(error)
        return self._camera

    def _subscribe_to_camera_info(self) -> None:
        self._info_topic = remapped_camera_info()
        if not self._info_topic and self._arrived:  # Before, the detector may still subscribe.
            self._candidates = self._camera_infos_of_publisher()
            if len(self._candidates) == 1:
                self._info_topic = self._candidates[0]
        if self._info_topic:
            self._subscribers.append(
                rospy.Subscriber(self._info_topic, CameraInfo, self._on_info, queue_size=1)
            )

    def _camera_infos_of_publisher(self) -> List[str]:
        """Returns the topics of camera_info to which the detector subscribes now."""
        master = rosgraph.Master(rospy.get_name())
        try:
            publishers, subscribers, _ = master.getSystemState()
            kinds = dict(master.getTopicTypes())
        except (OSError, rosgraph.MasterException):  # This is called again in a moment.
            return []
        nodes = {node for topic, nodes in publishers if topic == self._topic for node in nodes}
        return sorted(
            topic
            for topic, listeners in subscribers
            if kinds.get(topic) == CameraInfo._type and nodes.intersection(listeners)
        )

    def _on_info(self, info: CameraInfo) -> None:
        self._info = info

    def _on_tags(self, message: TagDetectionArray) -> None:
        with self._lock:
            self._arrived = True
            if self._info is None or self._ended.is_set():
                return
            try:
                self._require_camera(self._info, (message.width, message.height))
            except ValueError as error:
                self._collection.skip(f"camera_info on {self._info_topic}: {error}")
                return
            self._collection.add(
                self._camera,
                [
                    (tag.id, np.array([(corner.x, corner.y) for corner in tag.corners]))
                    for tag in message.detections
                    if tag.family == self._family
                ],
            )
            if self._collection.full:
                self._ended.set()

    def _require_camera(self, info: CameraInfo, size: Tuple[int, int]) -> None:
        """Raises ValueError if the camera_info does not fit; the first one makes the camera."""
        used = (size, *window_of(info), info.K, info.D, info.distortion_model)
        if self._camera is None or used != self._used:
            camera = camera_model(info, size)
            if self._camera is not None:
                raise ValueError("it is not that of the first frames")
            self._camera, self._used = camera, used

    def _state(self) -> str:
        with self._lock:
            if self._camera:
                return self._collection.summary()
            return "waiting: " + self._missing_input()

    def _missing_input(self) -> str:
        if not self._arrived:
            nobody = (
                ""
                if self._subscribers[0].get_num_connections()
                else "; nobody publishes there: see tags:= in --help"
            )
            return f"no tags came on {self._topic}{nobody}"
        if not self._info_topic:
            known = "one of " + ", ".join(self._candidates) if self._candidates else "not known"
            return f"the topic of the calibration is {known}: say camera_info:=/usb_cam/camera_info"
        return self._collection.problem or f"no camera_info came on {self._info_topic}"
