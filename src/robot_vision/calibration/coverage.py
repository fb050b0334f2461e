"""A diagram that shows where in the image the board was seen during a calibration."""

from typing import Sequence, Tuple

import numpy as np

from ..common import opencv as cv2
from ..common.drawing import FRACTION_BITS, fixed_point
from .boards import Observation

CELLS = (10, 8)  # across and down
UNSEEN = (205, 205, 250)  # BGR, cells without a point of the board
GOOD, BAD = np.array([60, 160, 0]), np.array([0, 0, 230])  # BGR, views with small and large errors


def seen_cells(observations: Sequence[Observation], size: Tuple[int, int]) -> np.ndarray:
    """Returns which cells of images of `size` (width, height) px had a point in them: (8, 10)."""
    seen = np.zeros(CELLS[::-1], bool)
    for observation in observations:
        column, row = (observation.pixels / size * CELLS).astype(int).T
        inside = (column >= 0) & (column < CELLS[0]) & (row >= 0) & (row < CELLS[1])
        seen[row[inside], column[inside]] = True
    return seen


def coverage_image(
    observations: Sequence[Observation], errors: np.ndarray, size: Tuple[int, int]
) -> np.ndarray:
    """Draws the points and the hull of each view: (height, width, 3) uint8, BGR.

    Args:
        observations: The views of the board.
        errors: The errors of the views in px. Typical ones are green, those twice as large red.
        size: The width and height of the camera's images in px.
    """
    cells = np.where(seen_cells(observations, size)[:, :, None], 255, UNSEEN).astype(np.uint8)
    image = cv2.resize(cells, size, interpolation=cv2.INTER_NEAREST)
    badness = np.clip(errors / max(np.median(errors), 1e-9) - 1.0, 0.0, 1.0)
    radius = max(size) / 320.0
    for observation, bad in zip(observations, badness):
        color = (GOOD + bad * (BAD - GOOD)).tolist()
        fixed = fixed_point(observation.pixels)
        hull = cv2.convexHull(fixed)
        cv2.polylines(image, [hull], True, color, 1, cv2.LINE_AA, FRACTION_BITS)
        for x, y in fixed.tolist():
            size_of_dot = round(radius * 2**FRACTION_BITS)
            cv2.circle(image, (x, y), size_of_dot, color, -1, cv2.LINE_AA, FRACTION_BITS)
    return image
