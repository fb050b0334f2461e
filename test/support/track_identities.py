"""How well tracks keep the identities of what they follow.

IDF1 of Ristani, Solera, Zou, Cucchiara and Tomasi, Performance Measures and a Data Set for
Multi-Target, Multi-Camera Tracking, ECCV 2016 workshops: each true trajectory is given at most one
track, and each track at most one trajectory, for the whole sequence and so that as few frames as
possible are wrong. A frame of a pair is right if both are there and overlap enough.
"""

from collections import Counter
from typing import Dict, Hashable, List, Tuple

import numpy as np
from scipy.optimize import linear_sum_assignment

Box = Tuple[float, float, float, float]  # x0, y0, x1, y1
Frame = Dict[Hashable, Box]  # by identity


def overlaps(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Intersections over union of (n, 4) and (m, 4) boxes: (n, m)."""
    first, second = first[:, None], second[None]
    low = np.maximum(first[..., :2], second[..., :2])
    high = np.minimum(first[..., 2:], second[..., 2:])
    both = np.prod(np.maximum(high - low, 0.0), axis=2)

    def areas(boxes: np.ndarray) -> np.ndarray:
        return np.prod(boxes[..., 2:] - boxes[..., :2], axis=2)

    return both / (areas(first) + areas(second) - both)


def matching_frames(truth: List[Frame], tracks: List[Frame], min_iou: float) -> Counter:
    """How many frames each pair of a trajectory and a track could be right in."""
    counts: Counter = Counter()
    for true, tracked in zip(truth, tracks):
        if not true or not tracked:
            continue
        ious = overlaps(np.array([*true.values()]), np.array([*tracked.values()]))
        names, ids = [*true], [*tracked]
        counts.update((names[i], ids[j]) for i, j in np.argwhere(ious >= min_iou))
    return counts


def assignment(truth: List[Frame], tracks: List[Frame], min_iou: float = 0.5) -> Dict:
    """The track of each trajectory that has one, and in how many frames it is right."""
    counts = matching_frames(truth, tracks, min_iou)
    names, ids = (list(dict.fromkeys(pair[side] for pair in counts)) for side in (0, 1))
    table = np.array([[counts[name, track] for track in ids] for name in names]).reshape(
        len(names), len(ids)
    )
    pairs = zip(*linear_sum_assignment(table, maximize=True))
    return {names[i]: (ids[j], int(table[i, j])) for i, j in pairs if table[i, j]}


def idf1(truth: List[Frame], tracks: List[Frame], min_iou: float = 0.5) -> float:
    """2 IDTP / (2 IDTP + IDFP + IDFN), 0 to 1: of frames with the boxes in each."""
    assert len(truth) == len(tracks)
    right = sum(frames for _, frames in assignment(truth, tracks, min_iou).values())
    boxes = sum(map(len, truth)) + sum(map(len, tracks))
    return 2.0 * right / boxes if boxes else 1.0
