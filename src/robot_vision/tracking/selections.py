"""How people select what a tracker follows, and end it: by ~select and by services."""

import contextlib
import threading
from typing import Any, Callable, Iterator, List, Optional, Sequence

from ..common.plain_text import MAX_NAME_LENGTH, brief
from ..ros.context import current
from ..ros.image_node import ImageNode
from ..ros.messages import Box, clipped_box
from ..ros.selections import SELECT_TIMEOUT, Selection, Selections
from ..srv import ForgetObject, ForgetObjectResponse, SelectObject, SelectObjectResponse

MAX_FRAME_AGE = 1.0  # s; nobody selects something in a frame that is older
MAX_OBJECTS = 100  # each is looked for in every frame


class TrackSelection(Selection):
    """A region that is to be followed.

    Args:
        box: (x, y, width, height) in px.
        label: The object's name.
        replaces: Whether it replaces all other objects.
        timeout: How long it waits for a frame, in s.

    Attributes:
        id: That of the object, -1 before it is followed.
    """

    def __init__(
        self, box: Box, label: str = "", replaces: bool = True, timeout: float = SELECT_TIMEOUT
    ):
        super().__init__(box, timeout)
        self.label = label
        self.replaces = replaces
        self.id = -1


class TrackSelections(Selections):
    """Selects regions as objects of a tracker, each in the frame that people saw.

    They come from ~select and from ~select_object; ~forget ends following objects. While a region
    waits for its frame, or there are objects, the node works even if nobody subscribes, because it
    would lose the objects otherwise.

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
        super().__init__(node, lock, lambda: bool(tracker.objects()) or waits_for_more())
        self.replaces = True  # whether a region of the topic replaces all objects
        self._tracker = tracker
        self._outputs: Sequence[Any] = ()
        self._time: Optional[float] = None  # s, the newest frame

    def listen(self, outputs: Sequence[Any]) -> None:
        """Takes regions from now on. `outputs` are all that the node publishes."""
        self._outputs = outputs
        self.subscribe()
        current().service("~select_object", SelectObject, self._on_select)
        current().service("~forget", ForgetObject, self._on_forget)

    def add(self, selection: Selection) -> None:
        """Selects a region in the newest frame, or in the next one. The lock must be held."""
        if not self._busy and not any(one.get_num_connections() for one in self._outputs):
            self._time = None  # No images were coming, so nobody saw the last one.
        super().add(selection)

    @contextlib.contextmanager
    def updating(self, now: float) -> Iterator[None]:
        """Selects what waits before or after the tracker takes the frame of `now` (s).

        People select in the frame that they saw, which is the last one if frames were coming. The
        lock must be held.
        """
        waiting = self.take()
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

    def _select_all(self, waiting: List[TrackSelection]) -> None:
        for selection in waiting:
            present = [track.id for track in self._tracker.objects()]
            try:
                if not selection.replaces and len(present) >= MAX_OBJECTS:
                    raise ValueError(
                        f"there are {len(present)} objects, which is the most: forget one before"
                    )
                selection.id = self._tracker.select(selection.box, selection.label)
            except ValueError as error:
                self.refuse(selection, error)
                continue
            for number in present if selection.replaces else []:
                self._tracker.forget(number)
            selection.done.set()

    def _selection(self, box: Box) -> TrackSelection:
        return TrackSelection(box, replaces=self.replaces)

    def _on_select(self, request: Any) -> SelectObjectResponse:
        length = len(request.label)
        if length > MAX_NAME_LENGTH:  # It would be published with each frame.
            error = f"label is {brief(request.label)}: {length} letters, must be at most"
            return SelectObjectResponse(False, f"{error} {MAX_NAME_LENGTH}", -1)
        selection = TrackSelection(clipped_box(request.region), request.label, replaces=False)
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
