"""Portraits of a person, taken while that person looks into the camera."""

import collections
import threading
import time
from dataclasses import dataclass
from typing import Any, Callable, Counter, Dict, Sequence

import numpy as np

from .face_images import Box, face_of, portrait

PERIOD = 0.2  # s, shortest time between two portraits, so that they differ
POLL = 0.1  # s
MAX_ABSENCE = 0.5  # s without the face, after which it may be another one that has its id


@dataclass(frozen=True)
class OfferedFace:
    """A face in an image, as its detector describes it."""

    box: Box
    id: int = -1  # -1: it is not followed
    predicted: bool = False  # not seen in this image, in which something else may be in its place


class Enrollment:
    """Takes `count` portraits of the only face in the images that it is offered.

    They are all of one face: it begins anew when one with another id is there than before, or when
    there was none for MAX_ABSENCE, as one that comes to its place may get its id. Faces that are
    not followed have the id -1, all of them.
    """

    def __init__(self, count: int):
        self.portraits: Dict[str, np.ndarray] = {}
        self._count = count
        self._taken = float("-inf")  # s, time of the last portrait
        self._id = -1  # of the face in the portraits
        self._seen = float("-inf")  # s, time of the last image in which a face was seen
        self._done = threading.Event()
        self._refused: Counter[str] = collections.Counter()  # number of refused images by reason

    def offer(self, image: np.ndarray, faces: Sequence[OfferedFace], now: float) -> None:
        """Takes a portrait if the image shows exactly one face, and if it is found in the portrait.

        Args:
            image: (height, width, 3) BGR, uint8.
            faces: All faces in the image, also the predicted ones.
            now: The time in s of any clock that never goes back.
        """
        if self._done.is_set() or now - self._taken < PERIOD:
            return
        if any(not face.predicted for face in faces):
            self._seen = now
        if not faces and now - self._seen > MAX_ABSENCE:
            self.begin_anew("were taken before the face was gone")
        if len(faces) != 1:
            # Nobody can tell whose face is meant, and a wrong portrait spoils a gallery.
            self._refused["showed several faces" if faces else "showed no face"] += 1
            return
        (face,) = faces
        try:
            if face.predicted:
                raise ValueError("it is not seen")
            taken = portrait(image, face.box)
            face_of(taken)
        except ValueError:
            self._refused["showed no clear face"] += 1
            return
        if face.id != self._id:
            self.begin_anew()
        self._id = face.id
        self._taken = now
        self.portraits[f"image {len(self.portraits) + 1}"] = taken
        if len(self.portraits) == self._count:
            self._done.set()

    def begin_anew(self, reason: str = "showed another face") -> None:
        """Forgets the portraits, unless all are there: a face may be another one from now on."""
        if self.portraits and not self._done.is_set():
            self._refused[reason] += len(self.portraits)
            self.portraits.clear()

    def wait(self, seconds: float, given_up: Callable[[], Any]) -> bool:
        """Returns whether all portraits were taken within `seconds` of the wall clock."""
        deadline = time.monotonic() + seconds
        while not self._done.wait(POLL) and time.monotonic() < deadline and not given_up():
            pass
        return self._done.is_set()

    def outcome(self) -> str:
        """Returns how many portraits were taken, and why other images were refused."""
        reasons = "".join(f"; {count} {reason}" for reason, count in sorted(self._refused.items()))
        return f"took {len(self.portraits)} of {self._count} images{reasons or '; saw no others'}"
