"""Tables and what stands on them as messages and transforms."""

from typing import List, Sequence

import numpy as np
from geometry_msgs.msg import Point, Vector3
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

from .. import CameraModel, PlaneParams
from .. import Table as FoundTable
from ..msg import Detection3D, Detection3DArray, Table, TableArray
from ..ros.messages import region_of
from ..ros.poses import pose_of, transform_of, with_covariance
from .box_covariance import box_covariance

LABEL = "object"


def hull_of(table: FoundTable) -> np.ndarray:
    """Returns the corners of a table's hull in its own frame, (n, 3) m; z is 0."""
    corners = (table.plane.hull - table.pose[:3, 3]) @ table.pose[:3, :3]
    corners[:, 2] = 0.0  # which but for rounding they are
    return corners


def table_array(header: Header, tables: Sequence[FoundTable]) -> TableArray:
    """Returns the tables of an image as a message."""
    found: List[Table] = []
    for table in tables:
        corners = [Point(*corner) for corner in hull_of(table).tolist()]
        found.append(Table(header, pose_of(table.pose), corners))
    return TableArray(header, found)


def object_array(
    header: Header, tables: Sequence[FoundTable], camera: CameraModel, noise: PlaneParams
) -> Detection3DArray:
    """Returns what stands on tables as a message, table by table."""
    found: List[Detection3D] = []
    for table in tables:
        for thing in table.objects:
            z = thing.pose[2, 3]
            deviation = noise.noise * z * z + noise.min_noise
            size = thing.size.tolist()
            covariance = box_covariance(thing.pose, size, table.size, camera, deviation)
            found.append(
                Detection3D(
                    label=LABEL,
                    id=-1,
                    score=1.0,
                    box=region_of(thing.box),
                    pose=with_covariance(thing.pose, covariance),
                    has_orientation=True,
                    size=Vector3(*size),
                    pixels=thing.pixels,
                )
            )
    return Detection3DArray(header=header, detections=found)


def transforms(header: Header, name: str, tables: Sequence[FoundTable]) -> TFMessage:
    """Returns the transforms of the frames <name>_0, <name>_1, ... of tables."""
    return TFMessage(
        [
            transform_of(header, f"{name}_{number}", table.pose)
            for number, table in enumerate(tables)
        ]
    )
