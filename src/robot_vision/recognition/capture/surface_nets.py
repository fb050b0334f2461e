"""The surface between what is inside and what is outside of a grid of values."""

from typing import Tuple

import numpy as np

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
EDGES = [  # of a cell, pairs of corners
    (a, b) for a in range(8) for b in range(a + 1, 8) if abs(CORNERS[a] - CORNERS[b]).sum() == 1
]


def surface_of(values: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Returns the surface on which the values of a grid are 0, by surface nets.

    Each cell of eight nodes through which the surface goes has a vertex in the middle of where its
    edges are crossed, and each edge that is crossed has a square of the four cells around it.

    Args:
        values: (x, y, z) float32, below 0 inside. All at the sides of the grid must be outside.

    Returns:
        The vertices, (n, 3) float32, in nodes, and the triangles, (t, 3) int32, counter-clockwise
        for who sees the outside.
    """
    inside = values < 0.0
    shape = np.array(values.shape) - 1  # of the cells
    parts = [inside[_cells(corner, shape)] for corner in CORNERS]
    count = np.sum(parts, axis=0)
    active = np.argwhere((count > 0) & (count < 8))
    numbers = np.full(shape, -1, np.int32)
    numbers[tuple(active.T)] = np.arange(len(active))
    vertices = active + _middles(values, active)
    triangles = [_squares(inside, numbers, axis) for axis in range(3)]
    return vertices.astype(np.float32), np.vstack(triangles).astype(np.int32)


def _cells(corner: np.ndarray, shape: np.ndarray) -> Tuple[slice, ...]:
    """Returns the nodes that are this corner of the cells."""
    return tuple(slice(first, first + size) for first, size in zip(corner, shape))


def _middles(values: np.ndarray, active: np.ndarray) -> np.ndarray:
    """Returns the middles of the crossings of the edges of some cells, from their first corner."""
    at = np.stack([values[tuple((active + corner).T)] for corner in CORNERS])
    total, count = np.zeros((len(active), 3)), np.zeros(len(active))
    for a, b in EDGES:
        crossed = (at[a] < 0.0) != (at[b] < 0.0)
        share = np.where(crossed, at[a] / np.where(crossed, at[a] - at[b], 1.0), 0.0)
        points = CORNERS[a] + share[:, None] * (CORNERS[b] - CORNERS[a])
        total += points * crossed[:, None]
        count += crossed
    return total / count[:, None]


def _squares(inside: np.ndarray, numbers: np.ndarray, axis: int) -> np.ndarray:
    """Returns two triangles for each edge along an axis that the surface crosses."""
    first = np.moveaxis(inside, axis, 0)
    turned = np.moveaxis(numbers, axis, 0)  # y and z of axis 0, x and z of 1, x and y of 2
    crossed = first[:-1, 1:-1, 1:-1] != first[1:, 1:-1, 1:-1]
    where = np.argwhere(crossed)
    leaves = first[:-1, 1:-1, 1:-1][crossed] ^ (axis == 1)  # Axes 0 and 2 are right-handed.
    along, one, other = where.T
    corners = np.stack(
        [
            turned[along, one, other],
            turned[along, one + 1, other],
            turned[along, one + 1, other + 1],
            turned[along, one, other + 1],
        ],
        axis=1,
    )
    corners[~leaves] = corners[~leaves, ::-1]
    return np.vstack([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
