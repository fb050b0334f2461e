"""How objects look in an image in their poses: drawn once for all who show them."""

from typing import Optional, Tuple

import numpy as np

from .. import CameraModel, MeshCamera
from ..common import opencv as cv2
from .found import Found, Look

MARGIN = 2  # px around the projected box of an object
EMPTY = np.zeros((0, 2), np.int32)


class Looks:
    """Draws objects as a camera with its lens sees them."""

    def __init__(self) -> None:
        # Of the newest image, in one value, as threads may draw for images of different cameras.
        self._camera: Optional[Tuple[CameraModel, MeshCamera]] = None

    def of(self, one: Found, camera: CameraModel, with_colors: bool) -> Look:
        """Returns how an object looks; others that may hide it are not drawn."""
        known = self._camera
        if known is None or known[0] is not camera:
            known = self._camera = camera, MeshCamera(camera)
        region = _region(one, camera)
        if not region[2] or not region[3]:
            return _nothing()
        view = one.object.shape.renderer.render(known[1], one.pose, region, bgr=with_colors)
        seen = np.isfinite(view.depth).astype(np.uint8)
        x, y, width, height = cv2.boundingRect(seen)
        if not width:
            return _nothing()
        part = slice(y, y + height), slice(x, x + width)
        box = region[0] + x, region[1] + y, width, height
        bgr = view.bgr[part] if with_colors else None
        return Look(box, view.depth[part], bgr, _outline(seen) + np.array(region[:2]))


def _nothing() -> Look:
    return Look((0, 0, 0, 0), np.zeros((0, 0), np.float32), None, EMPTY)


def _region(one: Found, camera: CameraModel) -> Tuple[int, int, int, int]:
    """Returns the part of the image that has the object in it: all of it, if that is not sure."""
    corners = one.object.corners @ one.pose[:3, :3].T + one.pose[:3, 3]
    pixels, _ = camera.project(corners)
    if not np.isfinite(pixels).all():
        return 0, 0, camera.width, camera.height
    low = np.maximum(np.floor(pixels.min(axis=0)).astype(int) - MARGIN, 0)
    size = np.array([camera.width, camera.height])
    high = np.minimum(np.ceil(pixels.max(axis=0)).astype(int) + MARGIN + 1, size)
    width, height = np.maximum(high - low, 0)
    return int(low[0]), int(low[1]), int(width), int(height)


def _outline(seen: np.ndarray) -> np.ndarray:
    found = cv2.findContours(seen, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)[-2]
    return max(found, key=cv2.contourArea)[:, 0, :]
