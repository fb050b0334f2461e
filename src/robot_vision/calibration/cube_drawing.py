"""Draws a cube or axes that stand on a board into the image that shows the board."""

from typing import List, Optional, Tuple

import numpy as np

from .. import CameraModel
from ..common import opencv as cv2
from ..common.drawing import FRACTION_BITS, fixed_point

AXES = ((0, 0, 255), (0, 255, 0), (255, 0, 0))  # BGR: x red, y green, z blue
EDGE = (255, 255, 255)
FACE = np.array([230, 140, 40])  # BGR, of a face that is lit
DARKEST = 0.3  # of a face that looks away from the light, as a share of FACE
TO_LIGHT = np.array([0.35, 0.65, 0.68])  # in the board's frame
OPACITY = 0.8  # of the faces
PIECES = 8  # of an edge, which the lens may bend
MAX_COORDINATE = 1e5  # px, that is drawn

# The faces of a cube from 0 to 1, each with its normal and its corners, around it.
FACES: Tuple[Tuple[np.ndarray, np.ndarray], ...] = tuple(
    (
        sign * np.eye(3)[axis],
        np.array(
            [np.roll([max(sign, 0), a, b], axis) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))],
            float,
        ),
    )
    for axis in range(3)
    for sign in (-1, 1)
)


def draw_cube(bgr: np.ndarray, pose: np.ndarray, edge: float, camera: CameraModel) -> None:
    """Draws a cube that stands on the middle of a board, with the faces that the camera sees.

    Args:
        bgr: The image, (height, width, 3) uint8, which is changed.
        pose: The pose of the board in the camera's optical frame, (4, 4) m.
        edge: The length of an edge in m.
        camera: The camera.
    """
    faces = []
    for normal, corners in FACES:
        places = _in_camera(_placed(corners, edge), pose)
        if (pose[:3, :3] @ normal) @ places.mean(axis=0) < 0.0:
            outline = _pixels(_closed(places), camera)
            if outline is None:  # A part is behind the camera: nothing of it can be drawn right.
                return
            faces.append((np.linalg.norm(places.mean(axis=0)), normal, outline))
    faces.sort(key=lambda face: -face[0])  # What is nearer is painted over what is farther.
    painted = bgr.copy()
    for _, normal, outline in faces:
        light = 0.5 + 0.5 * float(normal @ TO_LIGHT)
        color = (FACE * (DARKEST + (1.0 - DARKEST) * light)).tolist()
        cv2.fillPoly(painted, [outline], color, cv2.LINE_AA, FRACTION_BITS)
    cv2.addWeighted(painted, OPACITY, bgr, 1.0 - OPACITY, 0.0, bgr)
    for _, _, outline in faces:
        cv2.polylines(bgr, [outline], True, EDGE, 2, cv2.LINE_AA, FRACTION_BITS)


def draw_axes(bgr: np.ndarray, pose: np.ndarray, length: float, camera: CameraModel) -> None:
    """Draws the axes of a board's frame, `length` m long: x red, y green and z blue."""
    begin = pose[:3, 3]
    ends = begin + length * pose[:3, :3].T
    for axis in np.argsort(-ends[:, 2]):  # from the farthest
        line = _pixels(_line(begin, ends[axis]), camera)
        if line is not None:
            cv2.polylines(bgr, [line], False, AXES[axis], 3, cv2.LINE_AA, FRACTION_BITS)


def _placed(unit: np.ndarray, edge: float) -> np.ndarray:
    """Returns points of a cube from 0 to 1 on that of a board."""
    return edge * (unit - (0.5, 0.5, 0.0))


def _in_camera(points: np.ndarray, pose: np.ndarray) -> np.ndarray:
    return points @ pose[:3, :3].T + pose[:3, 3]


def _line(begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Returns the points between the pieces of a line, (PIECES + 1, 3)."""
    return begin + np.linspace(0.0, 1.0, PIECES + 1)[:, None] * (end - begin)


def _closed(corners: np.ndarray) -> np.ndarray:
    """Returns the points of a closed polygon whose edges are cut into pieces."""
    edges: List[np.ndarray] = [
        _line(begin, end)[:-1] for begin, end in zip(corners, np.roll(corners, -1, axis=0))
    ]
    return np.concatenate(edges)


def _pixels(points: np.ndarray, camera: CameraModel) -> Optional[np.ndarray]:
    """Returns where points of the optical frame are seen, as OpenCV draws; None if they are not."""
    pixels, _ = camera.project(points)
    if not (np.abs(pixels) < MAX_COORDINATE).all():
        return None
    return fixed_point(pixels)
