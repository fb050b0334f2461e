"""Which points of the network's grids have to find which thing.

A point belongs to a thing if it is near the middle of its box and the box is of a size for the
point's grid, as in FCOS (Tian et al., FCOS: Fully Convolutional One-Stage Object Detection, ICCV
2019), but with sizes that overlap.
"""

from typing import NamedTuple, Tuple

import numpy as np

from .things import NAMES, Labels
from .views import INPUT

STRIDES = (8, 16, 32)  # px between the points of each grid
SIZES = ((0, 60), (36, 128), (84, 1000))  # px, the longer side of boxes that a grid finds
NEAR = 1.5  # strides from a box's middle to the points that have to find it


class Targets(NamedTuple):
    """What each of the n points has to say."""

    classes: np.ndarray  # (n,) int64, -1: nothing
    boxes: np.ndarray  # (n, 4) float32, px x0, y0, x1, y1
    unclear: np.ndarray  # (n, classes) bool: whatever it says is right


def grid_points() -> Tuple[np.ndarray, np.ndarray]:
    """All points (n, 2), px, and the strides (n,) of their grids, the finest first."""
    points, strides = [], []
    for stride in STRIDES:
        x, y = np.meshgrid(*((np.arange(side // stride) + 0.5) * stride for side in INPUT))
        points.append(np.stack([x, y], axis=-1).reshape(-1, 2))
        strides.append(np.full(x.size, stride))
    return np.concatenate(points), np.concatenate(strides)


POINTS, POINT_STRIDES = grid_points()
LOWEST, HIGHEST = (
    np.concatenate(
        [np.full(np.sum(s == POINT_STRIDES), size[end]) for s, size in zip(STRIDES, SIZES)]
    )
    for end in (0, 1)
)


def targets_of(labels: Labels) -> Targets:
    """The targets of all points for one input."""
    classes = np.full(len(POINTS), -1, np.int64)
    boxes = np.zeros((len(POINTS), 4), np.float32)
    unclear = np.zeros((len(POINTS), len(NAMES)), bool)
    areas = np.prod(labels.boxes[:, 2:] - labels.boxes[:, :2], axis=1)
    for i in np.argsort(-areas, kind="stable"):  # where things overlap, the smaller one wins
        low, high = labels.boxes[i, :2], labels.boxes[i, 2:]
        if labels.unclear[i]:
            near = np.all((low - POINT_STRIDES[:, None] < POINTS), axis=1)
            near &= np.all(high + POINT_STRIDES[:, None] > POINTS, axis=1)
            unclear[near, labels.classes[i]] = True
            continue
        side = max(high - low)
        away = np.abs(POINTS - (low + high) / 2).max(axis=1) / POINT_STRIDES
        inside = np.all((low < POINTS) & (high > POINTS), axis=1)
        chosen = (away < NEAR) & (inside | (away <= 0.5)) & (side >= LOWEST) & (side < HIGHEST)
        classes[chosen] = labels.classes[i]
        boxes[chosen] = labels.boxes[i]
    return Targets(classes, boxes, unclear)
