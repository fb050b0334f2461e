"""Computes a camera's parameters from views of a board, with OpenCV's solvers."""

from dataclasses import dataclass
from typing import List, Sequence, Tuple

import numpy as np

from ..common import opencv as cv2
from .boards import Observation

MIN_VIEWS = 5
FISHEYE_FOCALS = (0.3, 0.4, 0.5, 0.7)  # initial focal lengths, as shares of the image's longer side
MODELS = ("plumb_bob", "rational_polynomial", "equidistant")
PARAMETERS = ("fx", "fy", "cx", "cy")
COEFFICIENTS = {
    "plumb_bob": ("k1", "k2", "p1", "p2", "k3"),
    "rational_polynomial": ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    "equidistant": ("k1", "k2", "k3", "k4"),
}


@dataclass(frozen=True)
class Calibration:
    """The result of a calibration, with the conventions of sensor_msgs/CameraInfo.

    Attributes:
        size: The width and height of the images in px.
        model: The distortion_model.
        K: The 3x3 camera matrix in px.
        D: The distortion coefficients.
        P: The 3x4 projection matrix in px of a rectified image without invalid pixels.
        deviations: The standard deviations of fx, fy, cx, cy (px) and D, estimated from the
            residuals; 0 for values that were not estimated.
        error: The RMS reprojection error in px.
        errors: The RMS reprojection error of each view in px.
    """

    size: Tuple[int, int]
    model: str
    K: np.ndarray
    D: np.ndarray
    P: np.ndarray
    deviations: np.ndarray
    error: float
    errors: np.ndarray


def calibrate(
    observations: Sequence[Observation], size: Tuple[int, int], model: str, third: bool = False
) -> Calibration:
    """Computes the camera from views of a board in images of `size`, (width, height) px.

    Args:
        observations: The views.
        size: The width and height of the images in px.
        model: One of MODELS.
        third: Whether to estimate the third radial coefficient of plumb_bob, which needs many
            views; otherwise it is 0.

    Raises:
        ValueError: There are too few views, or no camera fits them.
    """
    if len(observations) < MIN_VIEWS:
        raise ValueError(f"{len(observations)} views of the board, {MIN_VIEWS} are needed at least")
    solve = _solve_fisheye if model == "equidistant" else _solve_pinhole
    try:
        matrix, distortion, deviations, errors = solve(observations, size, model, third)
        projection = _projection(matrix, distortion, size, model)
    except cv2.error as error:
        raise ValueError(f"the views do not fit a camera ({model}): {error.err}") from None
    if not all(np.isfinite(values).all() for values in (matrix, distortion, errors)):
        raise ValueError(f"the views do not fit a camera ({model})")
    counts = [len(one.points) for one in observations]
    error = float(np.sqrt(np.average(np.square(errors), weights=counts)))
    return Calibration(size, model, matrix, distortion, projection, deviations, error, errors)


Solution = Tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]  # K, D, deviations, errors


def _solve_pinhole(
    observations: Sequence[Observation], size: Tuple[int, int], model: str, third: bool
) -> Solution:
    flags = 0 if third else cv2.CALIB_FIX_K3
    if model == "rational_polynomial":
        flags = cv2.CALIB_RATIONAL_MODEL
    points = [one.points.astype(np.float32) for one in observations]
    pixels = [one.pixels.astype(np.float32) for one in observations]
    _, matrix, distortion, _, _, deviations, _, errors = cv2.calibrateCameraExtended(
        points, pixels, size, None, None, flags=flags
    )
    count = len(COEFFICIENTS[model])
    return (
        matrix,
        distortion.ravel()[:count],
        deviations.ravel()[: len(PARAMETERS) + count],
        errors.ravel(),
    )


def _solve_fisheye(
    observations: Sequence[Observation], size: Tuple[int, int], _model: str, _third: bool
) -> Solution:
    points = [one.points[None].astype(float) for one in observations]
    pixels = [one.pixels[None].astype(float) for one in observations]
    _, matrix, distortion, turns, shifts = _best_fisheye(points, pixels, size)
    normal, residuals = np.zeros((8, 8)), []
    for on_board, seen, turn, shift in zip(points, pixels, turns, shifts):
        expected, jacobian = cv2.fisheye.projectPoints(on_board, turn, shift, matrix, distortion)
        residuals.append((seen - expected).reshape(-1, 2))
        normal += _without_pose(jacobian[:, :8], jacobian[:, 8:14])
    return matrix, distortion.ravel(), _deviations(normal, residuals), _rms(residuals)


def _best_fisheye(
    points: List[np.ndarray], pixels: List[np.ndarray], size: Tuple[int, int]
) -> Tuple[float, np.ndarray, np.ndarray, List[np.ndarray], List[np.ndarray]]:
    """Returns the best cv2.fisheye.calibrate(), which fails from some initial focal lengths."""
    flags = (
        cv2.fisheye.CALIB_USE_INTRINSIC_GUESS
        | cv2.fisheye.CALIB_RECOMPUTE_EXTRINSIC
        | cv2.fisheye.CALIB_FIX_SKEW
    )
    end = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-9)
    solutions, problem = [], None
    column, row = size[0] / 2.0 - 0.5, size[1] / 2.0 - 0.5
    for share in FISHEYE_FOCALS:
        focal = share * max(size)
        matrix = np.array([[focal, 0.0, column], [0.0, focal, row], [0.0, 0.0, 1.0]])
        try:
            solutions.append(
                cv2.fisheye.calibrate(
                    points, pixels, size, matrix, np.zeros((4, 1)), flags=flags, criteria=end
                )
            )
        except cv2.error as error:
            problem = error
    if not solutions:
        raise problem
    return min(solutions, key=lambda solution: solution[0])


def _without_pose(camera: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Returns the information, (8, 8), of a view on the camera, reduced by the view's own pose."""
    return camera.T @ (camera - pose @ np.linalg.lstsq(pose, camera, rcond=None)[0])


def _deviations(normal: np.ndarray, residuals: List[np.ndarray]) -> np.ndarray:
    values = np.concatenate(residuals).ravel()
    degrees_of_freedom = max(len(values) - len(normal) - 6 * len(residuals), 1)
    return np.sqrt(np.diag(np.linalg.pinv(normal)) * (values @ values / degrees_of_freedom))


def _rms(residuals: List[np.ndarray]) -> np.ndarray:
    """Returns the RMS residual of each view in px."""
    return np.array([np.sqrt((one**2).sum(axis=1).mean()) for one in residuals])


def _projection(
    matrix: np.ndarray, distortion: np.ndarray, size: Tuple[int, int], model: str
) -> np.ndarray:
    if model == "equidistant":
        new = cv2.fisheye.estimateNewCameraMatrixForUndistortRectify(
            matrix, distortion, size, np.eye(3)
        )
    else:
        new, _ = cv2.getOptimalNewCameraMatrix(matrix, distortion, size, 0.0)
    return np.hstack([new, np.zeros((3, 1))])
