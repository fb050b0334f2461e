"""Average precision of object detections, from its definition.

Detections of one class are taken from the surest to the least sure one. Each finds the thing of its
image with which it has the largest IoU, if that is large enough and nobody found it before.
Precision is the share of the detections so far that found something, recall the share of the things
that were found. Precision is made to fall only, and its mean over the recalls 0, 0.01, ..., 1 is
the average precision: COCO's definition (Lin et al., Microsoft COCO, ECCV 2014).

Things may be unclear. A detection that finds none of the others, and whose box lies to a half or
more in that of an unclear thing of its class, is neither right nor wrong.
"""

from typing import List, NamedTuple, Sequence

import numpy as np

RECALLS = np.linspace(0, 1, 101)


class Boxes(NamedTuple):
    """What is in one image, or what was found in it; boxes are x0, y0, x1, y1."""

    classes: np.ndarray  # (n,) int
    boxes: np.ndarray  # (n, 4)
    scores: np.ndarray  # (n,), of what was found
    unclear: np.ndarray  # (n,) bool, of what is there


def common_areas(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n, m) areas that boxes (n, 4) have in common with boxes (m, 4)."""
    low = np.maximum(a[:, None, :2], b[None, :, :2])
    high = np.minimum(a[:, None, 2:], b[None, :, 2:])
    return np.clip(high - low, 0, None).prod(axis=2)


def areas(boxes: np.ndarray) -> np.ndarray:
    return (boxes[:, 2:] - boxes[:, :2]).prod(axis=1)


def overlaps(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n, m) IoU of boxes (n, 4) and (m, 4); 0 where both are empty."""
    common = common_areas(a, b)
    union = areas(a)[:, None] + areas(b)[None] - common
    return np.divide(common, union, out=np.zeros_like(common), where=union > 0)


def verdicts(found: Boxes, truth: Boxes, kind: int, min_iou: float) -> List[List[float]]:
    """The scores of one image's detections of a class, each with 1 if right and 0 if wrong."""
    mine = np.flatnonzero(found.classes == kind)
    mine = mine[np.argsort(-found.scores[mine], kind="stable")]
    clear = truth.boxes[(truth.classes == kind) & ~truth.unclear]
    unclear = truth.boxes[(truth.classes == kind) & truth.unclear]
    iou = overlaps(found.boxes[mine], clear)
    inside = common_areas(found.boxes[mine], unclear)
    size = areas(found.boxes[mine])
    result = []
    for row, number in enumerate(mine):
        best = int(np.argmax(iou[row])) if len(clear) else -1
        if best >= 0 and iou[row, best] >= min_iou:
            iou[:, best] = -1  # found
            result.append([found.scores[number], 1.0])
        elif not np.any(inside[row] >= 0.5 * size[row]):
            result.append([found.scores[number], 0.0])
    return result


def average_precision(
    found: Sequence[Boxes], truth: Sequence[Boxes], kind: int, min_iou: float = 0.5
) -> float:
    """The average precision of a class, 0 to 1, over all images; NaN if it is in none of them."""
    count = sum(int(np.sum((there.classes == kind) & ~there.unclear)) for there in truth)
    if not count:
        return float("nan")
    rows = [row for pair in zip(found, truth) for row in verdicts(*pair, kind, min_iou)]
    judged = np.array(rows).reshape(-1, 2)
    right = judged[np.argsort(-judged[:, 0], kind="stable"), 1]
    hits = np.cumsum(right)
    precision = hits / np.arange(1, len(hits) + 1)
    falling = np.append(np.maximum.accumulate(precision[::-1])[::-1], 0.0)
    # The first detection with which a recall is reached; 1e-9 for recalls like 29/29 of 1.0.
    first = np.searchsorted(hits / count, RECALLS - 1e-9)
    return float(falling[first].mean())
