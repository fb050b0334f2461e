"""Chooses the images of a board that tell something new about the camera."""

from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from ..common import opencv as cv2
from .boards import Board, Observation

MIN_DIFFERENCE = 0.2  # sum over a description, between different views; as in camera_calibration


class View(NamedTuple):
    """An image that is used: its name, and the board in it."""

    name: str
    observation: Observation


class ViewCollection:
    """Keeps sharp images that show the board at new places, in new sizes and with new tilts.

    Args:
        board: The board to look for.
        most: The largest number of images that are kept.
        max_blur: The largest width in px of an edge in an image that counts as sharp.
    """

    def __init__(self, board: Board, most: int, max_blur: float):
        self._board = board
        self._most = most
        self._max_blur = max_blur
        self._descriptions = np.empty((0, 6))
        self.size: Optional[Tuple[int, int]] = None  # px, of the images, once one shows the board
        self.views: List[View] = []
        self.offered = self.unusable = self.without_board = self.blurred = self.alike = 0

    @property
    def full(self) -> bool:
        """Whether no more images are kept."""
        return len(self.views) == self._most

    def offer(self, name: str, gray: np.ndarray) -> Optional[Observation]:
        """Examines an image, (height, width) uint8, and keeps it if it is of use.

        Returns:
            The board if the image shows it sharply, whether it is kept or not.

        Raises:
            ValueError: The image differs in size from those with the board before.
        """
        size = gray.shape[1], gray.shape[0]
        if self.size and size != self.size:
            raise ValueError(
                f"it has {size[0]}x{size[1]}, the images before {self.size[0]}x{self.size[1]}"
            )
        self.offered += 1
        observation = self._board.find(gray)
        if observation is None or not cv2.isContourConvex(outline(observation).astype(np.float32)):
            self.without_board += 1
            return None
        self.size = size
        if edge_width(gray, observation.pixels) > self._max_blur:
            self.blurred += 1
            return None
        self._keep_new(View(name, observation))
        return observation

    def skip(self) -> None:
        """Counts an image that cannot be examined."""
        self.offered += 1
        self.unusable += 1

    def summary(self) -> str:
        """Returns how many images were used, and why others were not, as a line of text."""
        unusable = f", {self.unusable} unusable" if self.unusable else ""
        return (
            f"{self.offered} images: {len(self.views)} used, {self.without_board} without the "
            f"board, {self.blurred} blurred, {self.alike} like others{unusable}"
        )

    def _keep_new(self, view: View) -> None:
        description = describe(view.observation, self.size)
        differences = np.abs(self._descriptions - description).sum(axis=1)
        if self.full or (differences < MIN_DIFFERENCE).any():
            self.alike += 1
            return
        self.views.append(view)
        self._descriptions = np.vstack([self._descriptions, description])


def outline(observation: Observation) -> np.ndarray:
    """Returns the corners of the rectangle around the points as a homography maps them: (4, 2) px.

    They start at the board's top left corner and go clockwise. If the points are mixed up, they
    do not form a convex shape.
    """
    flat = observation.points[:, :2]
    to_image, _ = cv2.findHomography(flat, observation.pixels)
    if to_image is None:
        return np.zeros((4, 2))
    (left, top), (right, bottom) = flat.min(axis=0), flat.max(axis=0)
    corners = np.array([[[left, top], [right, top], [right, bottom], [left, bottom]]])
    return cv2.perspectiveTransform(corners, to_image)[0]


def describe(observation: Observation, size: Tuple[int, int]) -> np.ndarray:
    """Returns position (x, y), size, skew and lean (2) of the board: (6,), each about 0 to 1.

    Position, size and skew are defined as in camera_calibration. The lean distinguishes tilts to
    opposite sides.
    """
    quad = outline(observation)
    edges = np.roll(quad, -1, axis=0) - quad
    lengths = np.linalg.norm(edges, axis=1)
    area = cv2.contourArea(quad.astype(np.float32))
    side = np.sqrt(area)
    room = np.maximum(np.array(size) - side, 1.0)
    place = np.clip((observation.pixels.mean(axis=0) - side / 2.0) / room, 0.0, 1.0)
    cosine = edges[0] @ edges[1] / (lengths[0] * lengths[1])
    skew = min(1.0, 2.0 * abs(np.arcsin(np.clip(cosine, -1.0, 1.0))))
    lean = (lengths[:2] - lengths[2:]) / (lengths[:2] + lengths[2:])
    return np.array([*place, side / np.sqrt(size[0] * size[1]), skew, *lean])


def edge_width(gray: np.ndarray, pixels: np.ndarray) -> float:
    """Returns the width in px of the board's edges, in the direction in which they are widest.

    It is about 2 to 3 in a sharp image. All directions have to be examined, because an image that
    is blurred by motion still has sharp edges along the motion.
    """
    x, y, width, height = cv2.boundingRect(pixels.astype(np.float32))
    part = gray[max(y, 0) : y + height, max(x, 0) : x + width].astype(np.float32)
    dark, bright = np.percentile(part, (5, 95))
    per_pixel = 1.0 / 8.0  # makes a gradient per px of Sobel's weighted sums
    across, down = (
        cv2.Sobel(part, cv2.CV_32F, *axis, scale=per_pixel) for axis in ((1, 0), (0, 1))
    )
    angles = np.linspace(0.0, np.pi, 4, endpoint=False)
    steepest = min(np.percentile(np.abs(np.cos(a) * across + np.sin(a) * down), 99) for a in angles)
    return (bright - dark) / max(steepest, 1e-6)
