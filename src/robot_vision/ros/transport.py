"""The implementation of robot_vision.transport."""

import atexit
import sys
import threading
import traceback
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

from .. import _transport
from ..common.files import ROS_HOME_NEEDED
from ..common.plain_text import brief, printable
from ..common.throttle import Throttle
from .registration import keep_registered

__all__ = [
    "Callback",
    "CameraSubscriber",
    "Frame",
    "FrameError",
    "ImagePublisher",
    "ImageSubscriber",
    "add_connection_listener",
    "camera_info_beside",
    "node_diagnostics",
    "note_connections",
    "remapped",
    "remapped_camera_info",
]


@dataclass(eq=False, repr=False)
class Frame:
    """An image that was received.

    Attributes:
        image: (height, width) or (height, width, channels) array. It is read-only, and stays valid
            as long as it is referenced, even after the subscriber is gone. Copy it to draw on it.
        encoding: The encoding of the pixels, as in sensor_msgs/image_encodings.
        header: The header of the message. Publish results with it, so that they keep its stamp and
            frame_id.
        camera_info: The CameraInfo of the same stamp if a CameraSubscriber received the image,
            else None.
    """

    image: np.ndarray
    encoding: str
    header: Header
    camera_info: Optional[CameraInfo] = None

    @property
    def time(self) -> float:
        """The stamp of the image in s, or the present time if it has none."""
        return self.header.stamp.to_sec() or rospy.get_time()


Callback = Callable[[Frame], Any]


class FrameError(ValueError):
    """Raised by a callback for a frame that it cannot use; the frame then counts as refused."""


class ImageSubscriber:
    """Calls a function with the newest image of a topic.

    An image that cannot be used, because of its size or because it cannot be converted, is refused
    with an error in the log. If the callback raises an exception, its traceback is logged. Both
    are counted, and the next image is processed as usual.

    Args:
        topic: The topic of a sensor_msgs/Image, or the base topic of image_transport.
        callback: The function that is called with each Frame.
        encoding: The encoding to which images are converted in C++: "bgr8", "mono8" or another one
            that cv_bridge can convert to. With None the image is a view of the message as it is.
        transport: The transport: raw, compressed, ... None takes the parameter ~image_transport,
            and raw if that is not set.
        diagnostics: The node's diagnostics, which count the images of one subscriber at most.
        start: Whether to subscribe at once. If not, start() subscribes.

    Raises:
        ValueError: The encoding or the transport does not exist, or ~image_transport is not a
            string.
    """

    def __init__(
        self,
        topic: str,
        callback: Callback,
        encoding: Optional[str] = None,
        transport: Optional[str] = None,
        diagnostics: Optional[_transport.Diagnostics] = None,
        start: bool = True,
    ):
        self.topic = rospy.resolve_name(topic)
        self.failed = 0  # number of callbacks that raised an exception
        self._failure_throttle, self._refusal_throttle = Throttle(), Throttle()
        if transport is None:
            transport = _transport_parameter()
        self._callback = callback
        self._inbox = _process().runtime.inbox(
            self.topic,
            transport,
            rospy.get_name(),
            encoding or "",
            self._camera_info_topic(),
            diagnostics,
        )
        if start:
            self.start()

    def start(self) -> None:
        """Subscribes to the topic."""
        _process().subscribers[self._inbox] = self
        self._inbox.open()

    def unregister(self) -> None:
        """Unsubscribes. A callback that is running goes on to its end, and frames stay valid."""
        self._inbox.close()
        _process().subscribers.pop(self._inbox, None)

    def get_num_connections(self) -> int:
        """Returns the number of connected publishers."""
        return self._inbox.publishers()

    @property
    def received(self) -> int:
        """The number of images taken from the topic, including refused ones."""
        return self._inbox.received

    @property
    def dropped(self) -> int:
        """The number of images missed, counted by gaps in header.seq: lost, or newer ones came."""
        return self._inbox.dropped

    @property
    def refused(self) -> int:
        """The number of images that could not be used, or whose callback raised an exception."""
        return self._inbox.refused

    def _camera_info_topic(self) -> str:
        return ""

    def _deliver(self, frame: Frame) -> None:
        try:
            self._callback(frame)
            self._inbox.finished()
        except FrameError as error:
            height, width = frame.image.shape[:2]
            what = f"({printable(frame.encoding)}, {width}x{height}): {printable(str(error), 300)}"
            self._inbox.failed(f"refused a frame on {self.topic} {what}")
            if self._refusal_throttle.due():
                rospy.logerr("refused a frame on %s %s", self.topic, what)
        except Exception as error:
            if rospy.core.is_shutdown_requested():
                return  # The shutdown closes topics that the callback uses.
            self.failed += 1
            self._inbox.failed(f"the callback failed: {printable(ascii(error), 300)}")
            if self._failure_throttle.due():
                rospy.logerr("%s: the callback failed:\n%s", self.topic, traceback.format_exc())


class CameraSubscriber(ImageSubscriber):
    """An ImageSubscriber whose frames come with the camera_info of the same stamp.

    The camera_info is expected on the topic camera_info if that name is remapped, and otherwise
    beside the image: for /usb_cam/image_raw on /usb_cam/camera_info.
    """

    def _camera_info_topic(self) -> str:
        return remapped_camera_info() or rospy.resolve_name(camera_info_beside(self.topic))


class ImagePublisher:
    """Publishes images over every image_transport that is installed.

    Args:
        topic: The base topic.
        on_connection: A function that is called when subscribers come or go, by the thread that
            calls all callbacks.
    """

    def __init__(self, topic: str, on_connection: Optional[Callable[[], Any]] = None):
        self.topic = rospy.resolve_name(topic)
        self._on_connection = on_connection
        self._outbox = _process().runtime.outbox(self.topic)
        if on_connection:
            add_connection_listener(on_connection)

    def get_num_connections(self) -> int:
        """Returns the number of subscribers; while it is 0, images need not be made."""
        return self._outbox.subscribers()

    def publish(
        self, image: np.ndarray, encoding: str = "bgr8", header: Optional[Header] = None
    ) -> None:
        """Publishes a copy of the image; does nothing while nobody subscribes.

        Args:
            image: (height, width) or (height, width, channels) array of the encoding's type.
            encoding: The encoding of the pixels, as in sensor_msgs/image_encodings.
            header: The header of the image that this one was made from. None stamps it with the
                present time.

        Raises:
            ValueError, TypeError: The array is not an image of this encoding.
        """
        header = header or Header(stamp=rospy.Time.now())
        stamp = header.stamp
        self._outbox.publish(image, encoding, header.seq, stamp.secs, stamp.nsecs, header.frame_id)

    def unregister(self) -> None:
        """Stops publishing."""
        if self._on_connection:
            _process().listeners.remove(self._on_connection)
            self._on_connection = None
        self._outbox.close()


class _Process:
    """The roscpp node inside this process, and the thread that calls all callbacks."""

    def __init__(self) -> None:
        options = {
            name: value
            for name, value in rospy.names.load_mappings(sys.argv).items()
            if name.startswith("__") and name not in ("__name", "__ns")
        }
        options["/diagnostics"] = rospy.resolve_name("/diagnostics")
        node, uri = rospy.get_name(), rospy.get_node_uri()
        try:
            self.runtime = _transport.Runtime(node + "_images", options, node, uri)
        except RuntimeError as error:  # A folder that roscpp needs cannot be made.
            raise ValueError(f"{error}; {ROS_HOME_NEEDED}") from None
        keep_registered()
        self._stopped = False
        # Each change of these two is a single step that the GIL makes atomic.
        self.subscribers: Dict[_transport.Inbox, ImageSubscriber] = {}
        self.listeners: List[Callable[[], Any]] = []
        self._thread = threading.Thread(target=self._run, name="images", daemon=True)
        self._thread.start()  # before the hook, which is called at once after a shutdown of rospy
        # This hook runs after those of the node, which may publish a last image.
        rospy.core.add_preshutdown_hook(lambda _reason: self.stop())
        # For a process that never shuts rospy down: atexit calls the newest function first.
        atexit.register(self.stop)

    def stop(self) -> None:
        """Ends the roscpp node; a callback that never returns is left behind."""
        if self._stopped:  # At the end of a process there is another call, which need not wait.
            return
        self._stopped = True
        self.runtime.stop()
        if threading.current_thread() is not self._thread:
            self._thread.join(1.0)

    def _run(self) -> None:
        try:
            while self.runtime.running():
                self._call(self._work)
            if not self._stopped:
                rospy.signal_shutdown("the node of its images was shut down")
        except SystemExit:  # Only in the main thread would it end the process.
            rospy.signal_shutdown("a callback has called sys.exit()")

    def _work(self) -> None:
        taken = self.runtime.next(1.0)
        if taken is None:
            if self.runtime.connections_changed():
                for listener in list(self.listeners):
                    self._call(listener)
            return
        inbox, image, encoding, seq, secs, nsecs, frame_id, info = taken
        subscriber = self.subscribers.get(inbox)
        if subscriber is None:  # It was unregistered a moment ago.
            return
        frame = Frame(image, encoding, _header(seq, secs, nsecs, frame_id))
        if info is not None:
            frame.camera_info = CameraInfo().deserialize(info)
        subscriber._deliver(frame)

    @staticmethod
    def _call(function: Callable[[], Any]) -> None:
        """Calls a function, and logs the exception if it raises one."""
        try:
            function()
        except Exception:
            rospy.logerr("a callback failed:\n%s", traceback.format_exc())


def remapped(name: str) -> str:
    """Returns the topic that a name is remapped to, or "" if it is not remapped."""
    return rospy.names.get_resolved_mappings().get(rospy.get_namespace() + name, "")


def remapped_camera_info() -> str:
    """Returns the topic that the name camera_info is remapped to, or "" if it is not remapped."""
    return remapped("camera_info")


def camera_info_beside(topic: str) -> str:
    """Returns the topic of the camera_info that belongs to an image topic."""
    return topic.rsplit("/", 1)[0] + "/camera_info"


def add_connection_listener(listener: Callable[[], Any]) -> None:
    """Registers a function that is called when subscribers of any ImagePublisher come or go."""
    _process().listeners.append(listener)


def note_connections() -> None:
    """Has all connection listeners called, as when other topics got subscribers. Thread-safe."""
    _process().runtime.note_connections()


def node_diagnostics() -> _transport.Diagnostics:
    """Returns statistics for an ImageSubscriber, published on /diagnostics under the node's name.

    Raises:
        ValueError: ~diagnostic_period is out of range.
    """
    return _process().runtime.diagnostics(rospy.get_name())


def _header(seq: int, secs: int, nsecs: int, frame_id: str) -> Header:
    """Returns a Header without calling the constructors, which take longer than all else here."""
    stamp = object.__new__(rospy.Time)
    stamp.secs, stamp.nsecs = secs, nsecs
    header = object.__new__(Header)
    header.seq, header.stamp, header.frame_id = seq, stamp, frame_id
    return header


def _transport_parameter() -> str:
    name = rospy.get_param("~image_transport", "raw")
    if not isinstance(name, str):
        raise ValueError(f"image_transport is {brief(name)}, must be a string")
    return name


_the_process: Optional[_Process] = None
_the_process_lock = threading.Lock()


def _process() -> _Process:
    """Returns the process's only roscpp node, which is started when it is first needed."""
    global _the_process
    with _the_process_lock:
        if _the_process is None:
            if not rospy.core.is_initialized():
                raise rospy.ROSInitException("call rospy.init_node() first")
            _the_process = _Process()
        return _the_process
