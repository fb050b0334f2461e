"""Colours in OpenCV's 8-bit HSV: hue 0 to 179 in half degrees, saturation and value 0 to 255."""

from typing import Tuple

import cv2
import numpy as np

from .._core import HsvRange

HUES = 180


def median_hsv(bgr_region: np.ndarray) -> Tuple[int, int, int]:
    """Returns the median colour of a part of an image.

    Args:
        bgr_region: (height, width, 3) uint8, BGR.

    Returns:
        The hue, and the medians of saturation and value, rounded down. The median hue is the hue
        in the region with the least sum of distances to all others on the colour circle. Pixels
        without saturation have no hue; if there are no others, the hue is 0.

    Raises:
        ValueError: The region is empty.
    """
    if bgr_region.size == 0:
        raise ValueError("the region is empty")
    hsv = cv2.cvtColor(np.ascontiguousarray(bgr_region), cv2.COLOR_BGR2HSV).reshape(-1, 3)
    _, saturation, value = np.median(hsv, axis=0).astype(int)
    return _median_hue(hsv[hsv[:, 1] > 0, 0]), int(saturation), int(value)


def _median_hue(hues: np.ndarray) -> int:
    counts = np.bincount(hues, minlength=HUES)
    apart = np.abs(np.subtract.outer(np.arange(HUES), np.arange(HUES)))
    costs = np.minimum(apart, HUES - apart) @ counts
    return int(np.argmin(np.where(counts > 0, costs, np.inf))) if hues.size else 0


def outside(hsv: Tuple[int, int, int], colors: HsvRange) -> str:
    """Returns why a picked colour does not fit its own range: it is too gray or dark; or ""."""
    _, saturation, value = hsv
    channels = ("saturation", saturation, colors.s_low), ("value", value, colors.v_low)
    limits = [
        f"{name} {seen} is below {lowest}" for name, seen, lowest in channels if seen < lowest
    ]
    return f"the range does not hold this colour: {', '.join(limits)}" if limits else ""


def as_yaml(colors: HsvRange) -> str:
    """Returns the range as one line of hsv_tracker's parameter file."""
    return f"{{low: {list(colors.low)}, high: {list(colors.high)}}}"
