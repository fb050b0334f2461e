"""Whose face it is."""

import abc
import math
from typing import Sequence, Tuple

import cv2
import numpy as np

NOBODY = -1


class Recognizer(abc.ABC):
    """Tells faces apart that it has been trained with. Not thread-safe while it is trained."""

    @abc.abstractmethod
    def train(self, faces: Sequence[np.ndarray], labels: Sequence[int]) -> None:
        """Forgets all it knew, and learns these faces.

        Args:
            faces: as face_picture.normalized() makes them; may be empty.
            labels: whose face each is, 0 or more.
        """

    @abc.abstractmethod
    def predict(self, face: np.ndarray) -> Tuple[int, float]:
        """Who looks most like this face: (label, distance).

        The distance is 0 for one of the faces learnt and grows as they differ; its scale is the
        recogniser's. NOBODY at an infinite distance if it has been trained with no face.
        """


class LbphRecognizer(Recognizer):
    """Histograms of local binary patterns (Ahonen et al. 2004), by OpenCV.

    It is trained within milliseconds a face, and as sure as the light, the look and the camera
    are those of the pictures it was trained with.

    Raises:
        ValueError: this OpenCV has been built without it.
    """

    def __init__(self) -> None:
        if not hasattr(cv2, "face"):
            raise ValueError(
                f"the OpenCV in {cv2.__file__} has no module face; that of the package "
                "python3-opencv has, and pip's opencv-contrib-python, but not its opencv-python"
            )
        self._model = cv2.face.LBPHFaceRecognizer_create(radius=2, neighbors=8, grid_x=8, grid_y=8)
        self._trained = False

    def train(self, faces: Sequence[np.ndarray], labels: Sequence[int]) -> None:
        self._trained = len(faces) > 0
        if self._trained:
            self._model.train(list(faces), np.array(labels, np.int32))

    def predict(self, face: np.ndarray) -> Tuple[int, float]:
        if not self._trained:
            return NOBODY, math.inf
        label, distance = self._model.predict(face)
        return label, distance
