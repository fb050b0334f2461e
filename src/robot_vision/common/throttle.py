"""Limits how often errors are logged that may come with every frame."""

import time
from typing import Optional


class Throttle:
    """Lets one message through in each period, whatever its text is.

    Each kind of error needs a throttle of its own. Those of rospy distinguish messages by the line
    of code, which several topics share, or by the text, which a sender can change every time.

    Args:
        period: The shortest time between two messages in s.
    """

    def __init__(self, period: float = 5.0) -> None:
        self._period = period
        self._last: Optional[float] = None  # s of the monotonic clock, the last message

    def due(self) -> bool:
        """Returns whether a message may be logged now, and then counts it as logged."""
        now = time.monotonic()
        if self._last is not None and now - self._last < self._period:
            return False
        self._last = now
        return True
