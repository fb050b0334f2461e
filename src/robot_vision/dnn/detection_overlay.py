"""What a network found drawn over the image."""

from typing import Sequence, Tuple

import cv2
import numpy as np

from .. import draw_outline
from ..common.drawing import fixed_point
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
    hsv = np.uint8([[[class_id * HUE_STEP % 180, 200, 255]]])
    blue, green, red = cv2.cvtColor(hsv, cv2.COLOR_HSV2BGR)[0, 0].tolist()
    return blue, green, red


def draw_seen(bgr: np.ndarray, seen: Sequence[Seen]) -> None:
    """Draws boxes with id, name and score, masks and keypoints; what is only predicted is darker.

    Args:
        bgr: The image, (height, width, 3) uint8, which is changed.
        seen: What there is in it, the most important first, which is drawn last.
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
    mixed = cv2.addWeighted(part, 1.0 - MASK_OPACITY, np.full_like(part, color), MASK_OPACITY, 0.0)
    inside = seen.found.mask > 0
    part[inside] = mixed[inside]


def _draw_keypoints(bgr: np.ndarray, seen: Seen, color: Tuple[int, int, int]) -> None:
    keypoints = seen.found.keypoints
    for center in fixed_point(_places(keypoints[keypoints[:, 2] >= SURE_KEYPOINT, :2])).tolist():
        cv2.circle(bgr, tuple(center), KEYPOINT_RADIUS << 4, color, cv2.FILLED, cv2.LINE_AA, 4)


def _places(positions: np.ndarray) -> np.ndarray:
    """Returns positions of the core, (n, 2), as those of pixels that OpenCV can draw at."""
    return np.clip(positions.astype(np.float64) - CENTER, -MAX_PLACE, MAX_PLACE)
