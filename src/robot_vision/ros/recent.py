"""The newest frames or messages of a topic, as many as time and memory allow."""

from typing import Any, Deque, Optional, Tuple

MAX_LAG = 2.0  # s, largest delay of the messages or of the frames
MAX_BYTES = 128 << 20  # bytes, largest size of the frames that wait
MAX_ENTRIES = 1000  # those without stamps never become too old


class Recent(Deque[Any]):
    """The newest entries of a topic, which have headers; the oldest first.

    The images of entries that have one are referenced, not copied.

    Args:
        in_order: Whether they come in the order of their stamps, as the frames of a camera do: when
            the stamps go back, as in a bag that begins anew, all from before is dropped.
    """

    def __init__(self, in_order: bool = False) -> None:
        super().__init__(maxlen=MAX_ENTRIES)
        self._in_order = in_order
        # The earliest and the last stamp of those that had to make room.
        self._dropped: Optional[Tuple[Any, Any]] = None

    def keep(self, entry: Any) -> None:
        """Adds the newest entry, for which old ones make room."""
        if self._in_order and self and entry.header.stamp < self[-1].header.stamp:
            self.clear()
            self._dropped = None
        self.append(entry)
        self._drop_old()
        self._limit_size()

    def lateness(self, stamp: Any) -> str:
        """Returns in words how late comes what belongs to an entry that was dropped.

        The text is empty if none of about this stamp was: it has not come, or is still here.
        """
        if not self or self._dropped is None:
            return ""
        earliest, last = self._dropped
        if not earliest <= stamp <= last < self[0].header.stamp:
            return ""
        newest = self[-1].header.stamp
        kept = (newest - self[0].header.stamp).to_sec()
        return (
            f"the last is {(newest - stamp).to_sec():.3g} s older than the newest image, and only "
            f"the images of {kept:.3g} s are kept"
        )

    def _drop_old(self) -> None:
        """Drops what is much older than the newest, or from before the stamps went back."""
        newest = self[-1].header.stamp
        while not 0.0 <= (newest - self[0].header.stamp).to_sec() <= MAX_LAG:
            self._drop()

    def _limit_size(self) -> None:
        """Drops the oldest frames if all together are too large; the newest one stays."""
        size = sum(map(_bytes_of, self))
        while size > MAX_BYTES and len(self) > 1:
            size -= _bytes_of(self[0])
            self._drop()

    def _drop(self) -> None:
        stamp = self.popleft().header.stamp
        self._dropped = min(stamp, self._dropped[0]) if self._dropped else stamp, stamp


def _bytes_of(entry: Any) -> int:
    return entry.image.nbytes if hasattr(entry, "image") else 0
