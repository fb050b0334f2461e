"""By how much the stamps of two things may differ that belong together."""

import math
from typing import Any, Optional


class StampLimit:
    """A slop, bounded by the period of what is paired.

    Half of the time between the last two stamps of a topic is the limit if that is less than the
    slop: of another one, before or to come, the stamp would be nearer.

    Args:
        slop: By how much two stamps may differ at most, in s.
    """

    def __init__(self, slop: float = 0.0) -> None:
        self.slop = slop
        self._newest: Optional[Any] = None
        self._between = math.inf  # s

    def follow(self, stamp: Any) -> None:
        """Takes the next stamp of the topic."""
        if self._newest is not None and stamp != self._newest:
            self._between = abs((stamp - self._newest).to_sec())
        self._newest = stamp

    def seconds(self) -> float:
        """Returns the limit, in s."""
        return min(self.slop, self._between / 2.0)

    def clear(self) -> None:
        """Forgets the stamps."""
        self._newest, self._between = None, math.inf
