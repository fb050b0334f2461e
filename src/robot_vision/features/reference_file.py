"""The image file that features are looked for of."""

import os
from typing import Optional, Tuple

import numpy as np

from ..common.image_files import load_image, upright
from ..common.plain_text import brief, printable


def load_reference(path: str) -> np.ndarray:
    """Returns the image in a file, (height, width, 3) BGR, turned as viewers show it.

    Raises:
        ValueError: The path is not absolute, or not that of an image that can be read.
    """
    # roslaunch and a node resolve a relative path in different folders.
    if not os.path.isabs(path):
        raise ValueError(f"reference is {brief(path)}, must be the absolute path of an image file")
    try:
        return load_image(path, upright)
    except (OSError, ValueError) as error:
        raise ValueError(f"reference: {printable(str(error), 300)}") from None


class ReferenceFile:
    """Reads a file once, and again only if the path is another one."""

    def __init__(self) -> None:
        self._loaded: Optional[Tuple[str, np.ndarray]] = None

    def image(self, path: str) -> np.ndarray:
        """Returns what load_reference() does."""
        if self._loaded is None or path != self._loaded[0]:
            self._loaded = path, load_reference(path)
        return self._loaded[1]
