"""Depths of an object from many sides, put together into its surface."""

from typing import Sequence, Tuple

import numpy as np

from ... import Mesh
from .surface_nets import surface_of
from .turntable import Space, View

MAX_CELLS = 110  # along the longest side
MIN_CELL = 0.002  # m
REACH = 3.5  # cells behind a surface that a depth tells of
STRAY = 0.5  # percent of the points of a view that may be noise, at each side of the object
MARGIN = 0.01  # m around the points
MIN_COSINE = 0.3  # between the surface and the line of sight, for its color
MIN_TRIANGLES = 100
GRAY = 160.0  # of what no image shows, if none shows anything


def fused(views: Sequence[View], space: Space) -> Mesh:
    """Returns the surface of an object.

    It is what the depths agree on. What no view shows, as its underside, is where it is hidden by
    what is seen; the object goes down to z = 0, on which it stands.

    Raises:
        ValueError: There is no surface in the views.
    """
    volume = _Volume(*_box(views, space))
    for view in views:
        volume.add(view)
    vertices, triangles = _largest(*surface_of(volume.values()))
    if len(triangles) < MIN_TRIANGLES:
        raise ValueError("the depths of the views make no surface: did the tags move?")
    vertices = volume.low + vertices * volume.cell
    normals = _normals(vertices, triangles)
    colors = _colors(vertices, normals, views, REACH * volume.cell)
    return Mesh(vertices, triangles, normals, colors)


def _box(views: Sequence[View], space: Space) -> Tuple[np.ndarray, np.ndarray]:
    ends = [np.percentile(view.points, [STRAY, 100.0 - STRAY], axis=0) for view in views]
    low = np.min([low for low, _ in ends], axis=0) - MARGIN
    high = np.max([high for _, high in ends], axis=0) + MARGIN
    middle = np.array([space.x, space.y])
    low[:2] = np.maximum(low[:2], middle - space.radius)
    high[:2] = np.minimum(high[:2], middle + space.radius)
    low[2] = space.floor
    return low, high


class _Volume:
    """How far each node of a grid is from the surface, by all depths. Its lowest layer is at z = 0
    less half a cell."""

    def __init__(self, low: np.ndarray, high: np.ndarray) -> None:
        self.cell = max(MIN_CELL, float((high - low).max()) / MAX_CELLS)
        self._floor = float(low[2])
        self.low = np.array([low[0], low[1], -0.5 * self.cell], np.float32)
        self._shape = tuple(np.ceil((high - self.low) / self.cell).astype(int) + 1)
        indices = np.indices(self._shape, np.float32).reshape(3, -1).T
        self._nodes = self.low + indices * np.float32(self.cell)
        self._sum = np.zeros(len(self._nodes), np.float32)
        self._weight = np.zeros(len(self._nodes), np.float32)
        self._hidden = np.zeros(len(self._nodes), bool)  # behind the surface of some view

    def add(self, view: View) -> None:
        (depth,), distance = _seen(view, view.depth[..., None], self._nodes)
        reach = np.float32(REACH * self.cell)
        with np.errstate(invalid="ignore"):  # NaN: there is no depth
            before = depth - distance
            seen = before > -reach
            self._hidden |= before <= -reach
        weight = np.where(before[seen] >= 0.0, 1.0, 1.0 + before[seen] / reach)
        self._sum[seen] += weight * np.minimum(before[seen] / reach, 1.0)
        self._weight[seen] += weight

    def values(self) -> np.ndarray:
        """Returns the values of the nodes, below 0 inside; those at the sides are outside."""
        unseen = np.where(self._hidden, -1.0, 1.0)
        known = self._weight > 0.0
        values = np.where(known, self._sum / np.where(known, self._weight, 1.0), unseen)
        values = values.reshape(self._shape).astype(np.float32)
        floor = int(np.ceil((self._floor - self.low[2]) / self.cell))  # lowest layer with depths
        values[:, :, 1:floor] = values[:, :, floor : floor + 1]
        values[:, :, 0] = np.abs(values[:, :, 1])  # so that the surface is between them
        for side in (values[0], values[-1], values[:, 0], values[:, -1], values[:, :, -1]):
            side[:] = 1.0
        return values


def _seen(view: View, looks: np.ndarray, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Returns what an image of a view has where it shows points, and the depths of these.

    Args:
        view: The view.
        looks: (height, width, channels) float32.
        points: (n, 3), m, in the object's frame.

    Returns:
        (channels, n) float32, NaN for what is not in the image, and (n,), m.
    """
    pose = view.pose.astype(np.float32)
    at = points @ pose[:3, :3].T + pose[:3, 3]
    distance = at[:, 2]
    matrix = view.matrix.astype(np.float32)
    columns = np.rint(at[:, 0] / distance * matrix[0, 0] + matrix[0, 2])
    rows = np.rint(at[:, 1] / distance * matrix[1, 1] + matrix[1, 2])
    height, width, channels = looks.shape
    inside = (distance > 0.0) & (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    found = np.full((channels, len(points)), np.nan, np.float32)
    found[:, inside] = looks[rows[inside].astype(int), columns[inside].astype(int)].T
    return found, distance


def _largest(vertices: np.ndarray, triangles: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Returns the largest of the pieces that hang together."""
    if not len(triangles):
        return vertices, triangles
    labels = np.arange(len(vertices))
    while True:
        least = labels[triangles].min(axis=1)
        joined = labels.copy()
        for corner in triangles.T:
            np.minimum.at(joined, corner, least)
        joined = joined[joined]
        if np.array_equal(joined, labels):
            break
        labels = joined
    of_triangles = labels[triangles[:, 0]]
    kept = triangles[of_triangles == np.bincount(of_triangles).argmax()]
    used, numbers = np.unique(kept, return_inverse=True)
    return vertices[used], numbers.reshape(-1, 3).astype(np.int32)


def _normals(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (vertices[corner] for corner in triangles.T)
    across = np.cross(b - a, c - a)
    normals = np.zeros_like(vertices)
    for corner in triangles.T:
        np.add.at(normals, corner, across)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    up = np.array([0.0, 0.0, 1.0], np.float32)  # where the surface is folded onto itself
    return np.where(length > 0.0, normals / np.where(length > 0.0, length, 1.0), up)


def _colors(
    vertices: np.ndarray, normals: np.ndarray, views: Sequence[View], reach: float
) -> np.ndarray:
    """Returns the mean color of each vertex in the views that show it, most from straight ahead."""
    total, weight = np.zeros((len(vertices), 3)), np.zeros(len(vertices))
    for view in views:
        towards = -view.pose[:3, :3].T @ view.pose[:3, 3] - vertices
        cosine = np.sum(towards * normals, axis=1) / np.linalg.norm(towards, axis=1)
        looks = np.dstack([view.depth, view.bgr]).astype(np.float32)
        (depth, *bgr), distance = _seen(view, looks, vertices)
        with np.errstate(invalid="ignore"):
            shown = (cosine > MIN_COSINE) & (np.abs(depth - distance) < reach)
        total[shown] += cosine[shown, None] * np.transpose(bgr)[shown]
        weight[shown] += cosine[shown]
    known = weight > 0.0
    mean = total[known].sum(axis=0) / weight[known].sum() if known.any() else np.full(3, GRAY)
    colors = np.where(known[:, None], total / np.where(known, weight, 1.0)[:, None], mean)
    return np.rint(colors).clip(0, 255).astype(np.uint8)
