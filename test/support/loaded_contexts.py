"""Shared by tests of several nodes in one process: nodes that take images, in this one."""

import threading
from typing import Any, Callable, List, Optional

import support

from robot_vision.ros.context import LoadedContext, active, current
from robot_vision.transport import Frame, ImageSubscriber


class ImageTaker:
    """A node of this process that takes the images of a topic, and keeps them.

    Args:
        name: The name of the node.
        topic: The topic.
        encoding, transport: As of the ImageSubscriber.
        work: What it does with each frame before that counts as received.
    """

    def __init__(
        self,
        name: str,
        topic: str,
        encoding: Optional[str] = None,
        transport: str = "raw",
        work: Callable[[Frame], Any] = lambda _: None,
    ):
        support.open_messages.append(self)
        self.received: List[Frame] = []
        self.names: List[str] = []  # of the contexts in which the callback was called
        self.threads: List[int] = []
        self.exits: List[str] = []  # reasons for which it wanted to end
        self._work = work
        self.context = LoadedContext(name, {}, self.exits.append)
        with active(self.context):
            self.images = ImageSubscriber(topic, self._take, encoding, transport)

    def _take(self, frame: Frame) -> None:
        self.names.append(current().name)
        self.threads.append(threading.get_ident())
        self._work(frame)
        self.received.append(frame)
        support.arrived.set()

    def wait(self, count: int = 1) -> List[Frame]:
        support.wait_for(lambda: len(self.received) >= count, f"{count} frames")
        return self.received[:count]

    def close(self) -> None:
        support.open_messages.remove(self)
        self.context.end()
