"""Rotation matrices and quaternions, beside SciPy's."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robot_vision.common.rotations import quaternion_of, rotation_of

HALF_TURNS = [  # where three of the four numbers are 0
    Rotation.from_rotvec(np.pi * np.eye(3)[axis]) for axis in range(3)
]
AROUND = [
    *(Rotation.from_rotvec(angle * axis) for angle in (0.0, 1e-9, 1e-4) for axis in np.eye(3)),
    *(Rotation.from_rotvec((np.pi - 1e-7) * axis) for axis in -np.eye(3)),
    *(Rotation.from_quat(one) for one in np.random.default_rng(1).normal(size=(200, 4))),
]


@pytest.mark.parametrize("turn", [*HALF_TURNS, *AROUND])
def test_a_matrix_becomes_the_quaternion_of_the_same_rotation(turn):
    matrix = _matrix(turn)
    quaternion = quaternion_of(matrix)
    assert np.hypot.reduce(quaternion) == pytest.approx(1.0, abs=1e-12) and quaternion[3] >= 0.0
    expected = turn.as_quat()
    assert abs(quaternion @ expected) == pytest.approx(1.0, abs=1e-12)
    assert rotation_of(quaternion) == pytest.approx(matrix, abs=1e-12)


def _matrix(turn):
    """Of SciPy from Ubuntu 20.04 on, whose names for it differ."""
    return turn.apply(np.eye(3)).T


@pytest.mark.parametrize("length", [1e-3, 7.0, -2.0])
def test_a_quaternion_may_have_any_length(length):
    one = np.array([0.1, -0.5, 0.3, 0.8])
    assert rotation_of(one * length) == pytest.approx(_matrix(Rotation.from_quat(one)), abs=1e-12)


def test_a_quaternion_of_length_0_is_refused():
    with pytest.raises(ValueError, match="length 0"):
        rotation_of(np.zeros(4))
