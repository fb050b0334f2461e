"""Conversion of recorded images to gray images as the sensor saw them."""

import re
from typing import Any, Tuple

import cv2
import cv_bridge
import numpy as np
from sensor_msgs.msg import Image

from .. import to_gray
from ..common.image_files import sensor_pixels
from ..common.plain_text import printable

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
    sample_type, channels = _sample_layout(message.encoding)
    # cv_bridge itself may take the padding between two rows for pixels.
    dtype = np.dtype(sample_type).newbyteorder(">" if message.is_bigendian else "<")
    row = message.width * channels * dtype.itemsize
    if message.step < row or len(message.data) != message.height * message.step:
        raise ValueError(
            f"{printable(message.encoding)} of {message.width}x{message.height} with "
            f"{message.step} bytes to a row, and {len(message.data)} in all"
        )
    rows = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
    shape = (message.height, message.width) + ((channels,) if channels > 1 else ())
    pixels = rows[:, :row].copy().view(dtype).reshape(shape)
    return gray_pixels(pixels.astype(sample_type), message.encoding)


def _sample_layout(encoding: str) -> Tuple[str, int]:
    """Returns the type of the samples, and their number per pixel."""
    if encoding == "yuv422_yuy2":  # cv_bridge for Python knows only the same layout as yuv422.
        encoding = "yuv422"
    try:
        return cv_bridge.CvBridge().encoding_to_dtype_with_channels(encoding)
    except cv_bridge.CvBridgeError as error:
        raise ValueError(printable(str(error), 300)) from None
