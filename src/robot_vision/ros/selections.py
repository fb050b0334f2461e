"""Regions that people select in the image: they come on ~select, and wait for a frame."""

import math
import threading
import time
from typing import Any, Callable, List

import rospy
from sensor_msgs.msg import RegionOfInterest

from ..common.throttle import Throttle
from .context import current
from .image_node import ImageNode
from .messages import Box, clipped_box

SELECT_TIMEOUT = 10.0  # s that a selection waits for a frame: an idle node has to subscribe first


class Selection:
    """A region that waits for a frame in which it is selected.

    Args:
        box: (x, y, width, height) in px.
        timeout: How long it waits, in s.

    Attributes:
        replaces: Whether it takes the place of all others that wait and do so.
        done: Set when it was selected or failed.
        error: Why it failed, or "".
    """

    replaces = True

    def __init__(self, box: Box, timeout: float = SELECT_TIMEOUT):
        self.box = box
        self.deadline = time.monotonic() + timeout
        self.done = threading.Event()
        self.error = ""

    def fail(self, error: str) -> None:
        self.error = error
        self.done.set()


class Selections:
    """Regions that wait for a frame: those of ~select (sensor_msgs/RegionOfInterest) and others.

    While one waits, the node works even if nobody subscribes.

    Args:
        node: The node of the images.
        lock: The lock that guards all attributes here, and what `is_busy` looks at.
        is_busy: Returns whether the node is to work for another reason, though nobody subscribes.
    """

    def __init__(
        self, node: ImageNode, lock: threading.Lock, is_busy: Callable[[], bool] = lambda: False
    ):
        self._node = node
        self._lock = lock
        self._is_busy = is_busy
        self._context = current()
        self._waiting: List[Any] = []
        self._watched = False  # whether a thread fails what waits too long
        self._busy = False  # what the node was told last
        self._refusal_throttle, self._expiry_throttle = Throttle(), Throttle()

    def subscribe(self) -> None:
        """Takes regions of ~select from now on."""
        self._topic = current().subscriber("~select", RegionOfInterest, self._on_region)

    def add(self, selection: Selection) -> None:
        """Has a region wait for the next frame. The lock must be held."""
        self._drop_expired()
        if selection.replaces:
            self._waiting = [other for other in self._waiting if not other.replaces]
        self._waiting.append(selection)
        self.keep_working()
        if not self._watched and selection.deadline < math.inf:
            self._watched = True
            self._context.thread(self._watch, "selections").start()

    def take(self) -> List[Any]:
        """Returns what has waited for this frame, but not too long. The lock must be held."""
        self._drop_expired()
        waiting, self._waiting = self._waiting, []
        return waiting

    def refuse(self, selection: Selection, error: ValueError) -> None:
        """Logs why a region cannot be selected."""
        if self._refusal_throttle.due():
            rospy.logerr("nothing selected on %s: %s", self._node.topic, error)
        selection.fail(str(error))

    def keep_working(self) -> None:
        """Has the node work while there is a reason to. The lock must be held."""
        busy = bool(self._waiting) or self._is_busy()
        if busy != self._busy:
            self._busy = busy
            self._node.keep_working(busy)

    def _watch(self) -> None:
        """Fails what waits too long, also if no frame comes, until only that waits which may."""
        while not self._context.is_ending():
            with self._lock:
                self._drop_expired()
                self.keep_working()
                deadline = min((one.deadline for one in self._waiting), default=math.inf)
                if deadline == math.inf:
                    self._watched = False
                    return
            time.sleep(max(0.0, deadline - time.monotonic()))

    def _on_region(self, region: RegionOfInterest) -> None:
        with self._lock:
            self.add(self._selection(clipped_box(region)))

    def _selection(self, box: Box) -> Selection:
        """Returns what a region of the topic selects."""
        return Selection(box)

    def _drop_expired(self) -> None:
        """Fails selections that no frame came for in time. The lock must be held."""
        for selection in self._waiting:
            if time.monotonic() > selection.deadline:
                selection.fail(self._node.no_frame(SELECT_TIMEOUT))
                if self._expiry_throttle.due():
                    rospy.logerr("nothing selected: %s", selection.error)
        self._waiting = [one for one in self._waiting if not one.done.is_set()]
