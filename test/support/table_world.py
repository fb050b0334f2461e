"""Shared by tests of tables: a camera that looks down at a table with boxes, by exact rays."""

from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np

import robot_vision as rv

PITCH = 0.6  # rad, by which the camera looks down
RIGHT = np.array([1.0, 0.0, 0.0])
AWAY = np.array([0.0, -np.sin(PITCH), np.cos(PITCH)])
UP = np.array([0.0, -np.cos(PITCH), -np.sin(PITCH)])
AXES = np.column_stack([RIGHT, AWAY, UP])  # of the table, in the camera's optical frame
MIDDLE = np.array([0.0, 0.05, 1.1])  # m, of the table
TABLE = 1.0, 0.6  # m, length to the right, and width away from the camera
FLOOR = 0.75  # m, below the table


class Box(NamedTuple):
    """A box on the table: the place of its middle, its size (m), and how it is turned (rad)."""

    x: float
    y: float
    size: Tuple[float, float, float]
    turn: float = 0.0


# The deviation of a depth at 1 m, m, by each sensor with a focal length of some 500 px.
NOISE = {"none": 0.0005, "kinect": 0.002, "stereo": 0.004, "tof": 0.0006}

# The longer side of each is along the table's, or turned from it.
BOXES = (Box(-0.22, 0.0, (0.2, 0.1, 0.15)), Box(0.2, 0.08, (0.16, 0.08, 0.1), 0.4))


def camera_of(width: int, lens: Sequence[float] = ()) -> rv.CameraModel:
    """A camera of 4:3 that sees all of the table."""
    focal, height = 0.85 * width, width * 3 // 4
    matrix = [[focal, 0, 0.5 * width + 0.3], [0, focal, 0.5 * height - 0.7], [0, 0, 1]]
    return rv.CameraModel(width, height, matrix, list(lens))


def table_pose() -> np.ndarray:
    """The table's frame in the camera's optical frame, 4x4: x right, y away, z up."""
    return _matrix(AXES, MIDDLE)


def box_pose(box: Box) -> np.ndarray:
    """The frame of a box, with its origin in the middle."""
    cosine, sine = np.cos(box.turn), np.sin(box.turn)
    turned = AXES @ np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    return _matrix(turned, MIDDLE + AXES @ [box.x, box.y, box.size[2] / 2.0])


def _matrix(axes: np.ndarray, place: np.ndarray) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes, place
    return matrix


def render_depth(
    camera: rv.CameraModel, boxes: Sequence[Box] = BOXES, floor: Optional[float] = FLOOR
) -> np.ndarray:
    """Exact z (m) of what each pixel sees, (height, width) float32, NaN where it sees nothing."""
    v, u = np.mgrid[: camera.height, : camera.width]
    rays = camera.rays(np.column_stack([u.ravel(), v.ravel()]).astype(float))
    rays = np.column_stack([rays, np.ones(len(rays))])
    depths = [_to_rectangle(rays, table_pose(), TABLE)]
    if floor is not None:
        depths.append(_to_rectangle(rays, _matrix(AXES, MIDDLE - floor * UP), (20.0, 20.0)))
    depths += [_to_box(rays, box_pose(box), box.size) for box in boxes]
    nearest = np.min(depths, axis=0)
    nearest[np.isinf(nearest)] = np.nan
    return nearest.reshape(camera.height, camera.width).astype(np.float32)


def _to_rectangle(rays: np.ndarray, pose: np.ndarray, size: Sequence[float]) -> np.ndarray:
    """z of where rays (x, y, 1) meet a rectangle around the origin of a frame; inf: nowhere."""
    along, begin = rays @ pose[:3, :3], -pose[:3, 3] @ pose[:3, :3]
    with np.errstate(divide="ignore", invalid="ignore"):
        z = -begin[2] / along[:, 2]
        inside = np.abs(begin[:2] + z[:, None] * along[:, :2]) <= np.array(size) / 2.0
    return np.where((z > 0.0) & inside.all(axis=1), z, np.inf)


def _to_box(rays: np.ndarray, pose: np.ndarray, size: Sequence[float]) -> np.ndarray:
    along, begin = rays @ pose[:3, :3], -pose[:3, 3] @ pose[:3, :3]
    half = np.array(size) / 2.0
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.sort([(-half - begin) / along, (half - begin) / along], axis=0)
    enter, leave = np.nanmax(ends[0], axis=1), np.nanmin(ends[1], axis=1)
    return np.where((enter > 0.0) & (enter <= leave), enter, np.inf)
