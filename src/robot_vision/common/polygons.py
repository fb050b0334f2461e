"""Polygons in the plane, as (n, 2) arrays of their corners."""

from typing import Sequence, Tuple

import numpy as np


def area_of(polygon: np.ndarray) -> float:
    """Returns the area of a polygon that does not cross itself; 0 without corners."""
    x, y = np.asarray(polygon, float).reshape(-1, 2).T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0


def is_inside(polygon: np.ndarray, point: Tuple[float, float]) -> bool:
    """Returns whether a point is inside of a polygon or on its edge."""
    begins = np.asarray(polygon, float).reshape(-1, 2) - point
    ends = np.roll(begins, -1, axis=0)
    turns = begins[:, 0] * ends[:, 1] - begins[:, 1] * ends[:, 0]
    if np.any(
        (turns == 0.0)
        & np.all(np.minimum(begins, ends) <= 0.0, axis=1)
        & np.all(np.maximum(begins, ends) >= 0.0, axis=1)
    ):
        return True
    # A ray to the right crosses the edges an odd number of times.
    crosses = (begins[:, 1] > 0.0) != (ends[:, 1] > 0.0)
    right = (turns > 0.0) == (ends[:, 1] > begins[:, 1])
    return bool(np.count_nonzero(crosses & right) % 2)


def box_corners(box: Sequence[int]) -> np.ndarray:
    """Returns the corners, (4, 2), of a box (x, y, width, height)."""
    x, y, width, height = box
    return np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)], float)
