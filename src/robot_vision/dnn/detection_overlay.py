"""What a network found drawn over the image."""

from typing import Sequence, Tuple

import numpy as np

from .. import bgr_of_hsv, draw_dot, draw_outline
from ..common.plain_text import to_ascii
from ..ros.messages import corners
from .detection_messages import CENTER, Seen, pixels_of

MASK_OPACITY = 0.45
KEYPOINT_RADIUS = 3  # px
SURE_KEYPOINT = 0.5  # score from which a keypoint is drawn
FADED = 0.55  # of the brightness of what is only predicted
MAX_PLACE = 1e6  # px: what is farther away is drawn as if it were there
HUE_STEP = 67  # of OpenCV's 180: neighboring classes have colors that are far apart


def class_color(class_id: int) -> Tuple[int, int, int]:
    """Returns the color (BGR) of a class, always the same."""
    return bgr_of_hsv((class_id * HUE_STEP % 180, 200, 255))


def draw_seen(bgr: np.ndarray, seen: Sequence[Seen]) -> None:
    """Draws boxes with id, name and score, masks and keypoints; what is only predicted is darker.

    Args:
        bgr: The image, (height, width, 3) uint8, which is changed.
        seen: What there is in it; the first one is drawn last.
    """
    for one in reversed(seen):
        color = class_color(one.class_id)
        if one.found is None:
            color = tuple(int(FADED * part) for part in color)
        elif one.found.mask.size:
            _tint(bgr, one, color)
        outline = corners(pixels_of(one.box, bgr.shape[1::-1]))
        if one.found is not None and len(one.found.outline):
            outline = np.rint(_places(one.found.outline)).astype(int)
        draw_outline(bgr, outline, _title(one), color)
        if one.found is not None:
            _draw_keypoints(bgr, one, color)


def _title(seen: Seen) -> str:
    number = "" if seen.track is None else f"{seen.track.id}: "
    return f"{number}{to_ascii(seen.label)} {seen.score:.2f}"


def _tint(bgr: np.ndarray, seen: Seen, color: Tuple[int, int, int]) -> None:
    x, y, width, height = seen.found.box_pixels
    part = bgr[y : y + height, x : x + width]
    inside = seen.found.mask > 0
    mixed = (1.0 - MASK_OPACITY) * part[inside] + MASK_OPACITY * np.array(color)
    part[inside] = np.rint(mixed).astype(np.uint8)


def _draw_keypoints(bgr: np.ndarray, seen: Seen, color: Tuple[int, int, int]) -> None:
    keypoints = seen.found.keypoints
    for center in _places(keypoints[keypoints[:, 2] >= SURE_KEYPOINT, :2]).tolist():
        draw_dot(bgr, center, KEYPOINT_RADIUS, color)


def _places(positions: np.ndarray) -> np.ndarray:
    """Returns positions of the core, (n, 2), as those of pixels that OpenCV can draw at."""
    return np.clip(positions.astype(np.float64) - CENTER, -MAX_PLACE, MAX_PLACE)
