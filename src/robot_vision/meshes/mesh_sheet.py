"""A sheet of views of a mesh, to see what it is and how large."""

from typing import Tuple

import numpy as np

from .. import Mesh, MeshRenderer, draw_text

BACKGROUND = (70, 62, 56)  # BGR
TEXT = (235, 235, 235)
TEXT_HEIGHT = 26  # px
FOCAL_LENGTH = 3.2  # of the views, in their sides


def mesh_sheet(mesh: Mesh, columns: int = 4, rows: int = 3, side: int = 240) -> np.ndarray:
    """Draws a mesh from all sides, with its size in words: (height, width, 3) uint8, BGR.

    The first row looks down on it, the last one up; z of the mesh is up.

    Args:
        mesh: The mesh.
        columns: How many views there are around it.
        rows: How many heights there are to look from.
        side: Of a view, px.
    """
    renderer = MeshRenderer(mesh)
    distance = 1.08 * 2.0 * FOCAL_LENGTH * max(renderer.extent.radius, 1e-6)
    focal, middle = FOCAL_LENGTH * side, side / 2.0 - 0.5
    camera = np.array([[focal, 0.0, middle], [0.0, focal, middle], [0.0, 0.0, 1.0]])
    sheet = np.empty((rows * side + TEXT_HEIGHT, columns * side, 3), np.uint8)
    sheet[:] = BACKGROUND
    for row in range(rows):
        height = np.pi / 3.0 * (1.0 - 2.0 * (row + 0.5) / rows)
        for column in range(columns):
            around = 2.0 * np.pi * (column + 0.5 * (row % 2)) / columns - np.pi / 6.0
            pose = pose_seen_from(around, height, distance, renderer.extent.center)
            view = renderer.render(camera, pose, (0, 0, side, side), bgr=True)
            tile = sheet[row * side : (row + 1) * side, column * side : (column + 1) * side]
            seen = ~np.isnan(view.depth)
            tile[seen] = view.bgr[seen]
    draw_text(sheet, size_words(mesh, renderer), (8, rows * side + TEXT_HEIGHT - 9), TEXT)
    return sheet


def pose_seen_from(
    around: float, height: float, distance: float, center: Tuple[float, float, float]
) -> np.ndarray:
    """The 4x4 pose of a mesh that a camera looks at, with z up.

    Args:
        around: The direction to the camera about z, rad from x to y.
        height: The angle of the camera above the plane of x and y, rad.
        distance: Of the camera from the center.
        center: The point that is in the middle of the image, in the mesh's frame.
    """
    away = np.array(
        [np.cos(height) * np.cos(around), np.cos(height) * np.sin(around), np.sin(height)]
    )
    right = np.array([-np.sin(around), np.cos(around), 0.0])
    pose = np.eye(4)
    pose[:3, :3] = right, np.cross(right, away), -away
    pose[:3, 3] = -pose[:3, :3] @ (np.asarray(center) + distance * away)
    return pose


def size_words(mesh: Mesh, renderer: MeshRenderer) -> str:
    """What a mesh is like: its size, how many triangles it has, and whether it has textures."""
    size = " x ".join(f"{1000.0 * length:.4g}" for length in renderer.extent.size)
    textures = len(mesh.textures)
    words = f"{size} mm, {len(mesh.triangles)} triangles"
    if textures:
        words += f", {textures} texture{'s' if textures > 1 else ''}"
    return words
