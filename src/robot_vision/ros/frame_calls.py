"""Calls, of services and actions, that wait for what a node makes of its next frame."""

import contextlib
import threading
import time
from concurrent import futures
from typing import Any, Callable, Iterator, List, NamedTuple, Optional

from .image_node import ImageNode

FRAME_PERIOD = 1.0  # s after a frame during which the next one may be on its way already
POLL_PERIOD = 0.05  # s between two questions whether a call waits no longer


class _Call(NamedTuple):
    """A call that waits."""

    came: float  # s of the monotonic clock
    busy: float  # s in which frames were processed until then
    result: futures.Future


class FrameCalls:
    """Gives calls what is made of a frame that was taken after they came. Thread-safe.

    Args:
        node: The node that processes the frames; it works as long as there is a call.
    """

    def __init__(self, node: ImageNode):
        self._node = node
        self._lock = threading.Lock()  # guards all attributes below
        self._calls: List[_Call] = []  # that get the next frame
        self._later_calls: List[_Call] = []  # that get the one after it
        self._working = 0  # number of calls for which the node has to work
        self._last_frame = -FRAME_PERIOD  # s of the monotonic clock
        self._under_way = 0  # number of frames that are processed
        self._began: Optional[float] = None  # s of the monotonic clock, of the first of these
        self._busy = 0.0  # s in which frames before it were processed

    @property
    def waiting(self) -> bool:
        """Whether a call waits for a frame."""
        with self._lock:
            return bool(self._calls or self._later_calls)

    def offer(self, result: Callable[[], Any], taken: Optional[float] = None) -> None:
        """Offers what is made of a frame to the calls that wait for it.

        Args:
            result: A function that makes it, which is called for each.
            taken: When the node took the frame, s of the monotonic clock, by default now; calls
                that came later wait on.
        """
        for call in self._take(taken):
            try:
                call.set_result(result())
            except Exception as error:
                call.set_exception(error)

    def refuse(self, reason: str) -> None:
        """Has the calls that wait raise RuntimeError, because a frame is of no use to them."""
        for call in self._take():
            call.set_exception(RuntimeError(reason))

    @contextlib.contextmanager
    def working(self) -> Iterator[None]:
        """Has the node work meanwhile."""
        self._count(1)
        try:
            yield
        finally:
            self._count(-1)

    @contextlib.contextmanager
    def processing(self) -> Iterator[None]:
        """Has calls wait while a frame is processed, however long that takes."""
        with self._lock:
            self._under_way += 1
            if self._under_way == 1:
                self._began = time.monotonic()
        try:
            yield
        finally:
            with self._lock:
                self._under_way -= 1
                if self._under_way == 0:
                    self._busy, self._began = self._busy_until_now(), None

    def wait(self, timeout: float, given_up: Callable[[], bool] = lambda: False) -> Any:
        """Waits for the next frame, and returns what is made of it; raises what that raises.

        Args:
            timeout: s that it waits at most, without those in which a frame was processed.
            given_up: A function that is asked now and then whether to wait no longer.

        Raises:
            RuntimeError: There was no frame, or `given_up` returned a true value.
        """
        with self._lock:
            call = _Call(time.monotonic(), self._busy_until_now(), futures.Future())
            # A frame that was taken before the call may be on its way.
            on_its_way = call.came - self._last_frame < FRAME_PERIOD
            (self._later_calls if on_its_way else self._calls).append(call)
        try:
            while not futures.wait([call.result], POLL_PERIOD).done:
                if given_up():
                    raise RuntimeError("the call was ended")
                if self._waited(call) > timeout:
                    raise RuntimeError(self._node.no_frame(timeout))
            return call.result.result()
        finally:
            with self._lock:
                for calls in (self._calls, self._later_calls):
                    if call in calls:
                        calls.remove(call)

    def _waited(self, call: _Call) -> float:
        """Returns for how many s a call has waited while no frame was processed."""
        with self._lock:
            return time.monotonic() - call.came - (self._busy_until_now() - call.busy)

    def _busy_until_now(self) -> float:
        return self._busy + (0.0 if self._began is None else time.monotonic() - self._began)

    def _take(self, taken: Optional[float] = None) -> List[futures.Future]:
        """Returns the calls that get the frame that was taken at that time, by default now."""
        with self._lock:
            taken = time.monotonic() if taken is None else taken
            self._last_frame = taken
            ready = [call.result for call in self._calls if call.came <= taken]
            promoted = [call for call in self._later_calls if call.came <= taken]
            self._calls = [call for call in self._calls if call.came > taken] + promoted
            self._later_calls = [call for call in self._later_calls if call.came > taken]
        return ready

    def _count(self, change: int) -> None:
        with self._lock:
            self._working += change
            self._node.keep_working(self._working > 0)
