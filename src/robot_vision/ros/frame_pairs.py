"""Pairs of frames and the messages about them that another node publishes."""

import collections
import math
import threading
from typing import Any, Deque, Optional

from .transport import Frame

MAX_LAG = 2.0  # s, largest delay of the messages or of the frames
MAX_BYTES = 128 << 20  # bytes, largest size of the frames that wait
MAX_MESSAGES = 1000  # that wait; those without stamps never become too old
MAX_UNMATCHED = 10  # messages in a row without a frame, from which on it is no accident


class FramePairs:
    """Pairs messages with the frames of their stamps, whichever come first. Thread-safe.

    The messages may be frames, too, of another topic. Frames are referenced, not copied, and
    released as soon as a message belongs to a later one. message_filters cannot replace this: it
    bounds the number of frames but not their size, and keeps older frames after a match.

    Args:
        slop: By how much two stamps may differ, in s. Of several that wait the nearest is taken,
            and of two that are as near the newer one. 0: they must be the same.
    """

    def __init__(self, slop: float = 0.0) -> None:
        self.slop = slop
        self._lock = threading.Lock()  # guards all attributes below
        self._frames: Deque[Frame] = collections.deque()
        self._messages: Deque[Any] = collections.deque(maxlen=MAX_MESSAGES)
        self._unmatched = 0  # messages in a row without a frame

    def message_of(self, frame: Frame) -> Optional[Any]:
        """Returns the message that waited for this frame; if there is none, keeps the frame."""
        with self._lock:
            return self._match(frame, self._frames, self._messages)

    def frame_of(self, message: Any) -> Optional[Frame]:
        """Returns the frame of this message; if it has not come yet, keeps the message."""
        with self._lock:
            frame = self._match(message, self._messages, self._frames)
            self._unmatched += frame is None
            return frame

    def apart(self) -> bool:
        """Returns whether so many messages in a row had no frame that the two do not fit.

        They are not apart as long as no frame has come: nothing is known of its stamp.
        """
        with self._lock:
            return self._unmatched >= MAX_UNMATCHED and bool(self._frames)

    def distance(self) -> float:
        """Returns by how much those two stamps differ that are nearest to each other, in s.

        It is that of the messages and frames that wait, infinite if there are none of either.
        """
        with self._lock:
            messages, frames = (
                [entry.header.stamp.to_nsec() for entry in waiting]
                for waiting in (self._messages, self._frames)
            )
        apart = (abs(one - other) for one in messages for other in frames)
        return min(apart, default=math.inf) * 1e-9

    def clear(self) -> None:
        """Releases all frames and messages that wait."""
        with self._lock:
            self._frames.clear()
            self._messages.clear()
            self._unmatched = 0

    def _match(self, new: Any, alike: Deque[Any], others: Deque[Any]) -> Optional[Any]:
        """Returns the one of `others` that belongs to `new`, which else waits with those alike."""
        found = _take(others, new.header.stamp, self.slop)
        if found is None:
            alike.append(new)
            _drop_old(alike)
            _limit_size(alike)
        else:
            alike.clear()
            self._unmatched = 0
        return found


def _drop_old(waiting: Deque[Any]) -> None:
    """Drops entries that are much older than the newest, or from before the stamps went back."""
    newest = waiting[-1].header.stamp
    while not 0.0 <= (newest - waiting[0].header.stamp).to_sec() <= MAX_LAG:
        waiting.popleft()


def _limit_size(waiting: Deque[Any]) -> None:
    """Drops the oldest frames if all together are too large; the newest one stays."""
    size = sum(_bytes_of(entry) for entry in waiting)
    while size > MAX_BYTES and len(waiting) > 1:
        size -= _bytes_of(waiting.popleft())


def _bytes_of(entry: Any) -> int:
    return entry.image.nbytes if isinstance(entry, Frame) else 0


def _take(waiting: Deque[Any], stamp: Any, slop: float) -> Optional[Any]:
    """Removes and returns the entry nearest to this stamp, or None; older ones are dropped too."""
    time, nearest, least = stamp.to_nsec(), -1, round(slop * 1e9)  # ns
    for index, entry in enumerate(waiting):
        apart = abs(entry.header.stamp.to_nsec() - time)
        if apart <= least:
            nearest, least = index, apart
    found = waiting[nearest] if nearest >= 0 else None
    for _ in range(nearest + 1):
        waiting.popleft()
    return found
