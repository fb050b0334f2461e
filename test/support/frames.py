"""Shared by the tests of robot_vision.transport: images as messages, and received frames."""

import copy
import itertools
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple

import numpy as np
import rospy
import support
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from robot_vision.transport import Frame, ImageSubscriber

COLORS = {"bgr": 3, "rgb": 3, "bgra": 4, "rgba": 4}
PATTERNS = ("rggb", "bggr", "gbrg", "grbg")
TYPES = {"8U": "u1", "8S": "i1", "16U": "u2", "16S": "i2", "32S": "i4", "32F": "f4", "64F": "f8"}
ENCODINGS = {  # name: dtype and channels
    **{f"{name}{bits}": (f"u{bits // 8}", n) for name, n in COLORS.items() for bits in (8, 16)},
    **{f"mono{bits}": (f"u{bits // 8}", 1) for bits in (8, 16)},
    **{f"bayer_{name}{bits}": (f"u{bits // 8}", 1) for name in PATTERNS for bits in (8, 16)},
    **{name: ("u1", 2) for name in ("yuv422", "yuv422_yuy2")},
    **{f"{name}C{n}": (dtype, n) for name, dtype in TYPES.items() for n in (1, 2, 3, 4)},
}
UNKNOWN = ["", "rgb565", "jpeg", "nv12", "8UC0", "8UC513", "9UC1", "BGR8", "passthrough"]

numbers = itertools.count()


def new_topic() -> str:
    """A topic that no other test uses."""
    return f"/frames_{next(numbers)}/image"


def message(pixels: np.ndarray, encoding: str, padding: int = 0, order: str = "<") -> Image:
    """An image message with this padding of noise after each row and this byte order."""
    rows = np.ascontiguousarray(pixels, pixels.dtype.newbyteorder(order))
    rows = rows.view(np.uint8).reshape(len(pixels), -1)
    noise = np.random.default_rng(1).integers(0, 256, (len(rows), padding), np.uint8)
    rows = np.hstack([rows, noise])
    return Image(
        encoding=encoding,
        height=pixels.shape[0],
        width=pixels.shape[1],
        step=rows.shape[1],
        is_bigendian=order == ">",
        data=rows.tobytes(),
    )


def pixels(message: Image) -> np.ndarray:
    """The pixels of a message, (height, width), or (height, width, channels) if it has several."""
    dtype, channels = ENCODINGS[message.encoding]
    kind = np.dtype((">" if message.is_bigendian else "<") + dtype)
    rows = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
    used = np.ascontiguousarray(rows[:, : message.width * channels * kind.itemsize]).view(kind)
    return used.reshape(message.height, message.width, channels) if channels > 1 else used


def noise(encoding: str, height: int = 4, width: int = 6) -> np.ndarray:
    """A random image over the full range of values of an encoding."""
    dtype, channels = ENCODINGS[encoding]
    rng = np.random.default_rng(3)
    size = (height, width, channels) if channels > 1 else (height, width)
    if dtype.startswith("f"):
        return rng.uniform(-300.0, 300.0, size).astype(dtype)
    limits = np.iinfo(dtype)
    return rng.integers(limits.min, limits.max, size, dtype, endpoint=True)


def damaged(
    good: Image, unknown: Sequence[str] = UNKNOWN
) -> Iterator[Tuple[Dict[str, Any], Image]]:
    """Everything that can be wrong with a message: the wrong fields, and the message with them."""
    step, height, data = good.step, good.height, good.data
    wrongs = [
        {"data": b""},
        {"data": data[:-1]},
        {"data": data + b"\0"},
        {"step": 0, "data": b""},
        {"step": step - 1, "data": data[: height * (step - 1)]},
        {"width": 0},
        {"height": 0},
        {"width": 0, "height": 0, "step": 0, "data": b""},
        {"width": 2**32 - 1},
        {"height": 2**32 - 1},
        {"width": 2**31, "height": 2**31, "step": 2**31},
        {"height": 2**31 + height, "step": 2 * step, "data": data * 2},  # data's size mod 2^32
        {"is_bigendian": 7},
        *({"encoding": name} for name in unknown),
    ]
    for fields in wrongs:
        bad = copy.copy(good)
        bad.header = Header(frame_id="bad")
        for name, value in fields.items():
            setattr(bad, name, value)
        yield fields, bad


class Frames:
    """Collects all frames of a topic from now on."""

    def __init__(self, topic: str, encoding: Optional[str] = None, kind: Any = ImageSubscriber):
        support.open_messages.append(self)
        self.received: List[Frame] = []
        self.subscriber = kind(topic, self.received.append, encoding)

    def wait(self, count: int = 1) -> List[Frame]:
        """Waits for the first `count` frames."""
        topic = self.subscriber.topic
        support.wait_for(lambda: len(self.received) >= count, f"{count} frames on {topic}")
        return self.received[:count]

    def close(self) -> None:
        support.open_messages.remove(self)
        self.subscriber.unregister()


class Source:
    """Publishes messages with rospy."""

    def __init__(self, topic: str, kind: Any = Image):
        support.open_messages.append(self)
        self.topic = topic
        self._publisher = rospy.Publisher(topic, kind, queue_size=100, tcp_nodelay=True)

    def wait_for(self, connections: int = 1) -> None:
        """Waits for this many connections; roscpp makes one for all subscribers of a process."""
        support.wait_for(
            lambda: self._publisher.get_num_connections() == connections,
            f"{connections} connections to {self.topic}",
        )

    def send(self, message: Any) -> None:
        self._publisher.publish(message)

    def close(self) -> None:
        support.open_messages.remove(self)
        self._publisher.unregister()


class Camera(Source):
    """Publishes images with the stamps of a rate in Hz, however fast they are sent."""

    def __init__(self, rate: float, topic: Optional[str] = None):
        super().__init__(topic or new_topic())
        self._stamps = (rospy.Time.from_sec(number / rate) for number in itertools.count(1))

    def show(self, pixels: np.ndarray, encoding: str = "bgr8", **options: Any) -> Header:
        """Sends an image of the frame `eye`, and returns its header."""
        sent = message(pixels, encoding, **options)
        sent.header.stamp, sent.header.frame_id = next(self._stamps), "eye"
        self.send(sent)
        return sent.header
