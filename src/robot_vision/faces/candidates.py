"""Pictures of a person that may be added to a gallery: those that show a face."""

import hashlib
from typing import Any, Callable, Dict, List, Mapping

import cv2
import numpy as np

from ..common.files import reason
from .face_picture import face_of, portrait
from .gallery_files import decode, picture_files, read_picture, shown


class Candidates:
    """Pictures as they are to be kept, with their faces; takes time, but no gallery's lock."""

    def __init__(self) -> None:
        self.files: Dict[str, bytes] = {}  # PNG, by digest
        self.faces: Dict[str, np.ndarray] = {}  # by digest
        self.repeated = 0
        self.problems: List[str] = []  # what was refused, and why

    def offer(self, pictures: Mapping[str, np.ndarray]) -> None:
        """Takes pictures, BGR, by what a problem shall call them."""
        for source, picture in pictures.items():
            try:
                self._take(picture)
            except ValueError as error:
                self.problems.append(f"{source}: {error}")

    def read(self, folder: str, given_up: Callable[[], Any]) -> None:
        """Takes the largest face of each picture file, cut out with something around it.

        Raises:
            InterruptedError: it was given up, which is asked between two pictures.
            OSError: the folder cannot be read.
        """
        for path in picture_files(folder):
            if given_up():
                raise InterruptedError(f"given up at {shown(path)}")
            try:
                self._take(portrait(decode(read_picture(path))))
            except (OSError, ValueError) as error:
                self.problems.append(f"{shown(path)}: {reason(error)}")

    def _take(self, picture: np.ndarray) -> None:
        png = cv2.imencode(".png", picture)[1].tobytes()
        digest = digest_of(png)
        if digest in self.faces:
            self.repeated += 1
            return
        self.faces[digest] = face_of(picture)
        self.files[digest] = png


def digest_of(data: bytes) -> str:
    """What a picture file is known by, whatever its name."""
    return hashlib.sha256(data).hexdigest()
