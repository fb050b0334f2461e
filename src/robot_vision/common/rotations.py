"""Rotation matrices and quaternions, with SciPy as old as Ubuntu 20.04 has it."""

import cv2
import numpy as np
from scipy.spatial.transform import Rotation


def quaternion_of(rotation: np.ndarray) -> np.ndarray:
    """(x, y, z, w) of a rotation matrix, (3, 3)."""
    return Rotation.from_rotvec(cv2.Rodrigues(rotation)[0][:, 0]).as_quat()


def rotation_of(quaternion: np.ndarray) -> np.ndarray:
    """The rotation matrix, (3, 3), of (x, y, z, w), of any length but 0."""
    return cv2.Rodrigues(Rotation.from_quat(quaternion).as_rotvec())[0]
