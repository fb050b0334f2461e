"""Pictures, and what another node has found in them."""

import collections
import threading
from typing import Any, Deque, Optional

from ..transport import Frame

FRAMES = 10  # that wait for their message, so many frames may its node be behind


class FramePairs:
    """Brings messages together with the frames of their stamps, whichever come first. Thread-safe.

    Frames are held, not copied, and let go as soon as a message is of a later one.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards both
        self._frames: Deque[Frame] = collections.deque(maxlen=FRAMES)
        self._messages: Deque[Any] = collections.deque(maxlen=FRAMES)

    def message_of(self, frame: Frame) -> Optional[Any]:
        """The message that has waited for this frame; without one the frame waits for it."""
        with self._lock:
            message = _taken(self._messages, frame.header.stamp)
            if message is None:
                self._frames.append(frame)
            else:
                self._frames.clear()
            return message

    def frame_of(self, message: Any) -> Optional[Frame]:
        """The frame of this message; if it has not come, the message waits for it."""
        with self._lock:
            frame = _taken(self._frames, message.header.stamp)
            if frame is None:
                self._messages.append(message)
            return frame

    def apart(self) -> bool:
        """Whether many messages in a row had no frame."""
        return len(self._messages) == FRAMES


def _taken(waiting: Deque[Any], stamp: Any) -> Optional[Any]:
    """The newest of this stamp, or None; those before it are waited for no more."""
    for index in reversed(range(len(waiting))):
        if waiting[index].header.stamp == stamp:
            found = waiting[index]
            for _ in range(index + 1):
                waiting.popleft()
            return found
    return None
