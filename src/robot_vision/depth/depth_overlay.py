"""Depth images for people to look at."""

import math
from typing import Iterable

import numpy as np

from .. import draw_outline, to_bgr, to_metres
from ..common import opencv as cv2
from ..msg import Detection3D
from ..ros.messages import box_of, corners
from .places import title

NEAREST, FARTHEST = 0.4, 8.0  # m, of the colours
NEAR, FAR = 255, 60  # gray levels of what is at the camera, and of what is at the end of the range
WHITE = (255.0, 255.0, 255.0)


def depth_colors(
    depth: np.ndarray, nearest: float = NEAREST, farthest: float = FARTHEST
) -> np.ndarray:
    """Returns depths in colours, (height, width, 3) BGR: near is blue, far is red, none is black.

    Equal ratios of depths are equal steps of the colours.

    Args:
        depth: (height, width) uint16 in mm or float32 in m.
        nearest: m, up to where all is equally blue.
        farthest: m, from where on all is equally red.
    """
    metres = to_metres(depth)
    known = np.isfinite(metres)
    levels = np.log(np.where(known, metres, nearest) / nearest)
    levels = np.clip(levels * (255.0 / math.log(farthest / nearest)), 0, 255).astype(np.uint8)
    colors = cv2.applyColorMap(levels, cv2.COLORMAP_JET)
    colors[~known] = 0
    return colors


def depth_gray(depth: np.ndarray, farthest: float) -> np.ndarray:
    """Returns depths as gray, for colours of something else to be drawn into them.

    Args:
        depth: (height, width) uint16 in mm or float32 in m.
        farthest: m, from where on all is equally dark.

    Returns:
        (height, width, 3) uint8, BGR: near is bright, and black has no depth.
    """
    share = np.clip(to_metres(depth) / farthest, 0.0, 1.0)
    gray = np.nan_to_num(NEAR - (NEAR - FAR) * share).astype(np.uint8)
    return to_bgr(gray, "mono8")


def draw_places(bgr: np.ndarray, detections: Iterable[Detection3D]) -> None:
    """Draws the boxes of detections in an image, with what they are and how far away."""
    for one in detections:
        draw_outline(bgr, corners(box_of(one.box)), title(one), WHITE)
