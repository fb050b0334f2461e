"""Calls, of services and actions, that wait for what a node makes of its next frame."""

import contextlib
import threading
import time
from concurrent import futures
from typing import Any, Callable, Iterator, List

from .image_node import ImageNode

FRAME_PERIOD = 1.0  # s after a frame during which the next one may be on its way already
POLL_PERIOD = 0.05  # s between two questions whether a call waits no longer


class FrameCalls:
    """Gives calls what is made of a frame that was taken after they came. Thread-safe.

    Args:
        node: The node that processes the frames; it works as long as there is a call.
    """

    def __init__(self, node: ImageNode):
        self._node = node
        self._lock = threading.Lock()  # guards all attributes below
        self._calls: List[futures.Future] = []  # that get the next frame
        self._later_calls: List[futures.Future] = []  # that get the one after it
        self._working = 0  # number of calls for which the node has to work
        self._last_frame = -FRAME_PERIOD  # s of the monotonic clock

    def offer(self, result: Callable[[], Any]) -> None:
        """Offers what is made of a frame to the calls that wait: `result` makes it for each."""
        for call in self._take():
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

    def wait(self, timeout: float, given_up: Callable[[], bool] = lambda: False) -> Any:
        """Waits for the next frame, and returns what is made of it; raises what that raises.

        Args:
            timeout: s that it waits at most.
            given_up: A function that is asked now and then whether to wait no longer.

        Raises:
            RuntimeError: There was no frame, or `given_up` returned a true value.
        """
        call: futures.Future = futures.Future()
        with self._lock:
            # A frame that was taken before the call may be on its way.
            on_its_way = time.monotonic() - self._last_frame < FRAME_PERIOD
            (self._later_calls if on_its_way else self._calls).append(call)
        deadline = time.monotonic() + timeout
        try:
            while not futures.wait([call], POLL_PERIOD).done:
                if given_up():
                    raise RuntimeError("the call was ended")
                if time.monotonic() > deadline:
                    raise RuntimeError(self._node.no_frame(timeout))
            return call.result()
        finally:
            with self._lock:
                for calls in (self._calls, self._later_calls):
                    if call in calls:
                        calls.remove(call)

    def _take(self) -> List[futures.Future]:
        """Returns the calls that get the frame that there is now."""
        with self._lock:
            self._last_frame = time.monotonic()
            ready, self._calls, self._later_calls = self._calls, self._later_calls, []
        return ready

    def _count(self, change: int) -> None:
        with self._lock:
            self._working += change
            self._node.keep_working(self._working > 0)
