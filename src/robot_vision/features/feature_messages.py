"""Keypoints, their matches and the reference that is found, as messages."""

import numpy as np
import rospy
from geometry_msgs.msg import Point

from .. import _core
from ..common import opencv as cv2
from ..msg import Detection, KeypointMatches, Keypoints
from ..ros.messages import box_around, points
from ..ros.transport import Frame


def keypoints_message(frame: Frame, detector: str, found: _core.Keypoints) -> Keypoints:
    """Returns the keypoints of a frame as a message."""
    x, y = found.points.T.tolist()
    return Keypoints(
        header=frame.header,
        detector=detector,
        x=x,
        y=y,
        size=found.sizes.tolist(),
        angle=found.angles.tolist(),
        response=found.responses.tolist(),
        octave=found.octaves.tolist(),
    )


def matches_message(
    frame: Frame, reference: str, stamp: rospy.Time, found: _core.KeypointMatches
) -> KeypointMatches:
    """Returns the matches of a frame with a reference, or with the frame of `stamp`."""
    pose = found.pose
    return KeypointMatches(
        header=frame.header,
        reference=reference,
        reference_stamp=stamp,
        reference_points=points(found.reference_points),
        points=points(found.points),
        distances=found.distances,
        inliers=found.inliers.tolist(),
        found=pose is not None,
        homography=pose.homography.ravel().tolist() if pose else [0.0] * 9,
    )


def reference_detection(frame: Frame, label: str, found: _core.KeypointMatches) -> Detection:
    """Returns the reference that was found in a frame; its outline may reach out of the image."""
    pose = found.pose
    return Detection(
        label=label,
        id=-1,
        score=found.inliers.mean(),
        box=box_around(pose.outline, frame.image),
        center=Point(*pose.center, 0.0),
        outline=points(pose.outline),
        area=cv2.contourArea(pose.outline.astype(np.float32)),
    )
