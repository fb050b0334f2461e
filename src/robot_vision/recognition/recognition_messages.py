"""What was recognized as messages, and as transforms."""

from typing import List, Optional, Sequence

import numpy as np
from geometry_msgs.msg import Point, PoseWithCovarianceStamped
from sensor_msgs.msg import PointCloud2, PointField
from shape_msgs.msg import Mesh as MeshMessage
from shape_msgs.msg import MeshTriangle
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

from .. import CameraModel, DepthErrorParams, Mesh, depth_deviation
from ..depth.places import label_in_frames
from ..msg import (
    Detection,
    DetectionArray,
    ObjectInformation,
    ObjectType,
    RecognizedObject,
    RecognizedObjectArray,
)
from ..ros.messages import points, region_of
from ..ros.poses import transform_of, with_covariance
from .found import Found, Look, database_json
from .looks import Looks

SURFACE = 0.01  # m, by which depths of an object may be before or behind its surface, or
DEVIATIONS = 3.0  # standard deviations of these depths, if that is more
# Of the corners of a box: pairs of triangles, one side after the other, seen from outside.
SIDES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def object_array(
    header: Header, found: Sequence[Found], database: str, clouds: Sequence[np.ndarray]
) -> RecognizedObjectArray:
    """Returns what was recognized in an image.

    Args:
        header: That of the image.
        found: The objects.
        database: The path of the database.
        clouds: (n, 3) m, the points of the depth image that show each of them.
    """
    db = database_json(database)
    objects = [_recognized(header, one, db, cloud) for one, cloud in zip(found, clouds)]
    return RecognizedObjectArray(header=header, objects=objects)


def _recognized(header: Header, one: Found, db: str, cloud: np.ndarray) -> RecognizedObject:
    corners = one.object.corners
    return RecognizedObject(
        header=header,
        type=ObjectType(one.object.id, db),
        confidence=one.probability,
        point_clouds=[point_cloud(header, cloud)] if len(cloud) else [],
        bounding_mesh=shape(corners, _triangles_of_box()),
        bounding_contours=[Point(*corner) for corner in corners.tolist()],
        pose=PoseWithCovarianceStamped(header, with_covariance(one.pose, one.covariance)),
    )


def _triangles_of_box() -> np.ndarray:
    return np.array([(a, *rest) for a, b, c, d in SIDES for rest in ((b, c), (c, d))])


def shape(vertices: np.ndarray, triangles: np.ndarray) -> MeshMessage:
    """Returns vertices, (n, 3) m, and triangles, (n, 3), as a message."""
    return MeshMessage(
        [MeshTriangle(corners) for corners in np.asarray(triangles).tolist()],
        [Point(*vertex) for vertex in np.asarray(vertices, float).tolist()],
    )


def point_cloud(header: Header, places: np.ndarray, colors: Sequence = ()) -> PointCloud2:
    """Returns points, (n, 3) m, as a cloud; with colors, (n, 3) uint8 BGR, if there are any."""
    names = ["x", "y", "z", *["rgb"] * bool(len(colors))]
    made = np.empty(len(places), [(name, "<f4") for name in names])
    for index, name in enumerate("xyz"):
        made[name] = places[:, index]
    if len(colors):
        padded = np.zeros((len(places), 4), np.uint8)
        padded[:, :3] = colors
        made["rgb"] = padded.view("<f4")[:, 0]
    return PointCloud2(
        header=header,
        height=1,
        width=len(places),
        fields=[PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate(names)],
        point_step=made.itemsize,
        row_step=made.nbytes,
        data=made.tobytes(),
        is_dense=True,
    )


def clouds_of(
    found: Sequence[Found],
    depth: Optional[np.ndarray],
    camera: CameraModel,
    looks: Looks,
    errors: DepthErrorParams,
) -> List[np.ndarray]:
    """Returns the points, (n, 3) m, of a depth image that are on the surface of each object.

    Args:
        found: The objects.
        depth: (height, width), uint16 in mm or float32 in m; None: there are none.
        camera: The camera of the depths, without distortion.
        looks: What draws the objects.
        errors: Those of the depths.
    """
    if depth is None:
        return [np.zeros((0, 3))] * len(found)
    matrix = np.asarray(camera.K)
    clouds = []
    for one in found:
        look = looks.of(one, camera, False)
        x, y, width, height = look.box
        z = depth[y : y + height, x : x + width]
        z = z * np.float32(0.001) if z.dtype == np.uint16 else z
        surface = max(SURFACE, DEVIATIONS * depth_deviation(one.middle[2], errors))
        with np.errstate(invalid="ignore"):
            rows, columns = np.nonzero(np.abs(z - look.depth) < surface)
        z = z[rows, columns]
        rays = np.column_stack(
            [
                (columns + x - matrix[0, 2]) / matrix[0, 0],
                (rows + y - matrix[1, 2]) / matrix[1, 1],
                np.ones(len(z)),
            ]
        )
        clouds.append(rays * z[:, None])
    return clouds


def detection_array(
    header: Header, size: Sequence[int], found: Sequence[Found], looks: Sequence[Look]
) -> DetectionArray:
    """Returns where in an image of `size`, (width, height), objects were found."""
    width, height = size
    made = [_detection(one, look) for one, look in zip(found, looks) if look.box[2]]
    return DetectionArray(header=header, width=width, height=height, detections=made)


def _detection(one: Found, look: Look) -> Detection:
    rows, columns = np.nonzero(np.isfinite(look.depth))
    return Detection(
        label=one.object.name,
        id=-1,
        score=one.probability,
        box=region_of(look.box),
        center=Point(look.box[0] + columns.mean(), look.box[1] + rows.mean(), 0.0),
        outline=points(look.outline),
        area=len(rows),
    )


def transforms(
    header: Header, found: Sequence[Found], numbers: Sequence[int], prefix: str
) -> TFMessage:
    """Returns the transforms of objects that were found: coke_0, coke_1, ...

    Args:
        header: That of the image.
        found: The objects.
        numbers: Of each, among those with its label.
        prefix: Of the names.
    """
    names = [prefix + label_in_frames(one.object.name) for one in found]
    return TFMessage(
        [
            transform_of(header, f"{name}_{number}", one.pose)
            for name, number, one in zip(names, numbers, found)
        ]
    )


def information(name: str, mesh: Mesh) -> ObjectInformation:
    """Returns what is known of an object, with all of its mesh."""
    vertices, colors = np.asarray(mesh.vertices), np.asarray(mesh.colors)
    if not len(colors):
        colors = np.tile(np.asarray(mesh.color, np.uint8), (len(vertices), 1))
    cloud = point_cloud(Header(), vertices, colors)
    return ObjectInformation(name, shape(vertices, mesh.triangles), cloud)
