"""Templates in image files, whose alpha channel says which of their pixels count."""

import os
from functools import partial
from typing import List, NamedTuple, Optional

import numpy as np

from .._core import decode_image_file
from ..common import opencv as cv2
from ..common.image_files import has_image_suffix, load_parameter, name_of, upright
from ..common.plain_text import brief

MAX_FILES = 100
MAX_PIXELS = 2**26  # of all together
WHITE = {np.dtype(np.uint8): 255, np.dtype(np.uint16): 65535}


class Template(NamedTuple):
    """An image that is looked for.

    Attributes:
        name: The name of its file without the ending.
        pixels: (height, width, 3) uint8, BGR.
        mask: (height, width) uint8, 128 and more for the pixels that count; None: all do.
    """

    name: str
    pixels: np.ndarray
    mask: Optional[np.ndarray] = None


def load_templates(text: str) -> List[Template]:
    """Returns the templates in files and folders: absolute paths, separated by commas.

    Raises:
        ValueError: A path is not absolute or not that of an image or a folder with images, or they
            are too many.
    """
    files = [file for path in text.split(",") if path.strip() for file in _files(path.strip())]
    if len(files) > MAX_FILES:
        raise ValueError(f"templates: {len(files)} files, must be at most {MAX_FILES}")
    templates: List[Template] = []
    for path in files:
        templates.append(load_parameter("templates", path, partial(_template, name_of(path))))
        pixels = sum(one.pixels.shape[0] * one.pixels.shape[1] for one in templates)
        if pixels > MAX_PIXELS:
            raise ValueError(
                f"templates: {pixels} pixels up to {brief(path)}, must be at most {MAX_PIXELS}"
            )
    return templates


def _template(name: str, data: bytes) -> Template:
    """Returns the template in the content of a file; raises ValueError if it is no image."""
    image = decode_image_file(data, cv2.IMREAD_UNCHANGED)
    if image.ndim < 3 or image.shape[2] < 4 or image.dtype not in WHITE:
        return Template(name, upright(data))
    image = cv2.convertScaleAbs(image, alpha=255 / WHITE[image.dtype])
    bgr, alpha = np.ascontiguousarray(image[:, :, :3]), np.ascontiguousarray(image[:, :, 3])
    return Template(name, bgr, alpha)


def _files(path: str) -> List[str]:
    """Returns the sorted image files of a folder, or the one file that the path is."""
    if not os.path.isabs(path) or not os.path.isdir(path):
        return [path]
    try:
        names = sorted(os.listdir(path))
    except OSError as error:
        raise ValueError(f"templates: {brief(path)} cannot be read: {error.strerror}") from None
    files = [name for name in names if has_image_suffix(name) and not name.startswith(".")]
    if not files:
        raise ValueError(f"templates: {brief(path)} has no image files")
    return [os.path.join(path, name) for name in files]
