"""Tags as a running detector publishes them, for calibrate_bundle.py."""

import threading
from typing import Optional

import numpy as np
import rosgraph
import rospy
from sensor_msgs.msg import CameraInfo

from .. import CameraModel
from ..frame_collection import FrameCollection
from ..msg import TagDetectionArray
from ..progress import Progress
from ..transport import remapped_camera_info
from .calibration import camera_model

PROGRESS = 1.0  # s between lines


class BundleRecorder:
    """Offers what comes on the topic `tags` to a collection.

    The camera_info is on the topic camera_info if that is remapped, otherwise where the node that
    publishes the tags has it from.
    """

    def __init__(self, family: str, collection: FrameCollection, progress: Progress):
        self._family = family
        self._collection = collection
        self._progress = progress
        self._lock = threading.Lock()  # guards the collection: the tags come in another thread
        self._ended = threading.Event()
        self._info: Optional[CameraInfo] = None
        self._camera: Optional[CameraModel] = None
        self._error = ""
        self._came = False
        self._topic = rospy.resolve_name("tags")
        self._info_topic = ""
        tags = rospy.Subscriber(self._topic, TagDetectionArray, self._on_tags, queue_size=10)
        self._subscribers = [tags]

    def run(self) -> CameraModel:
        """Collects until there are frames enough or on Ctrl-C; the camera that they are from.

        Raises:
            ValueError: nothing came, or there is no calibration.
        """
        try:
            while not self._ended.wait(PROGRESS) and not rospy.is_shutdown():
                if not self._info_topic:
                    self._subscribe_to_camera_info()
                self._progress.tell(self._state())
        except KeyboardInterrupt:
            print(flush=True)  # after the terminal's ^C
        with self._lock:
            self._ended.set()  # what is still under way comes too late
            error = self._error or ("" if self._camera else self._lacking())
        for subscriber in self._subscribers:
            subscriber.unregister()
        if error:
            raise ValueError(error)
        return self._camera

    def _subscribe_to_camera_info(self) -> None:
        self._info_topic = remapped_camera_info() or self._camera_info_of_publisher()
        if self._info_topic:
            self._subscribers.append(
                rospy.Subscriber(self._info_topic, CameraInfo, self._on_info, queue_size=1)
            )

    def _camera_info_of_publisher(self) -> str:
        """The topic, empty if it is not known (yet): a detector may subscribe to it only now."""
        master = rosgraph.Master(rospy.get_name())
        try:
            publishers, subscribers, _ = master.getSystemState()
            kinds = dict(master.getTopicTypes())
        except (OSError, rosgraph.MasterException):  # asked again in a moment
            return ""
        nodes = {node for topic, nodes in publishers if topic == self._topic for node in nodes}
        for topic, listeners in sorted(subscribers):
            if kinds.get(topic) == CameraInfo._type and nodes.intersection(listeners):
                return topic
        return ""

    def _on_info(self, info: CameraInfo) -> None:
        self._info = info

    def _on_tags(self, message: TagDetectionArray) -> None:
        with self._lock:
            self._came = True
            if self._info is None or self._ended.is_set():
                return
            try:
                self._camera = self._camera_of(message.width, message.height)
            except ValueError as error:
                self._error = str(error)
                self._ended.set()
                return
            self._collection.add(
                message.width,
                [
                    (tag.id, np.array([(corner.x, corner.y) for corner in tag.corners]))
                    for tag in message.detections
                    if tag.family == self._family
                ],
            )
            if self._collection.full:
                self._ended.set()

    def _camera_of(self, width: int, height: int) -> CameraModel:
        known = self._camera
        if known is None:
            try:
                return camera_model(self._info, (width, height))
            except ValueError as error:
                raise ValueError(f"camera_info on {self._info_topic}: {error}") from None
        if (width, height) != (known.width, known.height):
            was = f"{known.width}x{known.height}"
            raise ValueError(f"the pictures were {was}, and are {width}x{height} now")
        return known

    def _state(self) -> str:
        with self._lock:
            return self._collection.summary() if self._camera else "waiting: " + self._lacking()

    def _lacking(self) -> str:
        if not self._came:
            nobody = (
                ""
                if self._subscribers[0].get_num_connections()
                else "; nobody publishes there: see tags:= in --help"
            )
            return f"no tags came on {self._topic}{nobody}"
        if not self._info_topic:
            return (
                "the topic of the calibration is not known: say camera_info:=/usb_cam/camera_info"
            )
        return f"no camera_info came on {self._info_topic}"
