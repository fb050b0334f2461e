"""How fast a WebSocket is read, so that one that floods leaves the loop to others."""

import time

MAX_RATE = 200.0  # frames a second that a client may send; more are read later
BURST = 400.0  # frames that may come at once


class Pace:
    """Counts what a client sends against what it may send."""

    def __init__(self) -> None:
        self._allowance, self._filled = BURST, time.monotonic()

    def take(self, count: float = 1.0) -> float:
        """Counts frames; returns the time in s to wait before the next one is read."""
        now = time.monotonic()
        filled = min(BURST, self._allowance + (now - self._filled) * MAX_RATE)
        self._allowance, self._filled = filled - count, now
        return max(0.0, -self._allowance / MAX_RATE)

    def give_back(self) -> None:
        """Takes back the count of a frame that was expected."""
        self._allowance += 1.0
