"""Detection of ChArUco boards with OpenCV's ArUco module, whose interface changed with 4.7."""

from typing import Optional, Sequence, Tuple

import numpy as np

from ..common import opencv as cv2
from ..common.aruco import require_markers

MIN_CORNERS = 6  # corners of a board that counts as seen
RANSAC_CONFIDENCE = 0.9999  # probability that RANSAC tries a sample of the board's own markers only
MAX_MISFIT = 0.5  # of the pattern that is seen, as a share of the other pattern's misfit

Markers = Tuple[Sequence[np.ndarray], np.ndarray]  # corners, (1, 4, 2) px each; ids, (n, 1)


class Charuco:
    """A ChArUco board of (columns, rows) squares.

    With an even number of rows OpenCV prints another pattern since version 4.6: the upper left
    square is black instead of white. Both patterns are found, because both are a part of a board
    with one more row, which is the same in all versions: the new pattern is its upper rows, the
    old one its lower rows.

    Args:
        squares: The numbers of columns and rows.
        square: The side of a square in m.
        marker: The outer side of a marker in m.
        dictionary: The dictionary of the markers, for instance 4x4_50.

    Raises:
        ValueError: OpenCV has no such dictionary or no ArUco module, or the dictionary has fewer
            markers than the board needs.
    """

    def __init__(self, squares: Tuple[int, int], square: float, marker: float, dictionary: str):
        columns, rows = squares
        self._count = columns * rows // 2
        predefined = require_markers(dictionary, self._count)
        even = rows % 2 == 0
        self._skipped = (0, columns // 2) if even else (0,)  # markers above the board, by pattern
        self._opencv = _OpenCv((columns, rows + even), square, marker, predefined)
        self._inner = [self._inner_corners(skipped) for skipped in self._skipped]  # by pattern
        self.points = self._opencv.corners[self._inner[0]]  # (n, 3) m: the inner corners

    def find(self, gray: np.ndarray) -> Optional[Tuple[np.ndarray, np.ndarray]]:
        """Returns the indices and pixels, (n, 2), of the corners seen; None if they are too few."""
        chosen = self._board_markers(*self._opencv.detect(gray))
        if chosen is None:
            return None
        pattern, markers = chosen
        corners, ids = self._opencv.interpolate(gray, markers)
        if ids is None:
            return None
        inner = self._inner[pattern]
        own = np.isin(ids.ravel(), inner)
        seen = np.searchsorted(inner, ids.ravel()[own])
        if len(seen) < MIN_CORNERS:
            return None
        on_a_line = np.linalg.matrix_rank(self.points[seen] - self.points[seen[0]]) < 2
        return None if on_a_line else (seen, corners.reshape(-1, 2)[own])

    def _inner_corners(self, skipped: int) -> np.ndarray:
        """Returns which corners are inside of the pattern before which so many markers are."""
        corners, markers = self._opencv.corners, self._opencv.markers
        own = markers[skipped : skipped + self._count].reshape(-1, 3)[:, :2]
        inside = (corners[:, :2] > own.min(axis=0)) & (corners[:, :2] < own.max(axis=0))
        return np.flatnonzero(inside.all(axis=1))

    def _board_markers(
        self, corners: Sequence[np.ndarray], numbers: Optional[np.ndarray]
    ) -> Optional[Tuple[int, Markers]]:
        """Returns the pattern that is seen, and the board's markers as it numbers them.

        Markers that are not where the board has them, because they are false or belong to other
        boards, are left out. Returns None if it is not clear which pattern is seen.
        """
        own = [] if numbers is None else np.flatnonzero(numbers < self._count)
        if not len(own):
            return None
        candidates = [
            ([corners[i] for i in own], numbers[own] + skipped) for skipped in self._skipped
        ]
        kept = max((self._consistent(*markers) for markers in candidates), key=len)
        if not len(kept):
            return None
        choices = [([corners[i] for i in kept], numbers[kept]) for corners, numbers in candidates]
        misfits = [self._misfit(*choice) for choice in choices]
        best = int(np.argmin(misfits))
        others = misfits[:best] + misfits[best + 1 :]
        is_clear = all(misfits[best] < MAX_MISFIT * other for other in others)
        return (best, choices[best]) if is_clear else None

    def _consistent(self, corners: Sequence[np.ndarray], numbers: np.ndarray) -> np.ndarray:
        """Returns the indices of the largest set of markers that fit one flat board."""
        sides = [np.linalg.norm(np.diff(one.reshape(4, 2), axis=0), axis=1) for one in corners]
        away = self._distances(corners, numbers, cv2.RANSAC, np.median(sides), RANSAC_CONFIDENCE)
        return np.flatnonzero(away.reshape(-1, 4).max(axis=1) < np.median(sides))

    def _misfit(self, corners: Sequence[np.ndarray], numbers: np.ndarray) -> float:
        """Returns the RMS distance in px of the markers' corners from those of a flat board."""
        return float(np.sqrt((self._distances(corners, numbers) ** 2).mean()))

    def _distances(
        self,
        corners: Sequence[np.ndarray],
        numbers: np.ndarray,
        method: int = 0,
        tolerance: float = 0.0,
        confidence: float = 0.0,
    ) -> np.ndarray:
        """Returns the distance in px of each corner from the board that fits all corners best."""
        on_board = np.concatenate([self._opencv.markers[i] for i in numbers.ravel()])[:, :2]
        seen = np.concatenate([one.reshape(4, 2) for one in corners])
        to_image, _ = cv2.findHomography(on_board, seen, method, tolerance, confidence=confidence)
        if to_image is None:
            return np.full(len(seen), np.inf)
        there = cv2.perspectiveTransform(on_board[None], to_image)[0]
        return np.linalg.norm(there - seen, axis=1)


class _OpenCv:
    """A board of (columns, rows) squares, with the functions that this version of OpenCV has."""

    def __init__(
        self,
        squares: Tuple[int, int],
        square: float,
        marker: float,
        dictionary: "cv2.aruco.Dictionary",
    ):
        self._dictionary = dictionary
        self._new = hasattr(cv2.aruco, "CharucoDetector")
        if self._new:
            board = cv2.aruco.CharucoBoard(squares, square, marker, dictionary)
            self._finder = cv2.aruco.ArucoDetector(dictionary)
            self._detector = cv2.aruco.CharucoDetector(board)
            corners, markers = board.getChessboardCorners(), board.getObjPoints()
        else:
            board = cv2.aruco.CharucoBoard_create(*squares, square, marker, dictionary)
            corners, markers = board.chessboardCorners, board.objPoints
        self._board = board
        self.corners = np.array(corners, float).reshape(-1, 3)  # m
        self.markers = np.array(markers, float).reshape(-1, 4, 3)  # m

    def detect(self, gray: np.ndarray) -> Tuple[Sequence[np.ndarray], Optional[np.ndarray]]:
        """Returns corners and ids of the markers in an image."""
        if self._new:
            return self._finder.detectMarkers(gray)[:2]
        return cv2.aruco.detectMarkers(gray, self._dictionary)[:2]

    def interpolate(
        self, gray: np.ndarray, markers: Markers
    ) -> Tuple[Optional[np.ndarray], Optional[np.ndarray]]:
        """Returns the corners of the board between markers, and their ids."""
        corners, numbers = markers
        if self._new:
            return self._detector.detectBoard(gray, markerCorners=corners, markerIds=numbers)[:2]
        return cv2.aruco.interpolateCornersCharuco(corners, numbers, gray, self._board)[1:]
