"""Depth images for people to look at."""

import math
from typing import Iterable

import cv2
import numpy as np

from .. import draw_outline, to_metres
from ..msg import Detection3D
from ..ros.messages import box_of, corners
from .places import title

NEAREST, FARTHEST = 0.4, 8.0  # m, of the colours
WHITE = (255.0, 255.0, 255.0)


def depth_colors(depth: np.ndarray) -> np.ndarray:
    """Returns depths in colours, (height, width, 3) BGR: near is blue, far is red, none is black.

    Equal ratios of depths are equal steps of the colours, from NEAREST to FARTHEST.

    Args:
        depth: (height, width) uint16 in mm or float32 in m.
    """
    metres = to_metres(depth)
    known = np.isfinite(metres)
    levels = np.log(np.where(known, metres, NEAREST) / NEAREST)
    levels = np.clip(levels * (255.0 / math.log(FARTHEST / NEAREST)), 0, 255).astype(np.uint8)
    colors = cv2.applyColorMap(levels, cv2.COLORMAP_JET)
    colors[~known] = 0
    return colors


def draw_places(bgr: np.ndarray, detections: Iterable[Detection3D]) -> None:
    """Draws the boxes of detections in an image, with what they are and how far away."""
    for one in detections:
        draw_outline(bgr, corners(box_of(one.box)), title(one), WHITE)
