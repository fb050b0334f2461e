"""How well the pose of a box on a table is known."""

import math
from typing import Sequence

import numpy as np

from .. import CameraModel

EDGE_ERROR = 0.5  # px, standard deviation of where the side of a box is seen
UNKNOWN = math.pi**2 / 12.0  # rad^2, variance of a direction of which nothing is known


def box_covariance(
    pose: np.ndarray,
    size: Sequence[float],
    table_size: Sequence[float],
    camera: CameraModel,
    deviation: float,
) -> np.ndarray:
    """The 6x6 covariance of a pose (m, rad) with the axes of the camera's optical frame.

    The middle of a box is between its sides, each of which is seen by few pixels. So its error is
    that of one pixel: along the ray that of the depth, across it that of an edge in the image. The
    box is as tilted as its table, whose narrower side is the lever of these errors. About the
    normal the lever is what the box is longer than wide: a direction along the longer side says
    nothing of a box that has none.

    Args:
        pose: 4x4, of the box in the camera's optical frame, z the normal of its table.
        size: Of the box along its axes, m.
        table_size: Of the table, m.
        camera: The camera.
        deviation: The standard deviation of a depth at the box, m.
    """
    place = pose[:3, 3]
    ray = place / place[2]
    across = EDGE_ERROR * place[2] / np.array([camera.K[0, 0], camera.K[1, 1]])
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = deviation**2 * np.outer(ray, ray) + np.diag([*across**2, 0.0])
    error = math.hypot(deviation, across.max())
    tilt, turn = (_variance(error, lever) for lever in (min(table_size), size[0] - size[1]))
    scaled = pose[:3, :3] * np.sqrt([tilt, tilt, turn])
    covariance[3:, 3:] = scaled @ scaled.T
    return covariance


def _variance(error: float, lever: float) -> float:
    """The variance of a direction (rad^2) between two ends with this error (m)."""
    return min(UNKNOWN, (2.0 * error / lever) ** 2) if lever > 0.0 else UNKNOWN
