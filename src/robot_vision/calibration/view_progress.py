"""How far the views of a board are from being enough for a calibration."""

from typing import Dict, Sequence, Tuple

import numpy as np

from .boards import Observation
from .views import describe

# Of each measure of a view the range that counts as enough, as in camera_calibration.
ENOUGH = {"x": 0.7, "y": 0.7, "size": 0.4, "skew": 0.5}
MANY_VIEWS = 40  # enough, whatever their range is, as in camera_calibration


def view_progress(observations: Sequence[Observation], size: Tuple[int, int]) -> Dict[str, float]:
    """Returns for x, y, size and skew how much of the range that is enough was shown: 0 to 1.

    Across the image, and along it, the board should have been at places far from each other; it
    should have been near once, and tilted once.

    Args:
        observations: The views.
        size: The width and height of the images in px.
    """
    if not observations:
        return dict.fromkeys(ENOUGH, 0.0)
    shown = np.array([describe(one, size)[: len(ENOUGH)] for one in observations])
    low, high = shown.min(axis=0), shown.max(axis=0)
    low[2:] = 0.0  # Far away or upright is no merit.
    shares = np.minimum((high - low) / list(ENOUGH.values()), 1.0)
    return {name: float(share) for name, share in zip(ENOUGH, shares)}


def is_enough(progress: Dict[str, float], views: int) -> bool:
    """Whether no more views are needed, as camera_calibration has it."""
    return views >= MANY_VIEWS or min(progress.values()) >= 1.0
