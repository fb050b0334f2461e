"""How people select what a tracker follows, and end it: by a topic and by services."""

import contextlib
import threading
import time
from typing import Any, Callable, Iterator, List, Optional, Sequence

import rospy
from sensor_msgs.msg import RegionOfInterest

from ..common.throttle import Throttle
from ..ros.image_node import ImageNode
from ..ros.messages import clipped_box
from ..srv import ForgetObject, ForgetObjectResponse, SelectObject, SelectObjectResponse

MAX_FRAME_AGE = 1.0  # s; nobody selects something in a frame that is older
SELECT_TIMEOUT = 5.0  # s that a selection waits for a frame


class Selection:
    """A region that waits for a frame in which it is selected.

    Args:
        region: The region in px.
        label: The object's name.
        replaces: Whether it replaces all other objects.
        timeout: How long it waits, in s.
    """

    def __init__(
        self, region: RegionOfInterest, label: str, replaces: bool, timeout: float = SELECT_TIMEOUT
    ):
        self.box = clipped_box(region)
        self.label = label
        self.replaces = replaces
        self.deadline = time.monotonic() + timeout
        self.done = threading.Event()
        self.id = -1
        self.error = ""

    def fail(self, error: str) -> None:
        self.error = error
        self.done.set()


class Selections:
    """Selects regions as objects of a tracker, each in the frame that people saw.

    The regions come from a topic (sensor_msgs/RegionOfInterest) and from ~select_object; ~forget
    ends following objects. While a region waits for its frame, or there are objects, the node works
    even if nobody subscribes, because it would lose the objects otherwise.

    Args:
        node: The node of the images.
        lock: The lock that guards the tracker. It guards all attributes here as well.
        tracker: The tracker: it has objects(), each with an id, select(box, label) and forget(id).
        waits_for_more: Whether the node is to work though there are no objects yet.
    """

    def __init__(
        self,
        node: ImageNode,
        lock: threading.Lock,
        tracker: Any,
        waits_for_more: Callable[[], bool] = lambda: False,
    ):
        self.replaces = True  # whether a region of the topic replaces all objects
        self._node = node
        self._lock = lock
        self._tracker = tracker
        self._waits_for_more = waits_for_more
        self._waiting: List[Selection] = []
        self._outputs: Sequence[Any] = ()
        self._refusal_throttle = Throttle()
        self._time: Optional[float] = None  # s, the newest frame
        self._busy = False  # whether there are objects, or may soon be

    def listen(self, topic: str, outputs: Sequence[Any]) -> None:
        """Takes regions from now on. `outputs` are all that the node publishes."""
        self._outputs = outputs
        self._topic = rospy.Subscriber(topic, RegionOfInterest, self._on_region)
        rospy.Service("~select_object", SelectObject, self._on_select)
        rospy.Service("~forget", ForgetObject, self._on_forget)

    def keep_working(self) -> None:
        """Has the node work while there is something to follow. The lock must be held."""
        busy = bool(self._waiting or self._tracker.objects() or self._waits_for_more())
        if busy != self._busy:
            self._busy = busy
            self._node.keep_working(busy)

    def add(self, selection: Selection) -> None:
        """Selects a region in the newest frame, or in the next one. The lock must be held."""
        if not self._busy and not any(one.get_num_connections() for one in self._outputs):
            self._time = None  # No images were coming, so nobody saw the last one.
        self._drop_expired()
        if selection.replaces:
            self._waiting = [other for other in self._waiting if not other.replaces]
        self._waiting.append(selection)
        self.keep_working()

    @contextlib.contextmanager
    def updating(self, now: float) -> Iterator[None]:
        """Selects what waits before or after the tracker takes the frame of `now` (s).

        People select in the frame that they saw, which is the last one if frames were coming. The
        lock must be held.
        """
        self._drop_expired()
        waiting, self._waiting = self._waiting, []
        in_last = self._time is not None and 0.0 <= now - self._time < MAX_FRAME_AGE
        try:
            if in_last:
                self._select_all(waiting)
            yield
            if not in_last:
                self._select_all(waiting)
        finally:
            for selection in waiting:
                if not selection.done.is_set():
                    selection.fail("the frame failed")
        self._time = now

    def _select_all(self, waiting: List[Selection]) -> None:
        for selection in waiting:
            others = [track.id for track in self._tracker.objects()] if selection.replaces else []
            try:
                selection.id = self._tracker.select(selection.box, selection.label)
            except ValueError as error:
                if self._refusal_throttle.due():
                    rospy.logerr("nothing selected on %s: %s", self._node.topic, error)
                selection.fail(str(error))
                continue
            for number in others:
                self._tracker.forget(number)
            selection.done.set()

    def _drop_expired(self) -> None:
        """Fails selections that no frame came for in time. The lock must be held."""
        for selection in self._waiting:
            if time.monotonic() > selection.deadline:
                selection.fail(self._node.no_frame(SELECT_TIMEOUT))
                rospy.logerr_throttle(1.0, "nothing selected: " + selection.error)
        self._waiting = [one for one in self._waiting if not one.done.is_set()]

    def _on_region(self, region: RegionOfInterest) -> None:
        with self._lock:
            self.add(Selection(region, "", self.replaces))

    def _on_select(self, request: Any) -> SelectObjectResponse:
        selection = Selection(request.region, request.label, False)
        with self._lock:
            self.add(selection)
        selection.done.wait(SELECT_TIMEOUT + 0.1)
        with self._lock:
            self._drop_expired()
            self.keep_working()
        return SelectObjectResponse(selection.id > 0, selection.error, selection.id)

    def _on_forget(self, request: Any) -> ForgetObjectResponse:
        with self._lock:
            known = [track.id for track in self._tracker.objects()]
            if request.id != -1 and request.id not in known:
                names = ", ".join(map(str, known)) or "none"
                return ForgetObjectResponse(
                    False, f"id is {request.id}, must be of an object ({names}), or -1 for all"
                )
            for number in known if request.id == -1 else [request.id]:
                self._tracker.forget(number)
            self.keep_working()
        return ForgetObjectResponse(True, "")
