"""The image file that features are looked for of."""

from typing import Optional, Tuple

import numpy as np

from ..common.image_files import load_parameter, upright


class ReferenceFile:
    """Reads a file once, and again only if the path is another one."""

    def __init__(self) -> None:
        self._loaded: Optional[Tuple[str, np.ndarray]] = None

    def image(self, path: str) -> np.ndarray:
        """Returns the image in a file, (height, width, 3) BGR, turned as viewers show it.

        Raises:
            ValueError: The path is not absolute, or not that of an image that can be read.
        """
        if self._loaded is None or path != self._loaded[0]:
            self._loaded = path, load_parameter("reference", path, upright)
        return self._loaded[1]
