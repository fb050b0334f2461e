"""A face that moves in front of a background, with its true box: for the tests of faces."""

import functools
import math
from typing import Tuple

import cv2
import numpy as np
import skimage.data

from robot_vision import Face

RATE = 30.0  # Hz
PORTRAIT = cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR)
MIDDLE = (224.0, 114.0)  # px, middle of the face in the portrait
SIDE = 108.0  # px, side of that face
BACKGROUND = cv2.resize(cv2.cvtColor(skimage.data.coffee(), cv2.COLOR_RGB2BGR), (640, 480))
KINDS = ("moved", "scaled", "mirrored", "darkened", "blurred", "turned")

Box = Tuple[float, float, float, float]  # x, y, width, height, px


@functools.lru_cache(maxsize=40)
def frame(number: int, kind: str = "moved") -> Tuple[np.ndarray, Box]:
    """A frame of the moving portrait, and the box of its face."""
    x, y = 320 + 120 * math.sin(0.06 * number), 240 + 60 * math.sin(0.041 * number)
    wave = math.sin(0.05 * number)
    scale = 1.0 + 0.45 * wave if kind == "scaled" else 1.0
    angle = 15.0 * wave if kind == "turned" else 0.0
    portrait, middle = PORTRAIT, MIDDLE
    if kind == "mirrored":
        portrait = np.ascontiguousarray(PORTRAIT[:, ::-1])
        middle = (PORTRAIT.shape[1] - 1 - MIDDLE[0], MIDDLE[1])
    matrix = cv2.getRotationMatrix2D(middle, angle, scale)
    matrix[:, 2] += x - middle[0], y - middle[1]
    image = BACKGROUND.copy()
    cv2.warpAffine(portrait, matrix, (640, 480), image, borderMode=cv2.BORDER_TRANSPARENT)
    if kind == "blurred":
        image = cv2.GaussianBlur(image, (0, 0), 1.6 + 1.5 * wave)
    light = 0.35 + 0.3 * wave if kind == "darkened" else 1.0
    noise = 3.0 * np.random.default_rng(number).standard_normal(image.shape, np.float32)
    image = np.clip(light * image + noise, 0, 255).astype(np.uint8)
    side = scale * SIDE
    return image, (x - side / 2, y - side / 2, side, side)


def iou(a: Box, b: Box) -> float:
    """The intersection of two boxes over their union."""
    width = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    height = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    common = max(width, 0.0) * max(height, 0.0)
    return common / (a[2] * a[3] + b[2] * b[3] - common)


def is_at(face: Face, truth: Box) -> bool:
    return iou(face.box, truth) >= 0.5
