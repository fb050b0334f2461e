"""Grey pictures, as the sensor saw them, of whatever was recorded."""

import re
from typing import Any, Tuple

import cv2
import cv_bridge
import numpy as np
from sensor_msgs.msg import Image

from .. import to_gray
from ..common.pictures import sensor_pixels
from ..common.plain_text import printable

NAMED_BY_TYPE = {"8UC1": "mono8", "8UC3": "bgr8", "16UC1": "mono16"}  # as OpenCV's users send them


def gray_pixels(picture: np.ndarray, encoding: str) -> np.ndarray:
    """(height, width) uint8 of a picture; 16 bits are stretched, for many cameras use fewer.

    Raises:
        ValueError: it is none of this encoding, or nobody knows what is grey in that.
    """
    if picture.dtype not in (np.uint8, np.uint16):
        raise ValueError(f"{printable(encoding)} has no grey levels of 8 or 16 bits")
    encoding = NAMED_BY_TYPE.get(encoding, encoding)
    if picture.dtype == np.uint16 and picture.size:
        picture = cv2.normalize(picture, None, 0, 65535, cv2.NORM_MINMAX)
    return to_gray(picture, encoding)


def gray_file(data: bytes, label: str = "") -> np.ndarray:
    """The same of a picture file, never turned by its EXIF.

    Args:
        label: the format of a sensor_msgs/CompressedImage, which may be a Bayer pattern's.

    Raises:
        ValueError: it is no picture.
    """
    if "compressedDepth" in label:
        raise ValueError("it has depths (compressedDepth)")
    picture = sensor_pixels(data, cv2.IMREAD_GRAYSCALE | cv2.IMREAD_ANYDEPTH)
    if picture is None:
        raise ValueError("no picture that OpenCV can read")
    bayer = re.match("bayer_[rgb]{4}", label)
    layout = bayer[0] if bayer else "mono"
    return gray_pixels(picture, f"{layout}{8 * picture.itemsize}")


def gray_message(message: Any) -> np.ndarray:
    """The same of a sensor_msgs/Image or sensor_msgs/CompressedImage.

    Raises:
        ValueError: it has no pixels that can be used.
    """
    if message._type != Image._type:
        return gray_file(message.data, message.format)
    kind, channels = _layout(message.encoding)
    # cv_bridge itself may take the bytes between two rows for pixels.
    dtype = np.dtype(kind).newbyteorder(">" if message.is_bigendian else "<")
    row = message.width * channels * dtype.itemsize
    if message.step < row or len(message.data) != message.height * message.step:
        raise ValueError(
            f"{printable(message.encoding)} of {message.width}x{message.height} with "
            f"{message.step} bytes to a row, and {len(message.data)} in all"
        )
    rows = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
    shape = (message.height, message.width) + ((channels,) if channels > 1 else ())
    pixels = rows[:, :row].copy().view(dtype).reshape(shape)
    return gray_pixels(pixels.astype(kind), message.encoding)


def _layout(encoding: str) -> Tuple[str, int]:
    """The type of the samples, and how many a pixel has."""
    if encoding == "yuv422_yuy2":  # cv_bridge for Python knows only its twin
        encoding = "yuv422"
    try:
        return cv_bridge.CvBridge().encoding_to_dtype_with_channels(encoding)
    except cv_bridge.CvBridgeError as error:
        raise ValueError(printable(str(error), 300)) from None
