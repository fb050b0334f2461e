"""What robot_vision.transport offers."""

import atexit
import sys
import threading
import traceback
from typing import Any, Callable, Dict, List, Optional

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

from .. import _transport
from ..common.files import ROS_HOME_NEEDED
from ..common.plain_text import printable, told
from ..common.throttle import Throttle
from .registration import keep_registered


class Frame:
    """A picture that came in.

    Attributes:
        image: (height, width) or (height, width, channels) array, read-only; valid as long as it
            is held, also after the subscriber is gone. Copy it to draw into it.
        encoding: of the pixels, as in sensor_msgs/image_encodings.
        header: of the message; publish results with it, so that stamp and frame_id survive.
        camera_info: of the same stamp, from a CameraSubscriber, else None.
    """

    __slots__ = ("camera_info", "encoding", "header", "image")

    def __init__(
        self,
        image: np.ndarray,
        encoding: str,
        header: Header,
        camera_info: Optional[CameraInfo] = None,
    ):
        self.image = image
        self.encoding = encoding
        self.header = header
        self.camera_info = camera_info

    @property
    def time(self) -> float:
        """s, when it was taken; now, if it has no stamp."""
        return self.header.stamp.to_sec() or rospy.get_time()


Callback = Callable[[Frame], Any]


class FrameError(ValueError):
    """A callback raises it for a frame that it cannot use, and the frame is refused."""


class ImageSubscriber:
    """Calls back with the newest picture of a topic.

    A picture that cannot be used (wrong size, no such conversion) is refused with an error in the
    log. A callback that raises is logged with its traceback. Both are counted, and the next
    picture comes.

    Args:
        topic: a sensor_msgs/Image topic, or the base name of one, as image_transport has it.
        callback: is called with a Frame.
        encoding: to convert to, in C++: "bgr8", "mono8" or whatever cv_bridge converts to. None:
            the message's own, as a view of its memory.
        transport: raw, compressed, ... None: the parameter ~image_transport, or else raw.
        diagnostics: of the node, to count in; for one subscriber only.
        start: whether to subscribe at once; else with start().

    Raises:
        ValueError: there is no such encoding or transport, or ~image_transport is no string.
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
        self.failed = 0  # callbacks that raised
        self._told_failed, self._told_refused = Throttle(), Throttle()
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
        """Subscribes."""
        _process().subscribers[self._inbox] = self
        self._inbox.open()

    def unregister(self) -> None:
        """Unsubscribes; a callback under way goes on to its end. Frames stay valid."""
        self._inbox.close()
        _process().subscribers.pop(self._inbox, None)

    def get_num_connections(self) -> int:
        """How many publishers are connected."""
        return self._inbox.publishers()

    @property
    def received(self) -> int:
        """Pictures taken from the topic, those refused among them."""
        return self._inbox.received

    @property
    def dropped(self) -> int:
        """Pictures not seen, by the gaps in header.seq: a newer one came, or they were lost."""
        return self._inbox.dropped

    @property
    def refused(self) -> int:
        """Pictures that could not be used, those among them whose callback raised."""
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
            if self._told_refused.due():
                rospy.logerr("refused a frame on %s %s", self.topic, what)
        except Exception as error:
            if rospy.core.is_shutdown_requested():
                return  # its topics are being closed
            self.failed += 1
            self._inbox.failed(f"the callback failed: {printable(ascii(error), 300)}")
            if self._told_failed.due():
                rospy.logerr("%s: the callback failed:\n%s", self.topic, traceback.format_exc())


class CameraSubscriber(ImageSubscriber):
    """An ImageSubscriber whose frames come with the camera_info of the same stamp.

    The camera_info is on the topic camera_info if that is remapped, otherwise beside the picture's:
    of /usb_cam/image_raw on /usb_cam/camera_info.
    """

    def _camera_info_topic(self) -> str:
        return remapped_camera_info() or rospy.resolve_name(camera_info_beside(self.topic))


class ImagePublisher:
    """Publishes pictures over every installed image_transport.

    Args:
        topic: the base name.
        on_connection: is called when subscribers come or go, by the thread of all callbacks.
    """

    def __init__(self, topic: str, on_connection: Optional[Callable[[], Any]] = None):
        self.topic = rospy.resolve_name(topic)
        self._on_connection = on_connection
        self._outbox = _process().runtime.outbox(self.topic)
        if on_connection:
            add_connection_listener(on_connection)

    def get_num_connections(self) -> int:
        """How many subscribers there are; without any, pictures need not be made."""
        return self._outbox.subscribers()

    def publish(
        self, image: np.ndarray, encoding: str = "bgr8", header: Optional[Header] = None
    ) -> None:
        """Publishes a copy of the picture; nothing if nobody subscribes.

        Args:
            image: (height, width) or (height, width, channels) array of the encoding's type.
            encoding: as in sensor_msgs/image_encodings.
            header: of what the picture was made from. None: the time is now.

        Raises:
            ValueError, TypeError: the array is no picture of this encoding.
        """
        header = header or Header(stamp=rospy.Time.now())
        stamp = header.stamp
        self._outbox.publish(image, encoding, header.seq, stamp.secs, stamp.nsecs, header.frame_id)

    def unregister(self) -> None:
        """Ends the topic."""
        if self._on_connection:
            _process().listeners.remove(self._on_connection)
            self._on_connection = None
        self._outbox.close()


class _Process:
    """The roscpp half of this process, and the thread of the callbacks."""

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
        except RuntimeError as error:  # of a user for whom no folder can be made
            raise ValueError(f"{error}; {ROS_HOME_NEEDED}") from None
        keep_registered()
        self._stopped = False
        # Both are changed in single steps only, which the GIL makes atomic.
        self.subscribers: Dict[_transport.Inbox, ImageSubscriber] = {}
        self.listeners: List[Callable[[], Any]] = []
        self._thread = threading.Thread(target=self._run, name="images", daemon=True)
        self._thread.start()  # before the hook, which is called at once if rospy has been shut down
        # After all that the node's own hooks do, which may well publish a last picture.
        rospy.core.add_preshutdown_hook(lambda _reason: self.stop())
        atexit.register(self.stop)  # in a process that never shuts rospy down; called first

    def stop(self) -> None:
        """Ends the roscpp node; a callback that never returns is left behind."""
        self._stopped = True
        self.runtime.stop()
        if threading.current_thread() is not self._thread:
            self._thread.join(1.0)

    def _run(self) -> None:
        try:
            while self.runtime.running():
                self._call(self._work)
            if not self._stopped:
                rospy.signal_shutdown("the node of its pictures was shut down")
        except SystemExit:  # of a callback; only the main thread's would end the process
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
        if subscriber is None:  # it has just been unregistered
            return
        frame = Frame(image, encoding, _header(seq, secs, nsecs, frame_id))
        if info is not None:
            frame.camera_info = CameraInfo().deserialize(info)
        subscriber._deliver(frame)

    @staticmethod
    def _call(function: Callable[[], Any]) -> None:
        """Calls it, and lives on if it fails."""
        try:
            function()
        except Exception:
            rospy.logerr("a callback failed:\n%s", traceback.format_exc())


def remapped_camera_info() -> str:
    """What the name camera_info is remapped to; empty if it is not."""
    remappings = rospy.names.get_resolved_mappings()
    return remappings.get(rospy.get_namespace() + "camera_info", "")


def camera_info_beside(topic: str) -> str:
    """The topic of the camera_info that belongs to one of pictures."""
    return topic.rsplit("/", 1)[0] + "/camera_info"


def add_connection_listener(listener: Callable[[], Any]) -> None:
    """Has it called when subscribers of any ImagePublisher come or go, as its on_connection."""
    _process().listeners.append(listener)


def note_connections() -> None:
    """Has all listeners called, for subscribers of another kind of topic. Thread-safe."""
    _process().runtime.note_connections()


def node_diagnostics() -> _transport.Diagnostics:
    """Statistics for an ImageSubscriber, reported on /diagnostics under this node's name.

    Raises:
        ValueError: ~diagnostic_period is out of range.
    """
    return _process().runtime.diagnostics(rospy.get_name())


def _header(seq: int, secs: int, nsecs: int, frame_id: str) -> Header:
    """A Header as its constructors make it; they would take longer than all else here."""
    stamp = object.__new__(rospy.Time)
    stamp.secs, stamp.nsecs = secs, nsecs
    header = object.__new__(Header)
    header.seq, header.stamp, header.frame_id = seq, stamp, frame_id
    return header


def _transport_parameter() -> str:
    name = rospy.get_param("~image_transport", "raw")
    if not isinstance(name, str):
        raise ValueError(f"image_transport is {told(name)}, must be a string")
    return name


_the_process: Optional[_Process] = None
_the_process_lock = threading.Lock()


def _process() -> _Process:
    """The process's one roscpp half, started when it is first needed."""
    global _the_process
    with _the_process_lock:
        if _the_process is None:
            if not rospy.core.is_initialized():
                raise rospy.ROSInitException("call rospy.init_node() first")
            _the_process = _Process()
        return _the_process
