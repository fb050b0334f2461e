"""Image files: their names, and their decoding."""

import os
from typing import Callable, TypeVar

import numpy as np

from .._core import decode_image_file
from .errors import about
from .files import MAX_IMAGE, read_file, reason
from .plain_text import brief, printable

Decoded = TypeVar("Decoded")

IMREAD_COLOR, IMREAD_IGNORE_ORIENTATION = 1, 128  # cv2's, whose import takes 37 MB
SUFFIXES = (".bmp", ".jpeg", ".jpg", ".pgm", ".png", ".ppm", ".tif", ".tiff", ".webp")


def has_image_suffix(path: str) -> bool:
    """Returns whether a file is named like an image."""
    return path.lower().endswith(SUFFIXES)


def name_of(path: str) -> str:
    """Returns the name of a file without its ending: portrait of /tmp/portrait.png."""
    name = os.fsencode(os.path.splitext(os.path.basename(path))[0])
    return printable(name.decode(errors="replace"))


def sensor_pixels(data: bytes, flags: int = IMREAD_COLOR) -> np.ndarray:
    """Decodes an image as the sensor saw it, without the rotation that its EXIF data asks for.

    A calibration needs these pixels, because the lens does not turn with the camera.

    Args:
        data: The content of the file.
        flags: cv2.IMREAD_...; the default gives (height, width, 3) uint8, BGR.

    Raises:
        ValueError: The file is damaged, not an image, or claims to be larger than any image that
            fits into the memory.
    """
    return decode_image_file(data, flags | IMREAD_IGNORE_ORIENTATION)


def upright(data: bytes) -> np.ndarray:
    """Decodes an image like sensor_pixels() to BGR, but rotated by EXIF, as viewers show it."""
    return decode_image_file(data, IMREAD_COLOR)


def load_image(path: str, decode: Callable[[bytes], np.ndarray]) -> np.ndarray:
    """Returns the image in a file.

    Args:
        path: The path of the file.
        decode: sensor_pixels() or upright().

    Raises:
        ValueError: The file is not an image, or it is too large to be decoded.
        OSError: The path is not a regular file, or the file is too large or cannot be read.
    """
    data = read_file(path, MAX_IMAGE)
    with about(path):
        return decode(data)


def load_parameter(parameter: str, path: str, decode: Callable[[bytes], Decoded]) -> Decoded:
    """Returns what is in the image file that a parameter names.

    Args:
        parameter: The name of the parameter.
        path: Its value. It must be absolute, as roslaunch and a node resolve others in different
            folders.
        decode: upright(), or another function of the content of the file.

    Raises:
        ValueError: The path is not absolute, or not that of an image that can be read.
    """
    given = f"{parameter} is {brief(path)}, must be the absolute path of an image file"
    if not os.path.isabs(path):
        raise ValueError(given)
    try:
        return decode(read_file(path, MAX_IMAGE))
    except (OSError, ValueError) as error:
        raise ValueError(f"{given}: {printable(reason(error), 200)}") from None
