"""Computes a camera's parameters from views of a board, with OpenCV's solvers."""

from dataclasses import dataclass
from typing import List, Sequence, Tuple

import numpy as np

from ..common import opencv as cv2
from .boards import Observation

MIN_VIEWS = 5
FISHEYE_FOCALS = (0.3, 0.4, 0.5, 0.7)  # initial focal lengths, as shares of the image's longer side
# Of what parameters change in the views, relative to each alone; less is a rounding error.
MIN_CHANGE = 1e-9
MIN_SHARE = 1e-3  # of a parameter in what the views do not determine
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
            residuals; 0 for values that were not estimated, infinite for those that the views do
            not determine.
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
    except np.linalg.LinAlgError:
        raise ValueError(f"the views do not fit a camera ({model})") from None
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
    _, matrix, distortion, turns, shifts = cv2.calibrateCamera(
        points, pixels, size, None, None, flags=flags
    )
    distortion = distortion.ravel()[: len(COEFFICIENTS[model])]
    is_estimated = np.ones(len(PARAMETERS) + len(distortion), bool)
    k3 = len(PARAMETERS) + COEFFICIENTS[model].index("k3")
    is_estimated[k3] = not flags & cv2.CALIB_FIX_K3
    derivatives, residuals = [], []
    for one, turn, shift in zip(observations, turns, shifts):
        expected, jacobian = cv2.projectPoints(one.points, turn, shift, matrix, distortion)
        residuals.append(one.pixels - expected.reshape(-1, 2))
        by_camera = jacobian[:, 6:][:, is_estimated]
        derivatives.append(_without_pose(by_camera, jacobian[:, :6]))
    deviations = np.zeros(len(is_estimated))
    deviations[is_estimated] = _deviations(derivatives, residuals)
    return matrix, distortion, deviations, _rms(residuals)


def _solve_fisheye(
    observations: Sequence[Observation], size: Tuple[int, int], _model: str, _third: bool
) -> Solution:
    points = [one.points[None].astype(float) for one in observations]
    pixels = [one.pixels[None].astype(float) for one in observations]
    _, matrix, distortion, turns, shifts = _best_fisheye(points, pixels, size)
    derivatives, residuals = [], []
    for on_board, seen, turn, shift in zip(points, pixels, turns, shifts):
        expected, jacobian = cv2.fisheye.projectPoints(on_board, turn, shift, matrix, distortion)
        residuals.append((seen - expected).reshape(-1, 2))
        derivatives.append(_without_pose(jacobian[:, :8], jacobian[:, 8:14]))
    return matrix, distortion.ravel(), _deviations(derivatives, residuals), _rms(residuals)


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
    """Returns what a view's pose cannot make up for of derivatives by the camera, triangular.

    Its rows stand for the pixels of the view: their products, the information on the camera, are
    the same.
    """
    _require_finite(camera, pose)
    return np.linalg.qr(camera - pose @ np.linalg.lstsq(pose, camera, rcond=None)[0], "r")


def _deviations(derivatives: List[np.ndarray], residuals: List[np.ndarray]) -> np.ndarray:
    """Returns standard deviations by what each view tells, as _without_pose() has it.

    The singular values are those of the derivatives, as in their products what the coefficients
    of a lens change would be lost in rounding errors. A pseudo-inverse would not do: what the
    views do not determine would count as known exactly.
    """
    jacobian, values = np.concatenate(derivatives), np.concatenate(residuals).ravel()
    _require_finite(jacobian)
    degrees_of_freedom = max(len(values) - jacobian.shape[1] - 6 * len(residuals), 1)
    scale = np.linalg.norm(jacobian, axis=0)
    scale[scale == 0.0] = 1.0
    _, changes, directions = np.linalg.svd(jacobian / scale, full_matrices=False)
    is_known = changes > MIN_CHANGE
    known = directions[is_known] / changes[is_known, None]
    deviations = np.sqrt((known**2).sum(axis=0) * (values @ values) / degrees_of_freedom) / scale
    deviations[(directions[~is_known] ** 2).sum(axis=0) > MIN_SHARE] = np.inf
    return deviations


def _require_finite(*arrays: np.ndarray) -> None:
    """Raises LinAlgError where LAPACK might end in an error that NumPy does not know."""
    if not all(np.isfinite(array).all() for array in arrays):
        raise np.linalg.LinAlgError("the derivatives must be finite")


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
