"""Images of a person that may be added to a gallery, because they show a face."""

import hashlib
from typing import Any, Callable, Dict, List, Mapping

import cv2
import numpy as np

from ..common.files import read_file, reason
from ..common.image_files import upright
from .face_images import face_of, portrait
from .gallery_files import MAX_FILE, image_paths, shown


class Candidates:
    """Images in the form in which they are stored, with their faces. No lock is held meanwhile."""

    def __init__(self) -> None:
        self.files: Dict[str, bytes] = {}  # PNG files by digest
        self.faces: Dict[str, np.ndarray] = {}  # normalized faces by digest
        self.repeated = 0
        self.problems: List[str] = []  # what was refused, and the reason

    def offer(self, images: Mapping[str, np.ndarray]) -> None:
        """Takes images, BGR, by the names under which problems report them."""
        for source, image in images.items():
            try:
                self._take(image)
            except ValueError as error:
                self.problems.append(f"{source}: {error}")

    def read(self, folder: str, given_up: Callable[[], Any]) -> None:
        """Takes a portrait of the largest face in each image file of a folder.

        Args:
            folder: The folder.
            given_up: A function that is asked before each image whether to stop.

        Raises:
            InterruptedError: `given_up` returned a true value.
            OSError: The folder cannot be read.
        """
        for path in image_paths(folder):
            if given_up():
                raise InterruptedError(f"given up at {shown(path)}")
            try:
                self._take(portrait(upright(read_file(path, MAX_FILE))))
            except (OSError, ValueError) as error:
                self.problems.append(f"{shown(path)}: {reason(error)}")

    def _take(self, image: np.ndarray) -> None:
        png = cv2.imencode(".png", image)[1].tobytes()
        digest = digest_of(png)
        if digest in self.faces:
            self.repeated += 1
            return
        self.faces[digest] = face_of(image)
        self.files[digest] = png


def digest_of(data: bytes) -> str:
    """Returns what identifies the content of an image file, whatever its name is."""
    return hashlib.sha256(data).hexdigest()
