"""Large images cut into tiles that overlap, so that small objects are not lost, and what is found
in them put together again.
"""

import math
from typing import Any, List, Sequence, Tuple

import numpy as np

from .. import outline_overlaps

Region = Tuple[int, int, int, int]  # x, y, width, height, px
MAX_TILES = 64
MAX_OVERLAP = 0.9
COVERED = 0.7  # share of a box in one of another tile above which it is a part of the same thing
MAX_FOUND = 4096  # objects that are compared, each with all others
EDGE = 2.0  # px, how near to the edge of its tile a box is cut by it


def tiles_of(region: Region, rows: int, columns: int, overlap: float) -> List[Region]:
    """Returns tiles of the same size that cover a region, row by row.

    Args:
        region: The region.
        rows: How many tiles there are below each other.
        columns: How many there are side by side.
        overlap: The share of a tile that it has in common with the next, 0 to MAX_OVERLAP.
    """
    x, y, width, height = region
    lefts, tile_width = _cut(width, columns, overlap)
    tops, tile_height = _cut(height, rows, overlap)
    return [(x + left, y + top, tile_width, tile_height) for top in tops for left in lefts]


def _cut(side: int, count: int, overlap: float) -> Tuple[List[int], int]:
    count = max(1, min(count, side))
    length = min(side, math.ceil(side / (count - (count - 1) * overlap)))
    step = (side - length) / max(1, count - 1)
    # Of a side of few pixels several may begin at the same one.
    return sorted({round(step * number) for number in range(count)}), length


def merged(
    found: Sequence[Tuple[Any, Region]],
    region: Region,
    iou_threshold: float,
    class_agnostic: bool,
    count: int,
) -> List[Any]:
    """Returns the objects found in tiles, each only once, the surest first.

    What the edge of a tile cuts gives way to what another tile has as a whole, even if that is less
    sure. Of more than MAX_FOUND objects the surest count.

    Args:
        found: The objects, with the tiles in which they were found.
        region: The region that the tiles cover.
        iou_threshold: Boxes that overlap a better one of another tile by more are left out. Those
            of one tile are as its decoder has left them.
        class_agnostic: Whether that holds for boxes of different classes.
        count: How many are returned at most.
    """
    if not found:
        return []
    if len(found) > MAX_FOUND:
        found = sorted(found, key=lambda one: -one[0].score)[:MAX_FOUND]
    boxes = np.array([one.box for one, _ in found], np.float64)
    tiles = np.array([tile for _, tile in found], np.float64)
    classes = np.array([0 if class_agnostic else one.class_id for one, _ in found])
    scores = np.array([one.score for one, _ in found])
    kept: List[int] = []
    for number in np.lexsort((-scores, _cut_boxes(boxes, tiles, region))):
        others = np.array(kept, int)
        elsewhere = (tiles[others] != tiles[number]).any(axis=1)
        others = others[elsewhere & (classes[others] == classes[number])]
        iou, covered = _overlaps(boxes[number], boxes[others])
        outline = found[number][0].outline
        for at in np.flatnonzero(iou) if len(outline) else ():
            iou[at], covered[at] = outline_overlaps(outline, found[others[at]][0].outline)
        if not ((iou > iou_threshold) | (covered > COVERED)).any():
            kept.append(number)
    kept.sort(key=lambda number: -scores[number])
    return [found[number][0] for number in kept[:count]]


def _cut_boxes(boxes: np.ndarray, tiles: np.ndarray, region: Region) -> np.ndarray:
    """Returns for each box whether an edge of its tile cuts it that is inside of the region."""
    x, y, width, height = region
    ends = tiles[:, :2] + tiles[:, 2:]
    low = (boxes[:, :2] < tiles[:, :2] + EDGE) & (tiles[:, :2] > (x, y))
    high = (boxes[:, 2:] > ends - EDGE) & (ends < (x + width, y + height))
    return (low | high).any(axis=1)


def _overlaps(box: np.ndarray, others: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Returns the intersection over union, and over the area of the box alone."""
    sides = np.minimum(box[2:], others[:, 2:]) - np.maximum(box[:2], others[:, :2])
    common = np.prod(np.maximum(sides, 0.0), axis=1)
    area, areas = np.prod(box[2:] - box[:2]), np.prod(others[:, 2:] - others[:, :2], axis=1)
    return common / (area + areas - common), common / area
