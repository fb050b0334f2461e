"""Pairs of images and the depth images of the same time, for a node that also works without."""

import collections
from typing import Any, Deque, Generic, List, Optional, Tuple, TypeVar

from .recent import MAX_BYTES
from .stamp_limit import StampLimit

Image = TypeVar("Image")  # what is known of an image; it has a header
Depth = TypeVar("Depth")  # what is known of a depth image; it has a header, and an array `image`

MAX_DEPTHS = 4  # that are kept
MAX_WAITING = 4  # images that wait
LIVING = 2.0  # s without a depth, after which no image waits for one
MAX_UNMET = 20  # images in a row, with depths between them, from which on it is no accident


class DepthPairs(Generic[Image, Depth]):
    """Finds the depth image of each image by their stamps, whichever comes first.

    Each image goes on once, in the order in which they come. It goes on alone when a later depth
    has come but none that is its own, when others wait behind it for too long, and at once while
    there are no depths, or none that have the stamps of any image. A depth may be that of several
    images. For one thread at a time.

    Args:
        slop: By how much two stamps may differ at most, in s: see StampLimit, of the depths.
    """

    def __init__(self, slop: float = 0.0) -> None:
        self._limit = StampLimit(slop)
        self._depths: Deque[Depth] = collections.deque(maxlen=MAX_DEPTHS)
        self._waiting: Deque[Image] = collections.deque()
        # Headers of images that may have gone on: if depths have their stamps, the next ones wait.
        self._headers: Deque[Any] = collections.deque(maxlen=MAX_WAITING)
        self._last_depth = float("-inf")  # s, when one came
        self._fresh = False  # whether a depth has come since the newest image
        self._unmet = 0  # images in a row that came after a depth, while no two stamps met

    @property
    def slop(self) -> float:
        """By how much two stamps may differ at most, in s."""
        return self._limit.slop

    @slop.setter
    def slop(self, slop: float) -> None:
        self._limit.slop = slop

    def add_image(self, image: Image, now: float) -> List[Tuple[Image, Optional[Depth]]]:
        """Returns which images go on, and with which depths, as an image comes at `now` (s)."""
        self._unmet += self._fresh
        self._fresh = False
        self._headers.append(image.header)
        self._waiting.append(image)
        return self._settled(now)

    def add_depth(self, depth: Depth, now: float) -> List[Tuple[Image, Optional[Depth]]]:
        """Returns which images go on, and with which depths, as a depth comes at `now` (s)."""
        self._last_depth, self._fresh = now, True
        self._limit.follow(depth.header.stamp)
        self._depths.append(depth)
        while len(self._depths) > 1 and sum(one.image.nbytes for one in self._depths) > MAX_BYTES:
            self._depths.popleft()
        if any(self._nearest(header) is not None for header in self._headers):
            self._unmet = 0
        return self._settled(now)

    def problem(self, image_topic: str, depth_topic: str) -> str:
        """Returns, in a line that names the topics, that no stamps meet; empty if some do."""
        if self._unmet < MAX_UNMET or not self._depths:
            return ""
        image, depth = self._headers[-1].stamp, self._depths[-1].header.stamp
        return (
            f"the stamps on {image_topic} and {depth_topic} do not meet: the newest are "
            f"{image.to_sec():.6f} s and {depth.to_sec():.6f} s, must be at most {self.slop:g} s "
            "apart"
        )

    def clear(self) -> None:
        """Forgets all images."""
        for waiting in (self._depths, self._waiting, self._headers):
            waiting.clear()
        self._limit.clear()
        self._last_depth = float("-inf")
        self._fresh, self._unmet = False, 0

    def _settled(self, now: float) -> List[Tuple[Image, Optional[Depth]]]:
        """Removes and returns the images at the front that need not wait any longer."""
        patient = now - self._last_depth <= LIVING and self._unmet < MAX_UNMET
        ready = []
        while self._waiting:
            header = self._waiting[0].header
            depth = self._nearest(header)
            if depth is not None:
                self._unmet = 0
            elif patient and len(self._waiting) <= MAX_WAITING and self._may_come(header):
                break
            ready.append((self._waiting.popleft(), depth))
        return ready

    def _may_come(self, header: Any) -> bool:
        """Returns whether the newest depth is older, so that a later one may be nearer."""
        return _seconds(self._depths[-1].header, header) <= 0.0

    def _nearest(self, header: Any) -> Optional[Depth]:
        """Returns the depth whose stamp is nearest to that of a header, if it is near enough.

        Of several with the same stamp it is the newest.
        """
        found = min(
            reversed(self._depths),
            key=lambda depth: abs(_seconds(depth.header, header)),
            default=None,
        )
        if found is None or abs(_seconds(found.header, header)) > self._limit.seconds():
            return None
        return found


def _seconds(one: Any, other: Any) -> float:
    """Returns how much later the stamp of the first header is."""
    return (one.stamp - other.stamp).to_sec()
