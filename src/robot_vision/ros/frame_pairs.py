"""Pictures, and what another node has found in them."""

import collections
import threading
from typing import Any, Deque, Optional

from .transport import Frame

SPAN = 2.0  # s, so far may the other node, or the pictures, be behind
MOST_BYTES = 128 << 20  # of the frames that wait
MOST_MESSAGES = 1000  # that wait; without stamps none is too old
MANY = 10  # messages in a row without a frame: it is no accident


class FramePairs:
    """Brings messages together with the frames of their stamps, whichever come first. Thread-safe.

    Frames are held, not copied, and let go as soon as a message is of a later one.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards all that follows
        self._frames: Deque[Frame] = collections.deque()
        self._messages: Deque[Any] = collections.deque(maxlen=MOST_MESSAGES)
        self._missed = 0  # messages in a row without a frame

    def message_of(self, frame: Frame) -> Optional[Any]:
        """The message that has waited for this frame; without one the frame waits for it."""
        with self._lock:
            message = _taken(self._messages, frame.header.stamp)
            if message is None:
                self._frames.append(frame)
                _drop_old(self._frames)
                self._drop_many()
            else:
                self._frames.clear()
                self._missed = 0
            return message

    def frame_of(self, message: Any) -> Optional[Frame]:
        """The frame of this message; if it has not come, the message waits for it."""
        with self._lock:
            frame = _taken(self._frames, message.header.stamp)
            if frame is None:
                self._messages.append(message)
                _drop_old(self._messages)
                self._missed += 1
            else:
                self._messages.clear()
                self._missed = 0
            return frame

    def apart(self) -> bool:
        """Whether many messages in a row had no frame."""
        with self._lock:
            return self._missed >= MANY

    def clear(self) -> None:
        """Lets all go that waits."""
        with self._lock:
            self._frames.clear()
            self._messages.clear()
            self._missed = 0

    def _drop_many(self) -> None:
        size = sum(frame.image.nbytes for frame in self._frames)
        while size > MOST_BYTES and len(self._frames) > 1:
            size -= self._frames.popleft().image.nbytes


def _drop_old(waiting: Deque[Any]) -> None:
    """Drops what is much older than the newest, or of a time before the stamps went back."""
    newest = waiting[-1].header.stamp
    while not 0.0 <= (newest - waiting[0].header.stamp).to_sec() <= SPAN:
        waiting.popleft()


def _taken(waiting: Deque[Any], stamp: Any) -> Optional[Any]:
    """The newest of this stamp, or None; those before it are waited for no more."""
    for index in reversed(range(len(waiting))):
        if waiting[index].header.stamp == stamp:
            found = waiting[index]
            for _ in range(index + 1):
                waiting.popleft()
            return found
    return None
