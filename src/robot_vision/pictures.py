"""Picture files, decoded."""

import contextlib
from typing import Optional

import cv2
import numpy as np


def sensor_pixels(data: bytes, flags: int = cv2.IMREAD_COLOR) -> Optional[np.ndarray]:
    """As the lens has thrown them on the sensor, whatever side of the camera was up.

    This is what a calibration is of: a lens has no up and down.

    Args:
        data: the file.
        flags: cv2.IMREAD_...; by default (height, width, 3) uint8, BGR.

    Returns:
        None if it is no picture, or damaged.
    """
    return _decode(data, flags | cv2.IMREAD_IGNORE_ORIENTATION)


def upright(data: bytes) -> Optional[np.ndarray]:
    """The same, (height, width, 3) uint8, BGR, turned by EXIF as viewers show it."""
    return _decode(data, cv2.IMREAD_COLOR)


def _decode(data: bytes, flags: int) -> Optional[np.ndarray]:
    with contextlib.suppress(cv2.error):  # of no data, and of more pixels than OpenCV takes
        return cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    return None
