"""Conversions between rotation matrices and quaternions, for SciPy from Ubuntu 20.04 on."""

import cv2
import numpy as np
from scipy.spatial.transform import Rotation


def quaternion_of(rotation: np.ndarray) -> np.ndarray:
    """Returns the quaternion (x, y, z, w) of a (3, 3) rotation matrix."""
    return Rotation.from_rotvec(cv2.Rodrigues(rotation)[0][:, 0]).as_quat()


def rotation_of(quaternion: np.ndarray) -> np.ndarray:
    """Returns the (3, 3) rotation matrix of a quaternion (x, y, z, w) of any length but 0."""
    return cv2.Rodrigues(Rotation.from_quat(quaternion).as_rotvec())[0]
