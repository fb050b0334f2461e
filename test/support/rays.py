"""What rays meet of meshes, by trying every triangle: slow and simple, to compare with."""

from typing import Tuple

import numpy as np


def cast(mesh, pose: np.ndarray, rays: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What rays meet first.

    Args:
        mesh: A Mesh.
        pose: 4x4, of the mesh in the optical frame.
        rays: (n, 2), x and y of rays (x, y, 1) in the optical frame.

    Returns:
        z (m), infinite where nothing is met; the triangle; and (n, 3) weights of its corners.
    """
    corners = (mesh.vertices @ pose[:3, :3].T + pose[:3, 3])[mesh.triangles]
    directions = np.column_stack([rays, np.ones(len(rays))])
    depths = np.full(len(rays), np.inf)
    triangles = np.full(len(rays), -1)
    weights = np.zeros((len(rays), 3))
    for index, (a, b, c) in enumerate(corners):
        # The ray meets the plane of the triangle where sums of its corners are along the ray.
        sides = np.array([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
        volume = a @ sides[0]
        if abs(volume) < 1e-18:
            continue
        shares = directions @ sides.T / volume
        inverse = shares.sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = np.where((shares >= 0.0).all(axis=1) & (inverse > 0.0), 1.0 / inverse, np.inf)
        nearer = depth < depths
        depths[nearer] = depth[nearer]
        triangles[nearer] = index
        weights[nearer] = shares[nearer] / inverse[nearer, np.newaxis]
    return depths, triangles, weights


def pixel_rays(matrix: np.ndarray, region: Tuple[int, int, int, int]) -> np.ndarray:
    """(n, 2) rays through the middles of the pixels of a region, row by row."""
    x, y, width, height = region
    pixels = np.stack(np.meshgrid(np.arange(x, x + width), np.arange(y, y + height)), axis=-1)
    pixels = np.dstack([pixels, np.ones((height, width))]).reshape(-1, 3)
    return (pixels @ np.linalg.inv(matrix).T)[:, :2]


def looking_at(center, around: float, height: float, distance: float) -> np.ndarray:
    """4x4 pose of a frame with z up, whose `center` a camera looks at from these angles (rad)."""
    away = np.array(
        [np.cos(height) * np.cos(around), np.cos(height) * np.sin(around), np.sin(height)]
    )
    right = np.array([-np.sin(around), np.cos(around), 0.0])
    pose = np.eye(4)
    pose[:3, :3] = right, np.cross(right, away), -away
    pose[:3, 3] = -pose[:3, :3] @ (np.asarray(center) + distance * away)
    return pose
