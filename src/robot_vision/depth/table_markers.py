"""Tables and what stands on them as markers for rviz."""

from typing import List, Sequence

import numpy as np
import rospy
from geometry_msgs.msg import Point, Pose, Vector3
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from .. import Table
from ..ros.poses import pose_of
from .table_messages import hull_of

LINE = 0.01  # m, width of the lines of a table
AXIS = 0.15  # m, length of the axes of a table
TEXT_HEIGHT = 0.04  # m
MIN_SIDE = 0.001  # m, of a box, as rviz warns of those without a volume
LIFETIME = 0.5  # s for which a marker stays after what it shows is gone
BLUE, GREEN = ColorRGBA(0.1, 0.4, 1.0, 1.0), ColorRGBA(0.2, 0.9, 0.3, 0.5)
WHITE = ColorRGBA(1.0, 1.0, 1.0, 1.0)
AXES = tuple(ColorRGBA(*row, 1.0) for row in np.eye(3).tolist())  # x red, y green, z blue


def markers(header: Header, tables: Sequence[Table]) -> MarkerArray:
    """Returns the hull and axes of each table, and a box with its size for each object."""
    made: List[Marker] = []
    for number, table in enumerate(tables):
        made += [_hull(table), _axes()]
        for marker in made[-2:]:
            marker.id, marker.pose = number, pose_of(table.pose)
    for number, thing in enumerate(thing for table in tables for thing in table.objects):
        made += [_box(thing.size), _text(number, thing.size)]
        above = np.array([0.0, 0.0, thing.size[2] / 2.0 + TEXT_HEIGHT])
        for marker, offset in zip(made[-2:], (np.zeros(3), above)):
            marker.id, marker.pose = number, _moved(thing.pose, offset)
    for marker in made:
        marker.header = header
        marker.lifetime = rospy.Duration(LIFETIME)
    return MarkerArray(made)


def size_text(size: Sequence[float]) -> str:
    """Returns a size (m) as people read it."""
    return " x ".join(f"{side:.2f}" for side in size) + " m"


def _hull(table: Table) -> Marker:
    corners = [Point(*corner) for corner in hull_of(table).tolist()]
    closed = corners + corners[:1]
    return Marker(
        ns="tables",
        type=Marker.LINE_STRIP,
        color=BLUE,
        scale=Vector3(LINE, 0.0, 0.0),
        points=closed,
    )


def _axes() -> Marker:
    ends = [Point(*end) for end in (AXIS * np.eye(3)).tolist()]
    return Marker(
        ns="axes",
        type=Marker.LINE_LIST,
        color=WHITE,
        scale=Vector3(LINE, 0.0, 0.0),
        points=[point for end in ends for point in (Point(), end)],
        colors=[color for color in AXES for _ in range(2)],
    )


def _box(size: np.ndarray) -> Marker:
    scale = Vector3(*np.maximum(size, MIN_SIDE).tolist())
    return Marker(ns="objects", type=Marker.CUBE, color=GREEN, scale=scale)


def _text(number: int, size: np.ndarray) -> Marker:
    scale = Vector3(0.0, 0.0, TEXT_HEIGHT)
    text = f"{number}: {size_text(size)}"
    return Marker(ns="sizes", type=Marker.TEXT_VIEW_FACING, color=WHITE, scale=scale, text=text)


def _moved(pose: np.ndarray, offset: np.ndarray) -> Pose:
    """Returns a 4x4 pose moved along its own axes (m)."""
    moved = pose.copy()
    moved[:3, 3] += pose[:3, :3] @ offset
    return pose_of(moved)
