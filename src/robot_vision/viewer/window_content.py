"""What a window tells about the images in it: their rate, and a title."""

import collections
import threading
from typing import Deque, Optional, Tuple

import cv2
import numpy as np

FONT = cv2.FONT_HERSHEY_SIMPLEX


class Rate:
    """The rate of an event over the last `seconds`. Thread-safe."""

    def __init__(self, seconds: float = 3.0):
        self._seconds = seconds
        self._lock = threading.Lock()  # guards the times
        self._times: Deque[float] = collections.deque()

    def add(self, now: float) -> None:
        """Counts an event at the time `now`, in s of any clock that never goes back."""
        with self._lock:
            self._times.append(now)
            self._forget(now)

    def hz(self, now: float) -> float:
        """Returns the rate in Hz; 0 if there were fewer than two events."""
        with self._lock:
            self._forget(now)
            span = self._times[-1] - self._times[0] if self._times else 0.0
            return (len(self._times) - 1) / span if span > 0.0 else 0.0

    def _forget(self, now: float) -> None:
        while self._times and self._times[0] < now - self._seconds:
            self._times.popleft()


def title(topic: str, hz: float, size: Optional[Tuple[int, int]]) -> str:
    """Returns the window's title. `size`: (width, height) in px, None before the first image."""
    return f"{topic}  {hz:.1f} Hz  {size[0]}x{size[1]}" if size else f"{topic}  waiting"


def placeholder(topic: str) -> np.ndarray:
    """Returns a placeholder for the first image: (480, 640, 3) uint8, gray, with a line of text."""
    image = np.full((480, 640, 3), 128, np.uint8)
    text = "waiting for " + topic
    (width, _), _ = cv2.getTextSize(text, FONT, 1.0, 1)
    scale = min(1.0, 600 / width)
    cv2.putText(image, text, (20, 250), FONT, scale, (255, 255, 255), 1, cv2.LINE_AA)
    return image
