"""Calibrations as the files that camera_info_manager loads when a camera starts."""

import os
from typing import List

import numpy as np
import yaml

from .. import CameraModel, validate_rectification
from ..common.errors import about
from ..common.files import MAX_TEXT, read_file
from ..common.yaml_text import load_yaml
from .solving import Calibration


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
        *_matrix("distortion_coefficients", np.reshape(camera.D, (1, -1))),
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
            return CameraModel(
                values["image_width"],
                values["image_height"],
                values["camera_matrix"]["data"],
                values["distortion_coefficients"]["data"],
                values["distortion_model"],
            )
        except (KeyError, TypeError):
            raise ValueError("it is no calibration of a camera") from None


def _matrix(name: str, values: np.ndarray) -> List[str]:
    rows, columns = values.shape
    data = ", ".join(repr(float(value)) for value in values.ravel())
    return [f"{name}:", f"  rows: {rows}", f"  cols: {columns}", f"  data: [{data}]"]
