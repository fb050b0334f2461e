"""Errors that come with every frame, told now and then."""

import time
from typing import Optional


class Throttle:
    """Lets one message in `period` seconds through, whatever it says.

    One for each kind of error: those of rospy go by the line of code, which several topics share,
    or by the text, which a sender can change with every message.
    """

    def __init__(self, period: float = 5.0) -> None:
        self._period = period
        self._last: Optional[float] = None  # s of the monotonic clock

    def due(self) -> bool:
        """Whether a message may be told now; it then counts as told."""
        now = time.monotonic()
        if self._last is not None and now - self._last < self._period:
            return False
        self._last = now
        return True
