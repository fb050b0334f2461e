"""Conversion of recorded images to gray images as the sensor saw them."""

import re
from typing import Any

import numpy as np
from sensor_msgs.msg import Image

from .. import to_gray
from ..common import opencv as cv2
from ..common.image_files import sensor_pixels
from ..common.plain_text import printable
from .image_pixels import pixels_of

NAMED_BY_TYPE = {"8UC1": "mono8", "8UC3": "bgr8", "16UC1": "mono16"}  # meant by users of OpenCV


def gray_pixels(image: np.ndarray, encoding: str) -> np.ndarray:
    """Converts an image to gray, (height, width) uint8.

    Images of 16 bits are stretched to the full range, because many cameras use only a part of it.

    Raises:
        ValueError: The image does not fit the encoding, or the encoding has no gray levels.
    """
    if image.dtype not in (np.uint8, np.uint16):
        raise ValueError(f"{printable(encoding)} has no gray levels of 8 or 16 bits")
    encoding = NAMED_BY_TYPE.get(encoding, encoding)
    if image.dtype == np.uint16 and image.size:
        image = cv2.normalize(image, None, 0, 65535, cv2.NORM_MINMAX)
    return to_gray(image, encoding)


def gray_file(data: bytes, label: str = "") -> np.ndarray:
    """Converts an image file to gray, (height, width) uint8, without the rotation by EXIF.

    Args:
        data: The content of the file.
        label: The format field of a sensor_msgs/CompressedImage, which may name a Bayer pattern.

    Raises:
        ValueError: The file is not an image.
    """
    if "compressedDepth" in label:
        raise ValueError("it has depths (compressedDepth)")
    image = sensor_pixels(data, cv2.IMREAD_GRAYSCALE | cv2.IMREAD_ANYDEPTH)
    bayer = re.match("bayer_[rgb]{4}", label)
    layout = bayer[0] if bayer else "mono"
    return gray_pixels(image, f"{layout}{8 * image.itemsize}")


def gray_message(message: Any) -> np.ndarray:
    """Converts a sensor_msgs/Image or CompressedImage to gray, (height, width) uint8.

    Raises:
        ValueError: The message has no pixels that can be used.
    """
    if message._type != Image._type:
        return gray_file(message.data, message.format)
    return gray_pixels(pixels_of(message), message.encoding)
