"""What of a thing is in view: shares of outlines, and boxes around them.

Outlines are convex, (n, 2) px in continuous coordinates: the first pixel goes from 0 to 1.
"""

from typing import Sequence

import numpy as np

GRID = 24  # points to a side of the grid that shares are measured with


def inside(points: np.ndarray, outline: np.ndarray) -> np.ndarray:
    """Which of the points (n, 2) are inside of a convex outline of either orientation."""
    edges = np.roll(outline, -1, axis=0) - outline
    to_points = points[:, None] - outline
    sides = edges[:, 0] * to_points[..., 1] - edges[:, 1] * to_points[..., 0]
    return np.all(sides >= 0, axis=1) | np.all(sides <= 0, axis=1)


def visible_share(outline: np.ndarray, view: np.ndarray, nearer: Sequence[np.ndarray]) -> float:
    """The share of an outline's area, 0 to 1, that is in the view and behind nothing nearer.

    Args:
        outline: of the thing.
        view: the outline of what the image shows.
        nearer: outlines of what covers it.
    """
    low, high = outline.min(axis=0), outline.max(axis=0)
    steps = (np.arange(GRID) + 0.5) / GRID
    grid = np.stack(np.meshgrid(*(low + (high - low) * steps[:, None]).T), axis=-1).reshape(-1, 2)
    own = grid[inside(grid, outline)]
    if not len(own):
        return 0.0
    seen = inside(own, view)
    for other in nearer:
        seen &= ~inside(own, other)
    return float(seen.mean())


def box_in_view(outline: np.ndarray, view: np.ndarray) -> np.ndarray:
    """The box x0, y0, x1, y1 around an outline, cut off where the view's own box ends."""
    low, high = view.min(axis=0), view.max(axis=0)
    points = np.clip(outline, low, high)
    return np.concatenate([points.min(axis=0), points.max(axis=0)])


def rectangle(width: float, height: float) -> np.ndarray:
    """The outline of an image of that size."""
    return np.array([[0, 0], [width, 0], [width, height], [0, height]], float)


def transformed(points: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Points after a 2x3 or 3x3 matrix."""
    moved = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    return moved[:, :2] / moved[:, 2:] if len(matrix) == 3 else moved
