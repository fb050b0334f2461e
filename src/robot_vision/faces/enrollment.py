"""Pictures of a person, taken while that person looks into the camera."""

import threading
import time
from typing import Any, Callable, Dict, Sequence

import numpy as np

from .face_picture import Box, face_of, portrait

PERIOD = 0.2  # s, at least between two pictures: they shall differ
POLL = 0.1  # s


class Enrollment:
    """Takes `count` portraits of the one face in the pictures that it is offered."""

    def __init__(self, count: int):
        self.portraits: Dict[str, np.ndarray] = {}
        self._count = count
        self._taken = float("-inf")  # s, when the last one was
        self._done = threading.Event()
        self._refused: Dict[str, int] = {}  # how many pictures, and why

    def offer(self, image: np.ndarray, boxes: Sequence[Box], now: float) -> None:
        """Takes a picture, if it shows one face that is found again in its portrait.

        Args:
            image: (height, width, 3) BGR, uint8.
            boxes: of the faces in it.
            now: s, on any clock that never goes back.
        """
        if self._done.is_set() or now - self._taken < PERIOD:
            return
        if len(boxes) != 1:
            # Nobody can tell whose name it is to be, and a wrong picture spoils a gallery.
            self._refuse("showed several faces" if boxes else "showed no face")
            return
        try:
            picture = portrait(image, boxes[0])
            face_of(picture)
        except ValueError:
            self._refuse("showed no clear face")
            return
        self._taken = now
        self.portraits[f"picture {len(self.portraits) + 1}"] = picture
        if len(self.portraits) == self._count:
            self._done.set()

    def wait(self, seconds: float, given_up: Callable[[], Any]) -> bool:
        """Whether all have been taken within this time of the wall clock."""
        deadline = time.monotonic() + seconds
        while not self._done.wait(POLL) and time.monotonic() < deadline and not given_up():
            pass
        return self._done.is_set()

    def outcome(self) -> str:
        """What has been taken, and what with the other pictures was wrong."""
        reasons = "".join(f"; {count} {reason}" for reason, count in sorted(self._refused.items()))
        return f"took {len(self.portraits)} of {self._count} pictures{reasons or '; saw no others'}"

    def _refuse(self, reason: str) -> None:
        self._refused[reason] = self._refused.get(reason, 0) + 1
