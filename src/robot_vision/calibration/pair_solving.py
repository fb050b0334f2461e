"""Computes where two cameras are to each other, from views of a board that both have."""

from dataclasses import dataclass
from typing import NamedTuple, Sequence, Tuple

import cv2
import numpy as np

from .. import CameraModel, RectifiedCamera, StereoCamera, StereoGeometry
from ..stereo import calibrated_pair
from .pair_views import MIN_PAIRS, PairView

END = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-9)
LARGE_ERROR = 3.0  # error from which on a view is refused, as a multiple of the median
MIN_REFUSED_ERROR = 0.5  # px; a view with less is never refused
MAX_SHIFT = 1000.0  # px
MAX_ERROR = 2.0  # px, from which on the images are none of a pair


@dataclass(frozen=True)
class PairCalibration:
    """The result of a calibration of two cameras.

    Attributes:
        pair: Both cameras, and how their images are rectified.
        rotation: 3x3, from the left to the right optical frame.
        translation: (3,) m, likewise: R and T of cv2.stereoCalibrate.
        error: The epipolar error in px: the RMS difference of the rows in which the rectified
            images show the same point, of all pairs that are used.
        errors: The same of each view, in px, also of those that were refused.
        used: Whether each view is used, (n,) bool; others do not fit the pair.
    """

    pair: StereoCamera
    rotation: np.ndarray
    translation: np.ndarray
    error: float
    errors: np.ndarray
    used: np.ndarray


class _Rays(NamedTuple):
    """Of a view the points on the board, (n, 3) m, and x / z and y / z of them in both cameras."""

    points: np.ndarray
    left: np.ndarray
    right: np.ndarray


def calibrate_pair(views: Sequence[PairView], cameras: Sequence[CameraModel]) -> PairCalibration:
    """Computes the pair from views of a board, and leaves out those that do not fit the others.

    The cameras stay as they are. cv2.stereoCalibrate gets the rays of the points instead of their
    pixels, so that every lens is as good.

    Args:
        views: The views.
        cameras: The left and the right camera.

    Raises:
        ValueError: There are too few views, they are none of two cameras that are fixed to each
            other, or the right camera is not to the right of the left one.
    """
    if len(views) < MIN_PAIRS:
        raise ValueError(f"{len(views)} pairs with the board, {MIN_PAIRS} are needed at least")
    rays = [_rays_of(view, cameras) for view in views]
    used = np.ones(len(views), bool)
    while True:
        found, misfits = _solve(rays, used, cameras)
        limit = max(LARGE_ERROR * np.median(misfits[used]), MIN_REFUSED_ERROR)
        worst = misfits[used].max()
        if worst <= limit:
            break
        # What does not fit spoils the errors of all others, so that the worst is left out first.
        used = used & (misfits <= max(limit, worst / 2.0))
        if used.sum() < max(MIN_PAIRS, len(views) / 2.0):
            raise ValueError(_apart(misfits[~used].min()))
    if _rms(misfits[used]) > MAX_ERROR:
        raise ValueError(_apart(_rms(misfits[used])))
    return found


def _apart(error: float) -> str:
    return (
        f"the images of a pair do not fit each other: they differ by {error:.2g} px and more; are "
        "both taken at the same moment, and the cameras fixed to each other?"
    )


def _rays_of(view: PairView, cameras: Sequence[CameraModel]) -> _Rays:
    left, right = (
        camera.rays(seen.pixels) for camera, seen in zip(cameras, (view.left, view.right))
    )
    there = np.isfinite(left).all(axis=1) & np.isfinite(right).all(axis=1)
    return _Rays(view.left.points[there], left[there], right[there])


def _solve(
    rays: Sequence[_Rays], used: np.ndarray, cameras: Sequence[CameraModel]
) -> Tuple[PairCalibration, np.ndarray]:
    """Returns the pair by the views that are used, and how much, px, each view does not fit it."""
    of_used = [view for view, is_used in zip(rays, used) if is_used]
    error, rotation, translation = _place(of_used, cameras)
    problem = _not_beside(rotation, translation)
    if problem:  # Where the views do not fit, they do not tell where the cameras are either.
        raise ValueError(problem if error < MAX_ERROR else _apart(error))
    pair = calibrated_pair(*cameras, rotation, translation)
    pixels = [
        (_rectified(pair.left, view.left), _rectified(pair.right, view.right)) for view in rays
    ]
    rows = [left[:, 1] - right[:, 1] for left, right in pixels]
    error = _rms(np.concatenate([one for one, is_used in zip(rows, used) if is_used]))
    errors = np.array([_rms(one) for one in rows])
    found = PairCalibration(pair, rotation, translation, error, errors, used)
    shifts = [_shift(pair.geometry, view, *seen) for view, seen in zip(rays, pixels)]
    return found, np.maximum(errors, np.abs(shifts))


def _place(
    rays: Sequence[_Rays], cameras: Sequence[CameraModel]
) -> Tuple[float, np.ndarray, np.ndarray]:
    """Returns the RMS error, px, and R, 3x3, and T, (3,) m, from the left to the right frame."""
    focal = np.mean([np.array(camera.K)[[0, 1], [0, 1]] for camera in cameras])
    ideal, none = np.diag([focal, focal, 1.0]), np.zeros(5)
    points, left, right = (
        [part.astype(np.float32) for part in parts]
        for parts in zip(*((one.points, focal * one.left, focal * one.right) for one in rays))
    )
    size = cameras[0].width, cameras[0].height
    try:
        found = cv2.stereoCalibrate(
            *(points, left, right, ideal, none, ideal, none, size),
            flags=cv2.CALIB_FIX_INTRINSIC,
            criteria=END,
        )
    except cv2.error as error:
        raise ValueError(f"the views do not fit two cameras: {error.err}") from None
    error, rotation, translation = found[0], found[5], found[6].ravel()
    if not np.isfinite(translation).all():
        raise ValueError("the views do not fit two cameras")
    return error, rotation, translation


def _not_beside(rotation: np.ndarray, translation: np.ndarray) -> str:
    """Returns what is wrong with the place of the right camera, or ""."""
    x, y, z = place = -rotation.T @ translation  # seen from the left camera
    if abs(x) < max(abs(y), abs(z)):
        where = ", ".join(f"{part:.3g}" for part in place)
        return f"the right camera is at x, y, z = {where} m of the left one, must be beside it"
    if x < 0.0:
        return (
            f"left and right are swapped: the right camera is {-x:.3g} m to the left of the left "
            "one; exchange them"
        )
    return ""


def _rectified(camera: RectifiedCamera, rays: np.ndarray) -> np.ndarray:
    """Returns where the rectified image shows rays, (n, 2): (n, 2) px."""
    turned = np.column_stack([rays, np.ones(len(rays))]) @ np.array(camera.R).T
    projected = turned @ np.array(camera.P)[:, :3].T
    return projected[:, :2] / projected[:, 2:]


def _shift(geometry: StereoGeometry, view: _Rays, left: np.ndarray, right: np.ndarray) -> float:
    """Returns by how many px the disparities are too small for a board of this size.

    They are if the board has moved along the rows from the one image to the other. What is seen
    at too small a disparity seems to be farther away, and so larger, in the same proportion.
    """
    disparities = left[:, 0] - right[:, 0] - geometry.offset
    if (disparities <= 0.0).any():  # This is no place of a board.
        return MAX_SHIFT
    depths = geometry.fx * geometry.baseline / disparities
    on_plane = (left - (geometry.cx, geometry.cy)) / (geometry.fx, geometry.fy)
    points = depths[:, None] * np.column_stack([on_plane, np.ones(len(left))])
    return float(disparities.mean() * (_extent(points) / _extent(view.points) - 1.0))


def _extent(points: np.ndarray) -> float:
    return float(np.linalg.norm(points - points.mean(axis=0)))


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.square(values).mean()))
