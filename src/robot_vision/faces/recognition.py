"""Recognition of faces."""

import math
from typing import Sequence, Tuple

import cv2
import numpy as np

NOBODY = -1


class LbphRecognizer:
    """Recognition by histograms of local binary patterns (Ahonen et al. 2004), from OpenCV.

    Training takes milliseconds per face. The results are good as long as light, expression and
    camera are like those of the training. Training is not thread-safe.

    Raises:
        ValueError: This OpenCV was built without the module face.
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
        """Forgets everything, and learns these faces.

        Args:
            faces: Faces from face_images.normalized(); may be empty.
            labels: The label of the person in each face, 0 or more.
        """
        self._trained = len(faces) > 0
        if self._trained:
            self._model.train(list(faces), np.array(labels, np.int32))

    def predict(self, face: np.ndarray) -> Tuple[int, float]:
        """Returns the label of the most similar person, and the distance.

        The distance is 0 for a face of the training and grows with the difference. Without
        training it returns NOBODY and infinity.
        """
        if not self._trained:
            return NOBODY, math.inf
        label, distance = self._model.predict(face)
        return label, distance
