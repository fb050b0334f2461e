"""The file that shows the shape with which contours are compared."""

import os
from typing import Optional

import numpy as np

from ..common.files import MAX_IMAGE, read_file, reason
from ..common.image_files import upright
from ..common.plain_text import brief, printable


def load_template(path: str) -> Optional[np.ndarray]:
    """Returns the image in a file, (height, width, 3) BGR, or None if the path is empty.

    Raises:
        ValueError: The path is not absolute, or there is no image that can be read.
    """
    if not path:
        return None
    given = f"template_file is {brief(path)}, must be"
    # The node's folder is another one than that of the terminal in which the path was typed.
    if not os.path.isabs(path):
        raise ValueError(f"{given} an absolute path")
    try:
        return upright(read_file(path, MAX_IMAGE))
    except (OSError, ValueError) as error:
        says = printable(reason(error), 200)
        raise ValueError(f"{given} the path of an image: {says}") from None
