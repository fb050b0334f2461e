"""What overlays and diagrams are drawn with: fractions of a pixel, and the outline of a circle."""

import numpy as np

FRACTION_BITS = 4  # of the fixed-point coordinates at which OpenCV draws
_ANGLES = np.arange(64) * (2.0 * np.pi / 64)
CIRCLE = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])  # (64, 2), around 0, with radius 1


def fixed_point(pixels: np.ndarray) -> np.ndarray:
    """Returns positions in px as OpenCV takes them with FRACTION_BITS: int32, of the same shape."""
    return np.rint(pixels * 2**FRACTION_BITS).astype(np.int32)
