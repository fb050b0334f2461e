"""What a node says on /diagnostics besides the statistics of its images."""

import time
from typing import Callable, Mapping, Optional, Tuple

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from .context import SHARED_QUEUE, current
from .params import read_param

Status = Tuple[int, str, Mapping[str, str]]  # level of DiagnosticStatus, message, values by name


class StatusTopic:
    """Publishes a status `<node>: <name>`, once in ~diagnostic_period.

    Args:
        name: What the status is about.

    Raises:
        ValueError: ~diagnostic_period is out of range.
    """

    def __init__(self, name: str):
        self._name = name
        self._period = read_param("diagnostic_period", 1.0, 0.01, 3600.0)
        self._publisher = current().publisher(
            "/diagnostics", DiagnosticArray, queue_size=SHARED_QUEUE
        )
        self._last = float("-inf")  # s of the monotonic clock, of the newest status
        self._untold: Optional[Callable[[], Status]] = None  # what was not due

    def publish(self, status: Callable[[], Status]) -> None:
        """Publishes what `status` returns if it is due."""
        self._untold = status
        if time.monotonic() - self._last >= self._period:
            self.publish_untold()

    def publish_untold(self) -> None:
        """Publishes the last status if that was not due: no other may come for a long time."""
        status, self._untold = self._untold, None
        if status is None:
            return
        self._last = time.monotonic()
        level, text, values = status()
        message = DiagnosticArray()
        message.header.stamp = rospy.Time.now()
        message.status = [
            DiagnosticStatus(
                level=level,
                name=f"{current().name.lstrip('/')}: {self._name}",
                message=text,
                hardware_id="none",
                values=[KeyValue(name, value) for name, value in values.items()],
            )
        ]
        self._publisher.publish(message)
