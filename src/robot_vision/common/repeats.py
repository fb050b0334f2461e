"""What has been told a short time ago, and need not be told again."""

from typing import Dict, Hashable, Iterable, Set


class Repeats:
    """Tells news from repetitions; period (s): a thing is news again after this, 0: always."""

    def __init__(self, period: float = 0.0):
        self.period = period
        self._told: Dict[Hashable, float] = {}  # s, when last

    def news(self, things: Iterable[Hashable], now: float) -> Set[Hashable]:
        """Those that are news at the time `now`, s of any clock; all are, if it has gone back."""
        self._told = {
            thing: when for thing, when in self._told.items() if 0.0 <= now - when < self.period
        }
        fresh = set(things) - set(self._told)
        self._told.update(dict.fromkeys(fresh, now))
        return fresh
