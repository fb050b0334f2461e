"""Picture files, decoded."""

from typing import Optional

import cv2
import numpy as np

from .._core import decode_image_file


def sensor_pixels(data: bytes, flags: int = cv2.IMREAD_COLOR) -> Optional[np.ndarray]:
    """As the lens has thrown them on the sensor, whatever side of the camera was up.

    This is what a calibration is of: a lens has no up and down.

    Args:
        data: the file.
        flags: cv2.IMREAD_...; by default (height, width, 3) uint8, BGR.

    Returns:
        None if it is no picture, or damaged.

    Raises:
        ValueError: it claims to be larger than any picture that there is memory for.
    """
    return decode_image_file(data, flags | cv2.IMREAD_IGNORE_ORIENTATION)


def upright(data: bytes) -> Optional[np.ndarray]:
    """The same, (height, width, 3) uint8, BGR, turned by EXIF as viewers show it."""
    return decode_image_file(data, cv2.IMREAD_COLOR)
