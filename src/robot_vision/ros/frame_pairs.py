"""Pairs of frames and the messages about them that another node publishes."""

import math
import threading
from typing import Any, Optional

from .recent import Recent
from .transport import Frame

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
        self._frames, self._messages = Recent(in_order=True), Recent()
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

    def lateness(self) -> str:
        """Returns in words how late the messages come, if their frames were dropped meanwhile."""
        with self._lock:
            if not self._messages:
                return ""
            return self._frames.lateness(self._messages[-1].header.stamp)

    def late_text(self, messages: str, frames: str) -> str:
        """Returns that as a sentence that names the topics of both; empty if they are in time."""
        late = self.lateness()
        return f"what comes on {messages} is too late for {frames}: {late}" if late else ""

    def clear(self) -> None:
        """Releases all frames and messages that wait."""
        with self._lock:
            self._frames.clear()
            self._messages.clear()
            self._unmatched = 0

    def _match(self, new: Any, alike: Recent, others: Recent) -> Optional[Any]:
        """Returns the one of `others` that belongs to `new`, which else waits with those alike."""
        found = _take(others, new.header.stamp, self.slop)
        if found is None:
            alike.keep(new)
        else:
            alike.clear()
            self._unmatched = 0
        return found


def _take(waiting: Recent, stamp: Any, slop: float) -> Optional[Any]:
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
