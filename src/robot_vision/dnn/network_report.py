"""What object_detector says of its network: on /diagnostics, and in the log if it fails."""

import contextlib
import math
import threading
import time
from typing import Dict, Iterator, Mapping, Optional

import rospy
from diagnostic_msgs.msg import DiagnosticStatus

from ..common.plain_text import error_text
from ..common.throttle import Throttle
from ..ros.context import current
from ..ros.status_topic import Status, StatusTopic
from .network import Network

SLOW = 5.0  # s after which a run is said to take long, if it is no network that always does
TIMES_SLOW = 10.0  # of the mean time of a run, for the same
SMOOTHING = 0.1  # share of the newest run in the mean time
RECENT = 5.0  # s for which a failure counts even if the next run succeeds
MAX_ERROR_LENGTH = 300  # characters


def facts_of(network: Network) -> Dict[str, str]:
    """Returns what the status says of a network that does not change."""
    return {
        "model": network.model.path,
        "head": network.head.head,
        "backend": network.runtime.name,
        "input": f"{network.input.width}x{network.input.height}",
        "advice": network.advice,
    }


class NetworkReport:
    """Publishes a status `<node>: network`, once in ~diagnostic_period. Thread-safe.

    Args:
        facts: What does not change, by name.

    Attributes:
        max_age: s for which things are remembered that no run has found; inf: none are followed.
        period: s from one run to the next, at least.

    Raises:
        ValueError: ~diagnostic_period is out of range.
    """

    def __init__(self, facts: Mapping[str, str]):
        self.max_age, self.period = math.inf, 0.0
        self._facts = dict(facts)
        self._lock = threading.Lock()  # guards all below
        self._status = StatusTopic("network")
        self._throttle = Throttle()
        self._began: Optional[float] = None  # s of the monotonic clock, the run that has not ended
        self._runs, self._failures = 0, 0
        self._mean: Optional[float] = None  # s that a run takes
        self._last_failure = float("-inf")  # s of the monotonic clock
        self._fails = False  # whether the newest run has failed
        self._last_error = ""

    @contextlib.contextmanager
    def running(self) -> Iterator[None]:
        """Knows that the network runs meanwhile."""
        with self._lock:
            self._began = time.monotonic()
        try:
            yield
        finally:
            with self._lock:
                self._began = None

    def add_run(self, seconds: float) -> None:
        """Adds a run of the network on an image, and what is done before and after it."""
        with self._lock:
            self._runs += 1
            self._fails = False
            mean = seconds if self._mean is None else self._mean
            self._mean = mean + SMOOTHING * (seconds - mean)

    def add_failure(self, error: Exception) -> None:
        """Adds a run that has raised an exception, which is logged now and then."""
        text = error_text(error, MAX_ERROR_LENGTH)
        with self._lock:
            self._failures += 1
            self._fails = True
            self._last_failure, self._last_error = time.monotonic(), text
            # A node that ends has closed the topics before its network is done.
            due = not current().is_ending() and self._throttle.due()
        if due:
            rospy.logerr("the network has failed, the next frame is tried: %s", text)

    def publish(self) -> None:
        """Publishes the status if it is due."""
        with self._lock:
            self._status.publish(self._made)

    def _made(self) -> Status:
        values: Dict[str, str] = dict(self._facts)
        values["frames looked at"] = str(self._runs)
        values["failures"] = str(self._failures)
        values["last error"] = self._last_error
        if self._mean is not None:
            values["time of a frame (ms)"] = f"{1e3 * self._mean:.1f}"
        if self._fails or time.monotonic() - self._last_failure < RECENT:
            return DiagnosticStatus.ERROR, f"the network has failed: {self._last_error}", values
        taken = 0.0 if self._began is None else time.monotonic() - self._began
        if taken > max(SLOW, TIMES_SLOW * (self._mean or 0.0)):
            return DiagnosticStatus.WARN, f"a frame takes {taken:.0f} s already", values
        apart = max(self._mean or 0.0, self.period)
        if apart >= self.max_age:  # Each thing is a new one in each run.
            times = f"runs are {apart:.1f} s apart, and max_age is {self.max_age:g}"
            return DiagnosticStatus.WARN, f"nothing can be followed: {times}", values
        if self._mean is None:
            return DiagnosticStatus.OK, "the network has not looked at a frame yet", values
        return DiagnosticStatus.OK, f"{1e3 * self._mean:.1f} ms for a frame", values
