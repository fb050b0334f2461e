"""What was recognized drawn over the image: the meshes as the camera sees them."""

from typing import Sequence

import numpy as np

from .. import draw_outline
from ..common import opencv as cv2
from .found import Found, Look
from .recognition_markers import title

OPACITY = 0.6  # of the meshes
COLORS = ((80.0, 230.0, 60.0), (40.0, 210.0, 250.0), (230.0, 80.0, 220.0), (250.0, 160.0, 40.0))


def draw_objects(bgr: np.ndarray, found: Sequence[Found], looks: Sequence[Look]) -> None:
    """Draws meshes, outlines, and what is known of the objects.

    Args:
        bgr: The image, (height, width, 3) uint8, which is changed.
        found: The objects.
        looks: How each of them looks, with colors.
    """
    before = bgr.copy()
    far_to_near = sorted(range(len(found)), key=lambda number: -found[number].middle[2])
    for number in far_to_near:
        look = looks[number]
        x, y, width, height = look.box
        if not width or look.bgr is None:
            continue
        part = slice(y, y + height), slice(x, x + width)
        mixed = cv2.addWeighted(look.bgr, OPACITY, before[part], 1.0 - OPACITY, 0.0)
        seen = np.isfinite(look.depth)
        bgr[part][seen] = mixed[seen]
        draw_outline(bgr, look.outline, title(found[number]), COLORS[number % len(COLORS)])
