"""Rotation matrices and quaternions, without SciPy, whose import takes 15 MB."""

import math

import numpy as np


def quaternion_of(rotation: np.ndarray) -> np.ndarray:
    """Returns the quaternion (x, y, z, w) of a (3, 3) rotation matrix, of length 1 and w >= 0."""
    (a, b, c), (d, e, f), (g, h, i) = np.asarray(rotation, float).tolist()
    # Four times the square of each; the others follow from the largest, which is not near 0.
    squares = (1.0 + a - e - i, 1.0 - a + e - i, 1.0 - a - e + i, 1.0 + a + e + i)
    largest = max(squares)
    if largest == squares[3]:
        turn = (h - f, c - g, d - b, largest)
    elif largest == squares[0]:
        turn = (largest, b + d, c + g, h - f)
    elif largest == squares[1]:
        turn = (b + d, largest, f + h, c - g)
    else:
        turn = (c + g, f + h, largest, d - b)
    return np.array(turn) / math.copysign(math.sqrt(sum(part * part for part in turn)), turn[3])


def rotation_of(quaternion: np.ndarray) -> np.ndarray:
    """Returns the (3, 3) rotation matrix of a quaternion (x, y, z, w) of any length but 0.

    Raises:
        ValueError: The quaternion is 0.
    """
    x, y, z, w = np.asarray(quaternion, float).tolist()
    square = x * x + y * y + z * z + w * w
    if square == 0.0:
        raise ValueError("a quaternion of length 0 is no rotation")
    s = 2.0 / square
    return np.array(
        [
            [1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
            [s * (x * y + z * w), 1.0 - s * (x * x + z * z), s * (y * z - x * w)],
            [s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y)],
        ]
    )
