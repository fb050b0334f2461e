"""Poses, which the core gives as 4x4 matrices, as messages and as transforms."""

import numpy as np
import rospy
from geometry_msgs.msg import (
    Point,
    Pose,
    PoseWithCovariance,
    Quaternion,
    Transform,
    TransformStamped,
    Vector3,
)
from std_msgs.msg import Header

from ..common.rotations import quaternion_of


def pose_of(matrix: np.ndarray) -> Pose:
    """Converts a 4x4 matrix to a Pose."""
    turn = quaternion_of(matrix[:3, :3])
    return Pose(Point(*matrix[:3, 3].tolist()), Quaternion(*turn.tolist()))


def with_covariance(matrix: np.ndarray, covariance: np.ndarray) -> PoseWithCovariance:
    """Converts a 4x4 matrix and its 6x6 covariance (m, rad; the axes of the frame around it)."""
    return PoseWithCovariance(pose_of(matrix), np.ravel(covariance).tolist())


def transform_of(header: Header, name: str, matrix: np.ndarray) -> TransformStamped:
    """Converts a 4x4 matrix to the transform of the frame `name`, as transform_at() does."""
    return transform_at(header, name, pose_of(matrix))


def transform_at(header: Header, name: str, pose: Pose) -> TransformStamped:
    """Returns the transform of the frame `name`, which has a pose in the frame of the header.

    Without a stamp it is of the present time: tf2 keeps the first transform of each stamp.
    """
    stamp = rospy.Time.now() if header.stamp.is_zero() else header.stamp
    place = Vector3(pose.position.x, pose.position.y, pose.position.z)
    return TransformStamped(
        Header(header.seq, stamp, header.frame_id), name, Transform(place, pose.orientation)
    )
