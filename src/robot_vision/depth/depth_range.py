"""The range of depths that counts."""

import numpy as np

NEAREST = 0.01  # m, what no camera sees sharply, and which is noise or another unit


def within(image: np.ndarray, farthest: float) -> np.ndarray:
    """Returns the depths from NEAREST to `farthest` (m); what is nearer or farther has none.

    Args:
        image: (height, width) uint16 in mm or float32 in m.
        farthest: m.
    """
    metres = image.dtype == np.float32
    per_metre, none = (1.0, np.nan) if metres else (1000.0, 0)
    with np.errstate(invalid="ignore"):  # NaN, which no comparison holds for
        counts = (image >= NEAREST * per_metre) & (image <= farthest * per_metre)
    return np.where(counts, image, image.dtype.type(none))
