"""The accuracy of the tags' poses in a layout, independent of the choice of its frame."""

from typing import Sequence, Tuple

import numpy as np

MIN_SHIFT_NOISE = 0.00005  # m; paper is no flatter, and a lens is not known better
MIN_TURN_NOISE = 0.0005  # rad, for the same reasons


def noises_of(
    covariance: np.ndarray, layout: np.ndarray, sizes: Sequence[float]
) -> Tuple[np.ndarray, np.ndarray]:
    """Returns standard deviations of the tags' coordinates (m) and rotations about each axis (rad).

    In the master's frame the errors of the master would appear as errors of all other tags. What
    matters is the accuracy of the layout in itself. Therefore the frame is placed where it fits
    the true layout best on the whole.

    Args:
        covariance: (6n, 6n), from layout_covariance().
        layout: (n, 4, 4), poses of the tags.
        sizes: The sizes of the tags in m.
    """
    by_frame = np.vstack([_by_frame(pose) for pose in layout])
    weights = np.concatenate([[1.0] * 3 + [size**2 / 3.0] * 3 for size in sizes])
    weighted = by_frame.T * weights  # by the squared motion of the corners
    inner = np.eye(len(weights)) - by_frame @ np.linalg.solve(weighted @ by_frame, weighted)
    variances = np.diag(inner @ covariance @ inner.T).reshape(-1, 2, 3).mean(axis=-1)
    noises = np.sqrt(variances)
    return np.maximum(noises[:, 0], MIN_SHIFT_NOISE), np.maximum(noises[:, 1], MIN_TURN_NOISE)


def _by_frame(pose: np.ndarray) -> np.ndarray:
    """Returns how a tag moves when the frame moves, (6, 6)."""
    x, y, z = pose[:3, 3]
    moved = np.eye(6)
    moved[:3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return moved
