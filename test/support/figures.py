"""A crude figure that OpenCV's people detectors take for a person, and images with it."""

import cv2
import numpy as np

# Corners in px of a window of 64x128, as a photograph of training has it; the left half.
LEG = [(22, 68), (32, 68), (32, 72), (28, 108), (24, 108)]
TRUNK = [(22, 31), (32, 31), (32, 68), (22, 68)]
ARM = [(22, 31), (16, 68), (19.5, 68), (26, 36)]
HEAD, HEAD_SIZE = (32, 23), (6, 7.5)
SKIN, SHIRT, TROUSERS = (120, 150, 200), (60, 40, 30), (70, 60, 60)  # BGR
WALL = 190  # gray level
BITS = 4  # of a fraction of a pixel


def draw_figure(image, box):
    """Draws a figure that fills a window, (x, y, width, height) px, half as wide as it is high."""
    left, top, _, height = box
    unit = height / 128.0

    def fixed(points):
        place = np.array([left, top]) + unit * np.array(points, float)
        return np.rint(place * 2**BITS).astype(np.int32)

    for part, color in ((LEG, TROUSERS), (TRUNK, SHIRT), (ARM, SHIRT)):
        for corners in (part, [(64 - x, y) for x, y in part]):
            cv2.fillPoly(image, [fixed(corners)], color, cv2.LINE_AA, BITS)
    center = tuple(int(value) for value in fixed([HEAD])[0])
    axes = tuple(round(unit * side * 2**BITS) for side in HEAD_SIZE)
    cv2.ellipse(image, center, axes, 0, 0, 360, SKIN, -1, cv2.LINE_AA, BITS)


def street(size, boxes, noise=3.0):
    """An image of this (width, height) with figures before a gray wall."""
    image = np.full((size[1], size[0], 3), WALL, np.uint8)
    for box in boxes:
        draw_figure(image, box)
    grain = np.random.default_rng(1).normal(0.0, noise, image.shape)
    return np.clip(image + grain, 0, 255).astype(np.uint8)
