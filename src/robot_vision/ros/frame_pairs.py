"""Pairs of frames and the messages about them that another node publishes."""

import collections
import threading
from typing import Any, Deque, Optional

from .transport import Frame

MAX_LAG = 2.0  # s, largest delay of the messages or of the frames
MAX_BYTES = 128 << 20  # bytes, largest size of the frames that wait
MAX_MESSAGES = 1000  # that wait; those without stamps never become too old
MAX_UNMATCHED = 10  # messages in a row without a frame, from which on it is no accident


class FramePairs:
    """Pairs messages with the frames of the same stamps, whichever come first. Thread-safe.

    Frames are referenced, not copied, and released as soon as a message belongs to a later one.
    message_filters cannot replace this: it bounds the number of frames but not their size, and
    keeps older frames after a match.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards all attributes below
        self._frames: Deque[Frame] = collections.deque()
        self._messages: Deque[Any] = collections.deque(maxlen=MAX_MESSAGES)
        self._unmatched = 0  # messages in a row without a frame

    def message_of(self, frame: Frame) -> Optional[Any]:
        """Returns the message that waited for this frame; if there is none, keeps the frame."""
        with self._lock:
            message = self._match(frame, self._frames, self._messages)
            self._limit_size()
            return message

    def frame_of(self, message: Any) -> Optional[Frame]:
        """Returns the frame of this message; if it has not come yet, keeps the message."""
        with self._lock:
            frame = self._match(message, self._messages, self._frames)
            self._unmatched += frame is None
            return frame

    def apart(self) -> bool:
        """Returns whether so many messages in a row had no frame that the two do not fit."""
        with self._lock:
            return self._unmatched >= MAX_UNMATCHED

    def clear(self) -> None:
        """Releases all frames and messages that wait."""
        with self._lock:
            self._frames.clear()
            self._messages.clear()
            self._unmatched = 0

    def _match(self, new: Any, alike: Deque[Any], others: Deque[Any]) -> Optional[Any]:
        """Returns the one of `others` that belongs to `new`, which else waits with those alike."""
        found = _take(others, new.header.stamp)
        if found is None:
            alike.append(new)
            _drop_old(alike)
        else:
            alike.clear()
            self._unmatched = 0
        return found

    def _limit_size(self) -> None:
        size = sum(frame.image.nbytes for frame in self._frames)
        while size > MAX_BYTES and len(self._frames) > 1:
            size -= self._frames.popleft().image.nbytes


def _drop_old(waiting: Deque[Any]) -> None:
    """Drops entries that are much older than the newest, or from before the stamps went back."""
    newest = waiting[-1].header.stamp
    while not 0.0 <= (newest - waiting[0].header.stamp).to_sec() <= MAX_LAG:
        waiting.popleft()


def _take(waiting: Deque[Any], stamp: Any) -> Optional[Any]:
    """Removes and returns the newest entry of this stamp, or None; older ones are dropped too."""
    for index in reversed(range(len(waiting))):
        if waiting[index].header.stamp == stamp:
            found = waiting[index]
            for _ in range(index + 1):
                waiting.popleft()
            return found
    return None
