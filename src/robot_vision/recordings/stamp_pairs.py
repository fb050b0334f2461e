"""Which images of two cameras belong together, by their stamps."""

import collections
from typing import Any, Deque, Generic, Optional, Sequence, Tuple, TypeVar

from ..ros.stamp_limit import StampLimit

MAX_WAITING = 10  # images of each camera that wait for the other one's

Item = TypeVar("Item")


class StampPairs(Generic[Item]):
    """Finds what belongs together, whichever comes first. Not thread-safe.

    Args:
        topics: Of the left and the right camera, for messages.
        slop: The largest difference in s between two stamps that meet: see StampLimit, of each
            camera.
    """

    def __init__(self, topics: Sequence[str], slop: float = 0.0):
        self._topics = topics
        self._slop = slop
        self._waiting: Tuple[Deque[Tuple[Any, Item]], ...] = tuple(
            collections.deque(maxlen=MAX_WAITING) for _ in topics
        )
        self._limits = [StampLimit(slop) for _ in topics]
        self.found = 0

    def add(self, side: int, stamp: Any, item: Item) -> Optional[Tuple[Item, Item]]:
        """Adds an item of the left camera, 0, or the right one, 1.

        Returns:
            The left and the right item if this one has made a pair complete. What is older waits
            no longer.
        """
        self._limits[side].follow(stamp)
        own, others = self._waiting[side], self._waiting[1 - side]
        near = [number for number, (other, _) in enumerate(others) if self._meet(stamp, other)]
        if not near:
            own.append((stamp, item))
            return None
        nearest = min(near, key=lambda number: abs((stamp - others[number][0]).to_sec()))
        partner = others[nearest][1]
        for _ in range(nearest + 1):
            others.popleft()
        own.clear()
        self.found += 1
        return (item, partner) if side == 0 else (partner, item)

    def problem(self) -> str:
        """Returns why nothing that waits is a pair."""
        for topic, waiting in zip(self._topics, self._waiting):
            if not waiting:
                return f"no image comes on {topic}"
            if waiting[-1][0].is_zero():
                return f"the images on {topic} have no stamps"
        left, right = self._topics
        newest = " s and ".join(f"{waiting[-1][0].to_sec():.6f}" for waiting in self._waiting)
        if self._slop:
            expected = f"at most --slop, {self._slop:g} s, and half of a camera's period apart"
        else:
            expected = "equal; --slop allows cameras that are not in step"
        return (
            f"the stamps on {left} and {right} do not meet: the newest are {newest} s, must be "
            + expected
        )

    def _meet(self, stamp: Any, other: Any) -> bool:
        if stamp.is_zero() or other.is_zero():  # Drivers that set no stamps leave them at 0.
            return False
        limit = min(one.seconds() for one in self._limits)
        return abs((stamp - other).to_sec()) <= limit
