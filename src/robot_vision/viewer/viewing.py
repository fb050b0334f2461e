"""What a window with a camera's pictures says of them."""

import collections
import threading
from typing import Deque, Optional, Tuple

import cv2
import numpy as np

FONT = cv2.FONT_HERSHEY_SIMPLEX


class Rate:
    """How often something happens, over the last `seconds`. Thread-safe."""

    def __init__(self, seconds: float = 3.0):
        self._seconds = seconds
        self._lock = threading.Lock()  # guards the times
        self._times: Deque[float] = collections.deque()

    def add(self, now: float) -> None:
        """It happened, at `now` on any clock in seconds that never goes back."""
        with self._lock:
            self._times.append(now)
            self._forget(now)

    def hz(self, now: float) -> float:
        """The rate in Hz; 0 if it happened less than twice."""
        with self._lock:
            self._forget(now)
            span = self._times[-1] - self._times[0] if self._times else 0.0
            return (len(self._times) - 1) / span if span > 0.0 else 0.0

    def _forget(self, now: float) -> None:
        while self._times and self._times[0] < now - self._seconds:
            self._times.popleft()


def title(topic: str, hz: float, size: Optional[Tuple[int, int]]) -> str:
    """A window's title. `size`: (width, height) in px, None before the first picture."""
    return f"{topic}  {hz:.1f} Hz  {size[0]}x{size[1]}" if size else f"{topic}  waiting"


def waiting_picture(topic: str) -> np.ndarray:
    """What to show before the first picture: (480, 640, 3) uint8, grey, with a line of text."""
    picture = np.full((480, 640, 3), 128, np.uint8)
    text = "waiting for " + topic
    (width, _), _ = cv2.getTextSize(text, FONT, 1.0, 1)
    scale = min(1.0, 600 / width)
    cv2.putText(picture, text, (20, 250), FONT, scale, (255, 255, 255), 1, cv2.LINE_AA)
    return picture
