"""Calibrations as the files that camera_info_manager loads when a camera starts."""

import os
from operator import index
from typing import Any, Dict, List, Tuple

import numpy as np
import yaml

from .. import CameraModel, validate_rectification
from ..common.errors import about
from ..common.files import MAX_TEXT, read_file
from ..common.yaml_text import load_yaml
from .solving import Calibration

MATRICES = {  # the rows and columns
    "camera_matrix": (3, 3),
    "rectification_matrix": (3, 3),
    "projection_matrix": (3, 4),
}
DISTORTION = "distortion_coefficients"
MAX_COEFFICIENTS = 14  # of OpenCV's models


def default_path(camera_name: str) -> str:
    """Returns the path where a camera of this name looks for its calibration by default."""
    home = os.environ.get("ROS_HOME") or os.path.join(os.path.expanduser("~"), ".ros")
    return os.path.join(home, "camera_info", camera_name + ".yaml")


def as_yaml(calibration: Calibration, camera_name: str) -> str:
    """Returns the text of the calibration file.

    Raises:
        ValueError: The calibration is impossible, so that no camera would accept the file.
    """
    camera = CameraModel(*calibration.size, calibration.K, calibration.D, calibration.model)
    return camera_yaml(camera, np.eye(3), calibration.P, camera_name)


def camera_yaml(
    camera: CameraModel, rotation: np.ndarray, projection: np.ndarray, camera_name: str
) -> str:
    """Returns the text of a camera's file with the R, 3x3, and P, 3x4, of its rectified images.

    Raises:
        ValueError: No camera has such an R or P.
    """
    validate_rectification(rotation, projection)
    lines = [
        f"image_width: {camera.width}",
        f"image_height: {camera.height}",
        "camera_name: " + yaml.safe_dump(camera_name, default_style='"').strip(),
        *_matrix("camera_matrix", np.reshape(camera.K, (3, 3))),
        f"distortion_model: {camera.distortion_model or 'plumb_bob'}",
        *_matrix(DISTORTION, np.reshape(camera.D, (1, -1))),
        *_matrix("rectification_matrix", np.reshape(rotation, (3, 3))),
        *_matrix("projection_matrix", np.reshape(projection, (3, 4))),
    ]
    return "\n".join(lines) + "\n"


def read_camera(path: str) -> CameraModel:
    """Reads the camera of a calibration file, without its R and P.

    Raises:
        ValueError: The file is none of a calibrated camera; the message has its path.
        OSError: It cannot be read.
    """
    text = read_file(path, MAX_TEXT)
    with about(path):
        values = load_yaml(text.decode())
        try:
            _require_matrices(values)
            return CameraModel(
                values["image_width"],
                values["image_height"],
                values["camera_matrix"]["data"],
                values[DISTORTION]["data"],
                values.get("distortion_model", "plumb_bob"),  # which old files do not name
            )
        except (KeyError, TypeError):
            raise ValueError("it is no calibration of a camera") from None


def _require_matrices(values: Dict[str, Any]) -> None:
    """Raises ValueError unless a camera node would take the sizes of the matrices, too."""
    for name, (rows, columns) in MATRICES.items():
        size = _size_of(values[name])
        _require(size == (rows, columns, rows * columns), name, size, f"{rows}x{columns}")
    rows, columns, numbers = size = _size_of(values[DISTORTION])
    bounded = min(size) >= 0 and max(size) <= MAX_COEFFICIENTS
    ok = bounded and rows * columns == numbers
    _require(ok, DISTORTION, size, f"1x0 to 1x{MAX_COEFFICIENTS}")


def _size_of(matrix: Dict[str, Any]) -> Tuple[int, int, int]:
    """Returns the rows, the columns and the count of the numbers of a file's matrix."""
    return index(matrix["rows"]), index(matrix["cols"]), len(matrix["data"])


def _require(ok: bool, name: str, size: Tuple[int, int, int], expected: str) -> None:
    if not ok:
        is_size = "{}x{} with {} numbers".format(*size)
        raise ValueError(f"{name} is {is_size}, must be {expected} with as many")


def _matrix(name: str, values: np.ndarray) -> List[str]:
    rows, columns = values.shape
    data = ", ".join(repr(float(value)) for value in values.ravel())
    return [f"{name}:", f"  rows: {rows}", f"  cols: {columns}", f"  data: [{data}]"]
