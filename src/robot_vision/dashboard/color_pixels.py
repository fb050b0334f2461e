"""The colours of a few pixels of a frame, whatever its encoding."""

from typing import Any, Tuple

import numpy as np

from .. import encodings, to_bgr
from ..common.plain_text import printable

RADIUS = 2  # px from the middle of the window whose colours count to its sides
BORDER = 4  # px more on each side, for what is interpolated between pixels; even


# Encodings without names for their channels, as what they usually are.
ALIASES = {"8UC1": "mono8", "8UC3": "bgr8", "8UC4": "bgra8"}
# Only cameras have these, whose pixels do not lie side by side; no message has them.
OF_DEVICES = {"mono10", "nv12", "nv21", "yu12", "jpeg"}
ENCODINGS = {*encodings(), *ALIASES} - OF_DEVICES


def require_inside(image: np.ndarray, x: int, y: int) -> None:
    """Raises ValueError for a pixel that is not in an image."""
    height, width = image.shape[:2]
    if not (0 <= x < width and 0 <= y < height):
        raise ValueError(f"x {x}, y {y}: not inside of the image of {width}x{height}")


def bgr_around(frame: Any, x: int, y: int, radius: int = RADIUS) -> np.ndarray:
    """Returns the pixels around one, (2 radius + 1, 2 radius + 1, 3) uint8 BGR, less at a border.

    Args:
        frame: A transport.Frame.
        x: px from the left.
        y: px from the top.
        radius: How many pixels to each side, in px.

    Raises:
        ValueError: The pixel is not in the image, or its encoding has no colours that are known.
    """
    image = frame.image
    require_inside(image, x, y)
    if frame.encoding not in ENCODINGS:
        raise ValueError(f"images of {printable(frame.encoding)} have no colours that can be told")
    (top, bottom, first), (left, right, second) = (
        _span(place, radius, size) for place, size in zip((y, x), image.shape[:2])
    )
    part = to_bgr(
        np.ascontiguousarray(image[top:bottom, left:right]),
        ALIASES.get(frame.encoding, frame.encoding),
    )
    rows = slice(max(first - radius, 0), first + radius + 1)
    columns = slice(max(second - radius, 0), second + radius + 1)
    return part[rows, columns]


def _span(place: int, radius: int, size: int) -> Tuple[int, int, int]:
    """Returns begin and end of the pixels to convert, and where `place` is from the begin.

    Begin and end are even, as the pixels of some encodings belong together by twos.
    """
    begin = max((place - radius - BORDER) // 2 * 2, 0)
    end = min((place + radius + BORDER + 2) // 2 * 2, size)
    return begin, end, place - begin
