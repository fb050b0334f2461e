"""The implementation of robot_vision.transport."""

import time
import traceback
from dataclasses import dataclass, field
from typing import Any, Callable, Optional

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

from .. import _transport
from ..common.plain_text import brief, printable
from ..common.throttle import Throttle
from .context import current
from .node_images import node_images

__all__ = [
    "KEPT",
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
    _spent: float = field(default=0.0, init=False)  # s that callbacks have worked on it

    @property
    def time(self) -> float:
        """The stamp of the image in s, or the present time if it has none."""
        return self.header.stamp.to_sec() or rospy.get_time()


Callback = Callable[[Frame], Any]
# What a callback returns that has not processed its frame, which counts as nothing as long as it
# does not go on with it: go_on().
KEPT = object()


class FrameError(ValueError):
    """Raised by a callback for a frame that it cannot use; the frame then counts as refused."""


class ReportedFrameError(FrameError):
    """A FrameError that is not logged for the frame, because the callback has logged the reason."""


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
        transport: The transport: raw, compressed, ..., or auto: shared memory where all publishers
            offer it, else raw. None takes the parameter ~image_transport, and auto if that is not
            set.
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
        self._context = current()
        self.topic = self._context.resolve(topic)
        self.failed = 0  # number of callbacks that raised an exception
        self._failure_throttle, self._refusal_throttle = Throttle(), Throttle()
        if transport is None:
            transport = _transport_parameter()
        self._callback = callback
        self._images = node_images()
        self._inbox = self._images.queue.inbox(
            self.topic,
            transport,
            self._context.name,
            encoding or "",
            self._camera_info_topic(),
            diagnostics,
        )
        if start:
            self.start()

    def start(self) -> None:
        """Subscribes to the topic."""
        self._images.subscribers[self._inbox] = self._receive
        self._inbox.open()

    def unregister(self) -> None:
        """Unsubscribes. A callback that is running goes on to its end, and frames stay valid."""
        self._inbox.close()
        self._images.subscribers.pop(self._inbox, None)

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

    def refuse(self, frame: Frame, error: FrameError) -> None:
        """Counts a frame as refused, and logs it, as when the callback raises this. Thread-safe."""
        height, width = frame.image.shape[:2]
        what = f"({printable(frame.encoding)}, {width}x{height}): {printable(str(error), 300)}"
        self._inbox.failed(f"refused a frame on {self.topic} {what}")
        if not isinstance(error, ReportedFrameError) and self._refusal_throttle.due():
            rospy.logerr("refused a frame on %s %s", self.topic, what)

    def go_on(self, frame: Frame, work: Callable[[], Any]) -> None:
        """Does the work on a frame that the callback has kept, which has returned KEPT.

        The frame then counts as processed, or refused if `work` raises an exception, as if the
        callback did it all. Thread-safe.
        """
        self._attempt(frame, work, self._finished_later)

    def _camera_info_topic(self) -> str:
        return ""

    def _receive(
        self,
        image: np.ndarray,
        encoding: str,
        seq: int,
        secs: int,
        nsecs: int,
        frame_id: str,
        info: Optional[bytes],
    ) -> None:
        frame = Frame(image, encoding, _header(seq, secs, nsecs, frame_id))
        if info is not None:
            frame.camera_info = CameraInfo().deserialize(info)
        self._deliver(frame)

    def _deliver(self, frame: Frame) -> None:
        self._attempt(frame, lambda: self._callback(frame), lambda _: self._inbox.finished())

    def _finished_later(self, frame: Frame) -> None:
        stamp = frame.header.stamp
        self._inbox.finished_later(frame._spent, stamp.secs, stamp.nsecs)

    def _attempt(
        self, frame: Frame, work: Callable[[], Any], finished: Callable[[Frame], Any]
    ) -> None:
        begin = time.monotonic()
        try:
            result = work()
            frame._spent += time.monotonic() - begin
            if result is not KEPT:
                finished(frame)
        except FrameError as error:
            self.refuse(frame, error)
        except Exception as error:
            if self._context.is_ending():
                return  # The end closes topics that the callback uses.
            self._inbox.failed(f"the callback failed: {printable(ascii(error), 300)}")
            self.failed += 1
            if self._failure_throttle.due():
                rospy.logerr("%s: the callback failed:\n%s", self.topic, traceback.format_exc())


class CameraSubscriber(ImageSubscriber):
    """An ImageSubscriber whose frames come with the camera_info of the same stamp.

    The camera_info is expected on the topic camera_info if that name is remapped, and otherwise
    beside the image: for /usb_cam/image_raw on /usb_cam/camera_info.
    """

    def _camera_info_topic(self) -> str:
        beside = camera_info_beside(self.topic)
        return remapped_camera_info() or current().resolve(beside)


class ImagePublisher:
    """Publishes images over every image_transport that is installed.

    Args:
        topic: The base topic.
        on_connection: A function that is called when subscribers come or go, by the thread that
            calls all callbacks.
    """

    def __init__(self, topic: str, on_connection: Optional[Callable[[], Any]] = None):
        self.topic = current().resolve(topic)
        self._on_connection = on_connection
        self._images = node_images()
        self._outbox = self._images.queue.outbox(self.topic)
        if on_connection:
            self._images.listeners.append(on_connection)

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
            header: The header of the image that this one was made from, whose number is replaced
                by that of the image on the topic. None stamps it with the present time.

        Raises:
            ValueError, TypeError: The array is not an image of this encoding.
        """
        header = header or Header(stamp=rospy.Time.now())
        stamp = header.stamp
        self._outbox.publish(image, encoding, stamp.secs, stamp.nsecs, header.frame_id)

    def unregister(self) -> None:
        """Stops publishing."""
        if self._on_connection:
            self._images.listeners.remove(self._on_connection)
            self._on_connection = None
        self._outbox.close()


def remapped(name: str) -> str:
    """Returns the topic that a name is remapped to, or "" if it is not remapped."""
    return current().remapped(name)


def remapped_camera_info() -> str:
    """Returns the topic that the name camera_info is remapped to, or "" if it is not remapped."""
    return remapped("camera_info")


def camera_info_beside(topic: str) -> str:
    """Returns the topic of the camera_info that belongs to an image topic."""
    return topic.rsplit("/", 1)[0] + "/camera_info"


def add_connection_listener(listener: Callable[[], Any]) -> None:
    """Registers a function that is called when subscribers of any ImagePublisher come or go."""
    node_images().listeners.append(listener)


def note_connections() -> None:
    """Has all connection listeners called, as when other topics got subscribers. Thread-safe."""
    node_images().queue.note_connections()


def node_diagnostics() -> _transport.Diagnostics:
    """Returns statistics for an ImageSubscriber, published on /diagnostics under the node's name.

    Raises:
        ValueError: ~diagnostic_period is out of range.
    """
    return node_images().queue.diagnostics()


def _header(seq: int, secs: int, nsecs: int, frame_id: str) -> Header:
    """Returns a Header without calling the constructors, which take longer than all else here."""
    stamp = object.__new__(rospy.Time)
    stamp.secs, stamp.nsecs = secs, nsecs
    header = object.__new__(Header)
    header.seq, header.stamp, header.frame_id = seq, stamp, frame_id
    return header


def _transport_parameter() -> str:
    name = current().get_param("~image_transport", "auto")
    if not isinstance(name, str):
        raise ValueError(f"image_transport is {brief(name)}, must be a string")
    return name
