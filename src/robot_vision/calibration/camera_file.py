"""Writes a calibration as the file that camera_info_manager loads when a camera starts."""

import os
from typing import List

import numpy as np
import yaml

from .. import CameraModel, validate_rectification
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
    width, height = calibration.size
    CameraModel(width, height, calibration.K, calibration.D, calibration.model)
    validate_rectification(np.eye(3), calibration.P)
    lines = [
        f"image_width: {width}",
        f"image_height: {height}",
        "camera_name: " + yaml.safe_dump(camera_name, default_style='"').strip(),
        *_matrix("camera_matrix", calibration.K),
        f"distortion_model: {calibration.model}",
        *_matrix("distortion_coefficients", calibration.D[None]),
        *_matrix("rectification_matrix", np.eye(3)),
        *_matrix("projection_matrix", calibration.P),
    ]
    return "\n".join(lines) + "\n"


def _matrix(name: str, values: np.ndarray) -> List[str]:
    rows, columns = values.shape
    data = ", ".join(repr(float(value)) for value in values.ravel())
    return [f"{name}:", f"  rows: {rows}", f"  cols: {columns}", f"  data: [{data}]"]
