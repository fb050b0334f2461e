"""Which points of a board are seen by both cameras of a pair."""

from typing import Optional, Sequence, Tuple

import numpy as np

from .board_pose import rotation_of
from .boards import Board, Observation

MIN_POINTS = 6  # that both cameras have to see
STEPS = 4  # into which the distance of two points is divided, to tell places from each other


class SamePoints:
    """Finds the points that are seen in both images of a pair.

    A chessboard whose numbers of corners are both even, or both odd, looks the same when it is
    turned by half a turn, and OpenCV may begin to count at one end in the left image and at the
    other in the right one. Of such turns that is chosen with which the board lies most alike in
    both images.

    Args:
        board: The board.
        turns: By how many quarter turns it looks the same, as of board_pose.quarter_turns().
    """

    def __init__(self, board: Board, turns: Sequence[int]):
        flat = board.points[:, :2]
        self._middle = (flat.min(axis=0) + flat.max(axis=0)) / 2.0
        self._step = np.abs(flat[1] - flat[0]).max() / STEPS
        self._turns = [rotation_of(number)[:2, :2] for number in turns]

    def of(
        self, left: Observation, right: Observation
    ) -> Optional[Tuple[Observation, Observation]]:
        """Returns both observations with the same points in the same order; None if too few."""
        flat_left, flat_right = (one.points[:, :2] - self._middle for one in (left, right))
        axes = _axes(flat_left, left.pixels)

        def likeness(turn: np.ndarray) -> float:
            return float((axes * _axes(flat_right @ turn, right.pixels)).sum())

        turned = flat_right @ max(self._turns, key=likeness)
        rows = {place: row for row, place in enumerate(self._places(turned))}
        both = [
            (row, rows[place]) for row, place in enumerate(self._places(flat_left)) if place in rows
        ]
        if len(both) < MIN_POINTS:
            return None
        of_left, of_right = map(list, zip(*both))
        points = left.points[of_left]
        return Observation(points, left.pixels[of_left]), Observation(
            points, right.pixels[of_right]
        )

    def _places(self, flat: np.ndarray) -> Sequence[Tuple[int, ...]]:
        """Returns where points are, counted in small steps from the middle of the board."""
        return [tuple(place) for place in np.rint(flat / self._step).astype(int).tolist()]


def _axes(flat: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    """Returns about where the x and y axis of a board point in an image: (2, 2) px/m."""
    design, seen = flat - flat.mean(axis=0), pixels - pixels.mean(axis=0)
    return np.linalg.lstsq(design, seen, rcond=None)[0]
