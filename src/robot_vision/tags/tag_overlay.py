"""Tags in the overlay."""

from typing import Iterable, Optional

import numpy as np

from .. import CameraModel, draw_outline
from .tag_poses import LocatedTag

AXES = ((0.0, 0.0, 255.0), (0.0, 255.0, 0.0), (255.0, 0.0, 0.0))  # BGR: x red, y green, z blue
MAX_COORDINATE = 1e6  # px, that is drawn; the end of an axis beside the camera may be anywhere
OUTLINE = (0.0, 255.0, 255.0)


def draw_tags(bgr: np.ndarray, tags: Iterable[LocatedTag], camera: Optional[CameraModel]) -> None:
    """Draws outlines and ids of tags and, where poses are known, axes and distances."""
    for tag in tags:
        label = str(tag.tag.id)
        if tag.poses is not None:
            label += f": {np.linalg.norm(tag.poses.best.pose[:3, 3]):.2f} m"
        draw_outline(bgr, _rounded(np.asarray(tag.tag.corners)), label, OUTLINE)
        if tag.poses is not None and camera is not None:
            _draw_axes(bgr, tag.poses.best.pose, tag.size / 2.0, camera)


def _draw_axes(bgr: np.ndarray, pose: np.ndarray, length: float, camera: CameraModel) -> None:
    ends = np.vstack([np.zeros(3), length * np.eye(3)])
    pixels, _ = camera.project(ends @ pose[:3, :3].T + pose[:3, 3])
    if (np.abs(pixels) < MAX_COORDINATE).all():
        for end, color in zip(pixels[1:], AXES):
            draw_outline(bgr, _rounded(np.array([pixels[0], end])), color=color)


def _rounded(pixels: np.ndarray) -> np.ndarray:
    return np.rint(pixels).astype(int)
