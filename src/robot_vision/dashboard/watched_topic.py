"""What an image hub knows of a topic that somebody looks at."""

import threading
import traceback
from typing import Any, Callable, List, Tuple

import rospy

from ..common.throttle import Throttle
from ..ros.transport import Frame
from .image_stream import ImageStream
from .pictures import Picture

_failures = Throttle()


class Handle:
    """What somebody has asked for; close() ends it.

    Attributes:
        wake: To be called when the viewer is ready again. Thread-safe, and quick.
    """

    def __init__(self, end: Callable[[], None], wake: Callable[[], None] = lambda: None):
        self.wake = wake
        self._end = end
        self._lock = threading.Lock()

    def close(self) -> None:
        """Ends it; does nothing the second time. Thread-safe."""
        with self._lock:
            end, self._end = self._end, lambda: None
        end()


class WatchedTopic:
    """A topic that somebody looks at."""

    def __init__(self, key: Tuple[str, bool], stream: ImageStream):
        self.key = key
        self.stream = stream
        self.source: Any = None
        self.callbacks: List[Callable[[Frame], Any]] = []
        self.users = 0
        self.idle_since = 0.0

    def receive(self, picture: Picture) -> None:
        self.stream.offer(picture)
        if picture.frame is not None:
            for callback in list(self.callbacks):
                self._call(callback, picture.frame)

    @staticmethod
    def _call(callback: Callable[[Frame], Any], frame: Frame) -> None:
        try:
            callback(frame)
        except Exception:  # of one must not keep images from others
            if _failures.due():
                rospy.logerr("a callback failed:\n%s", traceback.format_exc())
