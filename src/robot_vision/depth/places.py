"""Things with a place: as transforms and as markers for rviz."""

import math
import re
from collections import Counter
from typing import List, Sequence, Set

import numpy as np
import rospy
from geometry_msgs.msg import PoseWithCovariance, Vector3
from std_msgs.msg import ColorRGBA
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from ..common.plain_text import to_ascii
from ..msg import Detection, Detection3D, Detection3DArray
from ..ros.poses import transform_at

ANY_ANGLE = math.pi**2 / 3  # rad^2, variance of an angle that may be any
MIN_SIDE = 0.005  # m, of a marker: rviz shows nothing that is flat
TEXT_HEIGHT = 0.06  # m
LIFETIME = 0.5  # s for which a marker stays after its thing is gone
ORANGE, WHITE = ColorRGBA(1.0, 0.6, 0.1, 0.5), ColorRGBA(1.0, 1.0, 1.0, 1.0)
NAME_LENGTH = 60  # letters of a label in a frame's name


def frame_ids(detections: Sequence[Detection], prefix: str) -> List[str]:
    """Returns the names of the transforms of detections: prefix, label and id, face_3.

    In place of an id below 0 the place among those of that label counts, from 0. The name is ""
    for a detection whose name an earlier one has.
    """
    names: List[str] = []
    taken: Set[str] = set()
    without_id: Counter = Counter()
    for one in detections:
        label = label_in_frames(one.label)
        number = one.id
        if number < 0:
            number = without_id[label]
            without_id[label] += 1
        name = f"{prefix}{label}_{number}"
        names.append("" if name in taken else name)
        taken.add(name)
    return names


def label_in_frames(label: str) -> str:
    """Returns a label as it is in the name of a frame: ASCII letters, digits and lines."""
    plain = re.sub("[^A-Za-z0-9]+", "_", to_ascii(label, NAME_LENGTH)).strip("_")
    return plain or "thing"


def at_position(position: np.ndarray, covariance: np.ndarray) -> PoseWithCovariance:
    """Returns a place, (3,) m, with its (3, 3) covariance and without an orientation."""
    made = PoseWithCovariance()
    point = made.pose.position
    point.x, point.y, point.z = position.tolist()
    made.pose.orientation.w = 1.0
    whole = np.diag([0.0, 0.0, 0.0, ANY_ANGLE, ANY_ANGLE, ANY_ANGLE])
    whole[:3, :3] = covariance
    made.covariance = whole.ravel().tolist()
    return made


def transforms(array: Detection3DArray) -> TFMessage:
    """Returns the transforms of the detections that have one."""
    named = (one for one in array.detections if one.frame_id)
    return TFMessage([transform_at(array.header, one.frame_id, one.pose.pose) for one in named])


def markers(array: Detection3DArray) -> MarkerArray:
    """Returns a box and a text for each detection."""
    made: List[Marker] = []
    for one in array.detections:
        sides = (max(side, MIN_SIDE) for side in (one.size.x, one.size.y, one.size.z))
        box = Marker(type=Marker.CUBE, color=ORANGE, scale=Vector3(*sides), ns="boxes")
        text = Marker(type=Marker.TEXT_VIEW_FACING, color=WHITE, text=title(one), ns="labels")
        text.scale.z = TEXT_HEIGHT
        for marker in (box, text):
            marker.header = array.header
            marker.id = len(made)
            marker.pose = one.pose.pose
            marker.lifetime = rospy.Duration(LIFETIME)
            made.append(marker)
    return MarkerArray(made)


def title(one: Detection3D) -> str:
    """Returns what a detection is and how far away, in ASCII."""
    point = one.pose.pose.position
    distance = math.sqrt(point.x**2 + point.y**2 + point.z**2)
    number = f" {one.id}" if one.id >= 0 else ""
    return f"{to_ascii(one.label, NAME_LENGTH)}{number}: {distance:.2f} m"
