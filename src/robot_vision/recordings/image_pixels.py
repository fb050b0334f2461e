"""The pixels of recorded messages."""

from typing import Any, Tuple

import numpy as np

from ..common.plain_text import printable


def pixels_of(message: Any) -> np.ndarray:
    """Returns a copy of the pixels of a sensor_msgs/Image, in the byte order of this machine.

    Returns:
        (height, width) array, or (height, width, channels) if there are several.

    Raises:
        ValueError: The encoding is not known, or the data is not of its size.
    """
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
    return rows[:, :row].copy().view(dtype).reshape(shape).astype(sample_type)


def _sample_layout(encoding: str) -> Tuple[str, int]:
    """Returns the type of the samples, and their number per pixel."""
    import cv_bridge  # It imports OpenCV's Python module, which few nodes need: see opencv.py.

    if encoding == "yuv422_yuy2":  # cv_bridge for Python knows only the same layout as yuv422.
        encoding = "yuv422"
    try:
        return cv_bridge.CvBridge().encoding_to_dtype_with_channels(encoding)
    except cv_bridge.CvBridgeError as error:
        raise ValueError(printable(str(error), 300)) from None
