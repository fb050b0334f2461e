"""Meshes with few triangles, as markers of rviz have them in each message."""

from typing import Tuple

import numpy as np

from .. import Mesh

MAX_TRIANGLES = 2000
CELLS = 40  # along the largest side, of the grid whose cells keep one vertex each
MIN_CELLS = 4


def marker_triangles(mesh: Mesh) -> Tuple[np.ndarray, np.ndarray]:
    """Returns the corners of triangles, (n, 3, 3) m, and their colors, (n, 3) BGR, 0 to 1.

    A mesh of more than MAX_TRIANGLES is made coarser: of all vertices in a cell of a grid there is
    one left, in their mean.
    """
    vertices = np.asarray(mesh.vertices, float)
    triangles = np.asarray(mesh.triangles)
    colors = triangle_colors(mesh)
    cells = CELLS
    while len(triangles) > MAX_TRIANGLES and cells >= MIN_CELLS:
        vertices, triangles, colors = _coarser(vertices, triangles, colors, cells)
        cells = cells * 3 // 4
    return vertices[triangles], colors / 255.0


def triangle_colors(mesh: Mesh) -> np.ndarray:
    """Returns the color in the middle of each triangle, (n, 3) BGR, 0 to 255."""
    triangles = np.asarray(mesh.triangles)
    if len(mesh.colors):
        colors = np.asarray(mesh.colors, float)[triangles].mean(axis=1)
    else:
        colors = np.tile(np.asarray(mesh.color, float), (len(triangles), 1))
    if not len(mesh.texture_coordinates) or not len(mesh.triangle_textures):
        return colors
    middles = np.asarray(mesh.texture_coordinates, float)[triangles].mean(axis=1)
    for index, texture in enumerate(mesh.textures):
        of_it = np.asarray(mesh.triangle_textures) == index
        size = np.array(texture.shape[1::-1])
        columns, rows = np.floor(middles[of_it] % 1.0 * size).astype(int).T
        colors[of_it] = texture[np.minimum(rows, size[1] - 1), np.minimum(columns, size[0] - 1)]
    return colors


def _coarser(
    vertices: np.ndarray, triangles: np.ndarray, colors: np.ndarray, cells: int
) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    step = max((high - low).max() / cells, 1e-9)
    keys = np.floor((vertices - low) / step).astype(int)
    _, cell_of = np.unique(keys, axis=0, return_inverse=True)
    cell_of = np.ravel(cell_of)  # whose shape is another one in NumPy 2.0
    count = np.bincount(cell_of)
    merged = np.column_stack([np.bincount(cell_of, column) / count for column in vertices.T])
    corners = cell_of[triangles]
    apart = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    _, kept = np.unique(np.sort(corners[apart], axis=1), axis=0, return_index=True)
    kept = np.sort(kept)
    return merged, corners[apart][kept], colors[apart][kept]
