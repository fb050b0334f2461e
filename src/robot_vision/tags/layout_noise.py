"""How well the places of tags on a rigid body are known, wherever its frame is."""

from typing import Sequence, Tuple

import numpy as np

LEAST_SHIFT = 0.00005  # m: paper is no flatter, and a lens no better known
LEAST_TURN = 0.0005  # rad, the same


def noises_of(
    covariance: np.ndarray, layout: np.ndarray, sizes: Sequence[float]
) -> Tuple[np.ndarray, np.ndarray]:
    """Standard deviations of the tags' coordinates (m) and rotations about each axis (rad).

    In the frame of a master, its own errors would be those of all others. What matters is the
    layout in itself: the frame is taken to be where it fits the true one best on the whole.

    Args:
        covariance: (6n, 6n), of layout_covariance().
        layout: (n, 4, 4), poses of the tags.
        sizes: m, of the tags.
    """
    by_frame = np.vstack([_by_frame(pose) for pose in layout])
    weights = np.concatenate([[1.0] * 3 + [size**2 / 3.0] * 3 for size in sizes])
    weighted = by_frame.T * weights  # as far as the corners move, squared
    inner = np.eye(len(weights)) - by_frame @ np.linalg.solve(weighted @ by_frame, weighted)
    variances = np.diag(inner @ covariance @ inner.T).reshape(-1, 2, 3).mean(axis=-1)
    noises = np.sqrt(variances)
    return np.maximum(noises[:, 0], LEAST_SHIFT), np.maximum(noises[:, 1], LEAST_TURN)


def _by_frame(pose: np.ndarray) -> np.ndarray:
    """How a tag moves with the frame: (6, 6)."""
    x, y, z = pose[:3, 3]
    moved = np.eye(6)
    moved[:3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return moved
