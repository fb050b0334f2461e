"""The pose of a calibration board.

The board's frame is that of a tag: its origin is in the middle of the points, x goes right along
the rows, y up and z out of the board, for somebody who looks at it.
"""

import math
from typing import List, NamedTuple, Optional

import numpy as np

from .. import CameraModel
from ..common import opencv as cv2
from .boards import Board, Observation

MIN_POINTS = 4
ITERATIONS = 10  # of the refinement, at most
SMALL_STEP = 1e-9  # rad and m, at which it ends
MAX_GAP = 1.0  # s without the board, after which its orientation is chosen anew


class BoardPose(NamedTuple):
    """A pose of a board in the camera's optical frame, (4, 4) m, and its RMS error in px."""

    pose: np.ndarray
    error: float


def in_board_frame(board: Board, points: np.ndarray) -> np.ndarray:
    """Returns points as Board has them, (n, 3) m, in the board's frame."""
    middle = (board.points.min(axis=0) + board.points.max(axis=0)) / 2.0
    return (points - middle) * (1.0, -1.0, 1.0)


def solve_pose(board: Board, observation: Observation, camera: CameraModel) -> Optional[BoardPose]:
    """Returns the pose with the least squared error of the pixels; None if there is none.

    It begins with cv2.solvePnP on rays without distortion, so that every lens is as good.
    """
    points = in_board_frame(board, observation.points)
    rays = camera.rays(observation.pixels)
    seen = np.isfinite(rays).all(axis=1)
    points, rays, pixels = points[seen], rays[seen], observation.pixels[seen]
    if len(points) < MIN_POINTS:
        return None
    try:
        found, turn, shift = cv2.solvePnP(points, rays, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE)
    except cv2.error:  # For instance, all points are on one line.
        return None
    if not found:
        return None
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = cv2.Rodrigues(turn)[0], shift[:, 0]
    error = _refine(pose, points, pixels, camera)
    if not np.isfinite(pose).all() or not math.isfinite(error):
        return None
    if (
        pose[:3, 2] @ pose[:3, 3] > 0.0
    ):  # The points are numbered upwards, and nobody sees the back.
        pose[:3, 1:3] *= -1.0
    return BoardPose(pose, error)


def _refine(pose: np.ndarray, points: np.ndarray, pixels: np.ndarray, camera: CameraModel) -> float:
    """Moves the pose to the least squared error by Gauss-Newton; returns the RMS error in px."""
    for _ in range(ITERATIONS):
        turned = points @ pose[:3, :3].T
        projected, jacobian = camera.project(turned + pose[:3, 3])
        by_turn = np.cross(turned[:, None, :], jacobian)  # (n, 2, 3): how a small turn moves pixels
        design = np.concatenate([by_turn, jacobian], axis=2).reshape(-1, 6)
        if not np.isfinite(design).all():
            return math.inf
        step = np.linalg.lstsq(design, (pixels - projected).ravel(), rcond=None)[0]
        pose[:3, :3] = cv2.Rodrigues(step[:3])[0] @ pose[:3, :3]
        pose[:3, 3] += step[3:]
        if np.abs(step).max() < SMALL_STEP:
            break
    projected, _ = camera.project(points @ pose[:3, :3].T + pose[:3, 3])
    return float(np.sqrt(((pixels - projected) ** 2).sum(axis=1).mean()))


def quarter_turns(kind: str, columns: int, rows: int, board: Board) -> List[int]:
    """Returns by how many quarter turns a board looks the same; 0 is always one of them.

    Args:
        kind: The board's name in BOARDS.
        columns: The number of its points in a row.
        rows: The number of its rows.
        board: The board.
    """
    if kind == "charuco":  # Its markers tell.
        return [0]
    flat = in_board_frame(board, board.points)[:, :2]
    step = np.abs(flat[1] - flat[0]).max()
    same = [
        turns for turns in range(4) if _has_all(flat, flat @ rotation_of(turns)[:2, :2].T, step)
    ]
    if kind != "chessboard":
        return same
    # Between its corners a chessboard has black and white squares, which trade places.
    blacks_stay = {0: True, 1: columns % 2 == 0, 2: (columns + rows) % 2 == 0, 3: columns % 2 == 0}
    return [turns for turns in same if blacks_stay[turns]]


class Orientation:
    """Of the poses that look alike, chooses the one that goes on from frame to frame.

    The first one is that whose y axis points most upwards in the image.

    Args:
        turns: The numbers of quarter turns after which the board looks the same.
    """

    def __init__(self, turns: List[int]):
        self._turns = [rotation_of(number) for number in turns]
        self._last: Optional[np.ndarray] = None
        self._time = -math.inf  # s, of the last pose

    def continued(self, time: float, pose: np.ndarray) -> np.ndarray:
        """Returns the pose in the frame of a time in s, turned about the board's z axis."""
        if not 0.0 <= time - self._time <= MAX_GAP:
            self._last = None
        self._time = time
        upright = np.diag([1.0, -1.0, -1.0])
        before = upright if self._last is None else self._last
        # The trace of the rotation between two poses is the larger the less it turns.
        chosen = max(self._turns, key=lambda turn: np.trace(before.T @ pose[:3, :3] @ turn))
        continued = pose.copy()
        continued[:3, :3] = pose[:3, :3] @ chosen
        self._last = continued[:3, :3]
        return continued


def rotation_of(quarters: int) -> np.ndarray:
    """Returns a rotation about z by so many quarter turns, (3, 3)."""
    cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarters]
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _has_all(points: np.ndarray, others: np.ndarray, step: float) -> bool:
    """Whether each of the others, (n, 2), is where one of the points is, which are a step apart."""
    here, there = (set(map(tuple, np.rint(4.0 * of / step).astype(int))) for of in (points, others))
    return there <= here
