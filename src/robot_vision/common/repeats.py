"""Decides which things are news, and which were reported a short time ago."""

from typing import Dict, Hashable, Iterable, Set


class Repeats:
    """Tells news from repetitions: a thing is news again `period` s after its last report."""

    def __init__(self, period: float = 0.0):
        self.period = period
        self._reported: Dict[Hashable, float] = {}  # s, the time of the last report

    def clear(self) -> None:
        """Forgets what was reported."""
        self._reported = {}

    def news(self, things: Iterable[Hashable], now: float) -> Set[Hashable]:
        """Returns the things that are news at the time `now` in s; all are if time went back."""
        self._reported = {
            thing: when for thing, when in self._reported.items() if 0.0 <= now - when < self.period
        }
        fresh = set(things) - set(self._reported)
        self._reported.update(dict.fromkeys(fresh, now))
        return fresh
