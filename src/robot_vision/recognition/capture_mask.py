"""Where an object on a plate is in an image: what is above the plate, by its depths."""

from typing import NamedTuple

import numpy as np

from .. import CameraModel
from ..common import opencv as cv2

MM = 0.001  # m
CLOSED = 15  # px, width of holes without a depth that are the object's
MIN_SHARE = 0.02  # of the largest piece, that another one must have to be a part of the object


class Space(NamedTuple):
    """The space above a plate that the object is in.

    Attributes:
        radius: m, around the z axis of the plate's frame.
        floor: m, from where on something is not the plate.
        height: m, up to where.
    """

    radius: float
    floor: float
    height: float


class PixelRays:
    """The rays of all pixels of a camera, made once. For one thread."""

    def __init__(self) -> None:
        self._camera: object = None
        self._rays = np.zeros((0, 0, 3))

    def of(self, camera: CameraModel) -> np.ndarray:
        """Returns (height, width, 3): the points (x, y, 1) that pixels see."""
        if camera is not self._camera:
            v, u = np.mgrid[: camera.height, : camera.width]
            rays = camera.rays(np.column_stack([u.ravel(), v.ravel()]).astype(float))
            shape = camera.height, camera.width, 3
            self._rays = np.column_stack([rays, np.ones(len(rays))]).reshape(shape)
            self._camera = camera
        return self._rays


def metres_of(depth: np.ndarray) -> np.ndarray:
    """Returns depths in m, NaN where there is none, of uint16 in mm or float32 in m."""
    if depth.dtype == np.uint16:
        return np.where(depth > 0, MM * depth, np.nan)
    return np.where(np.isfinite(depth) & (depth > 0.0), depth, np.nan).astype(float)


def object_mask(depth: np.ndarray, rays: np.ndarray, pose: np.ndarray, space: Space) -> np.ndarray:
    """Returns where the object is, (height, width) uint8, 255 or 0.

    Holes without a depth in it are its own; others, through which what is behind it is seen, are
    not.

    Args:
        depth: Depths, uint16 in mm or float32 in m.
        rays: Those of the pixels, as PixelRays has them.
        pose: 4x4, of the plate's frame in the camera's optical frame, m.
        space: The space that the object is in.
    """
    metres = metres_of(depth)
    points = (metres[..., None] * rays - pose[:3, 3]) @ pose[:3, :3]
    with np.errstate(invalid="ignore"):
        inside = (points[..., 2] > space.floor) & (points[..., 2] < space.height)
        inside &= np.hypot(points[..., 0], points[..., 1]) < space.radius
    seen = cv2.morphologyEx(inside.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    closing = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (CLOSED, CLOSED))
    closed = cv2.morphologyEx(seen, cv2.MORPH_CLOSE, closing)
    whole = (seen > 0) | ((closed > 0) & np.isnan(metres))
    return _pieces(whole.astype(np.uint8))


def _pieces(mask: np.ndarray) -> np.ndarray:
    """Returns the pieces that are large, in 255."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=8)
    areas = stats[:, cv2.CC_STAT_AREA].copy()
    areas[0] = 0  # what is no piece
    large = areas >= max(MIN_SHARE * areas.max(), 1)
    return np.where(large[labels], 255, 0).astype(np.uint8)


def touches_border(mask: np.ndarray) -> bool:
    """Returns whether something in a mask is at the border of the image."""
    return bool(mask[0].any() or mask[-1].any() or mask[:, 0].any() or mask[:, -1].any())


def sharpness(gray: np.ndarray, mask: np.ndarray) -> float:
    """Returns how sharp an image is where the mask is: the variance of its Laplacian."""
    return float(cv2.Laplacian(gray, cv2.CV_32F)[mask > 0].var()) if mask.any() else 0.0
