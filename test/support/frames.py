"""Shared by the tests of robot_vision.transport: images as messages, and received frames."""

import itertools
from typing import Any, List, Optional

import numpy as np
import rospy
import support
from sensor_msgs.msg import Image

from robot_vision.transport import Frame, ImageSubscriber

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
