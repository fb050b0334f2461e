"""ChArUco boards by the ArUco of OpenCV, whose names changed with 4.7."""

from typing import Optional, Sequence, Tuple

import cv2
import numpy as np

FEWEST_CORNERS = 6  # of a board that counts as seen
SURELY = 0.9999  # that markers of the board are among those that are tried
CLEARLY = 0.5  # of the other pattern's misfit, that of the pattern which a picture shows

Markers = Tuple[Sequence[np.ndarray], np.ndarray]  # corners, (1, 4, 2) px each; numbers, (n, 1)


class Charuco:
    """A board of (columns, rows) squares.

    With an even number of rows OpenCV prints another pattern since 4.6: the upper left square, once
    white, is black. Either is found, for either is a part of a board with one more row, which is
    the same in every OpenCV: its upper rows now, its lower rows before.

    Args:
        square: m.
        marker: m, outer side of a marker.
        dictionary: of the markers, as 4x4_50.

    Raises:
        ValueError: OpenCV has no such dictionary or no ArUco, or the board needs more markers.
    """

    def __init__(self, squares: Tuple[int, int], square: float, marker: float, dictionary: str):
        if not hasattr(cv2, "aruco"):
            raise ValueError(
                f"OpenCV {cv2.__version__} has no aruco, which ChArUco boards need: "
                "it is one of the contrib modules"
            )
        columns, rows = squares
        words = _dictionary(dictionary)
        self._count, there = columns * rows // 2, len(words.bytesList)
        if self._count > there:
            raise ValueError(
                f"dictionary {dictionary} has {there} markers, the board {self._count}"
            )
        even = rows % 2 == 0
        self._skipped = (0, columns // 2) if even else (0,)  # markers above the board's own
        self._opencv = _OpenCv((columns, rows + even), square, marker, words)
        self.points = self._opencv.corners  # (n, 3) m: the inner corners

    def find(self, gray: np.ndarray) -> Optional[Tuple[np.ndarray, np.ndarray]]:
        """Indices of the corners that are seen, and where, (n, 2) px; None if they are few."""
        markers = self._of_pattern(*self._opencv.detect(gray))
        if markers is None:
            return None
        corners, ids = self._opencv.interpolate(gray, markers)
        if ids is None or len(ids) < FEWEST_CORNERS:
            return None
        seen = ids.ravel()
        on_a_line = np.linalg.matrix_rank(self.points[seen] - self.points[seen[0]]) < 2
        return None if on_a_line else (seen, corners.reshape(-1, 2))

    def _of_pattern(
        self, corners: Sequence[np.ndarray], numbers: Optional[np.ndarray]
    ) -> Optional[Markers]:
        """The board's markers, numbered by the pattern that is seen; None if it is not clear.

        Without those that are not where the board has them: other boards' and false ones.
        """
        ours = [] if numbers is None else np.flatnonzero(numbers < self._count)
        if not len(ours):
            return None
        every = [([corners[i] for i in ours], numbers[ours] + skipped) for skipped in self._skipped]
        kept = max((self._in_place(*markers) for markers in every), key=len)
        if not len(kept):
            return None
        choices = [([corners[i] for i in kept], numbers[kept]) for corners, numbers in every]
        misfits = [self._misfit(*choice) for choice in choices]
        best = int(np.argmin(misfits))
        others = misfits[:best] + misfits[best + 1 :]
        return choices[best] if all(misfits[best] < CLEARLY * other for other in others) else None

    def _in_place(self, corners: Sequence[np.ndarray], numbers: np.ndarray) -> np.ndarray:
        """Indices of the most markers that one board, seen flat, has within a marker's side."""
        sides = [np.linalg.norm(np.diff(one.reshape(4, 2), axis=0), axis=1) for one in corners]
        away = self._away(corners, numbers, cv2.RANSAC, np.median(sides), SURELY)
        return np.flatnonzero(away.reshape(-1, 4).max(axis=1) < np.median(sides))

    def _misfit(self, corners: Sequence[np.ndarray], numbers: np.ndarray) -> float:
        """How far, RMS px, the markers are from where the board would have them, seen flat."""
        return float(np.sqrt((self._away(corners, numbers) ** 2).mean()))

    def _away(
        self,
        corners: Sequence[np.ndarray],
        numbers: np.ndarray,
        method: int = 0,
        tolerance: float = 0.0,
        confidence: float = 0.0,
    ) -> np.ndarray:
        """How far, px, each corner is from the board that cv2.findHomography fits to them."""
        on_board = np.concatenate([self._opencv.markers[i] for i in numbers.ravel()])[:, :2]
        seen = np.concatenate([one.reshape(4, 2) for one in corners])
        to_picture, _ = cv2.findHomography(on_board, seen, method, tolerance, confidence=confidence)
        if to_picture is None:
            return np.full(len(seen), np.inf)
        there = cv2.perspectiveTransform(on_board[None], to_picture)[0]
        return np.linalg.norm(there - seen, axis=1)


class _OpenCv:
    """A board of (columns, rows) squares by the names that this OpenCV has."""

    def __init__(
        self, squares: Tuple[int, int], square: float, marker: float, words: "cv2.aruco.Dictionary"
    ):
        self._words = words
        self._new = hasattr(cv2.aruco, "CharucoDetector")
        if self._new:
            board = cv2.aruco.CharucoBoard(squares, square, marker, words)
            self._finder = cv2.aruco.ArucoDetector(words)
            self._detector = cv2.aruco.CharucoDetector(board)
            corners, markers = board.getChessboardCorners(), board.getObjPoints()
        else:
            board = cv2.aruco.CharucoBoard_create(*squares, square, marker, words)
            corners, markers = board.chessboardCorners, board.objPoints
        self._board = board
        self.corners = np.array(corners, float).reshape(-1, 3)  # m
        self.markers = np.array(markers, float).reshape(-1, 4, 3)  # m

    def detect(self, gray: np.ndarray) -> Tuple[Sequence[np.ndarray], Optional[np.ndarray]]:
        """Corners and numbers of the markers in a picture."""
        if self._new:
            return self._finder.detectMarkers(gray)[:2]
        return cv2.aruco.detectMarkers(gray, self._words)[:2]

    def interpolate(
        self, gray: np.ndarray, markers: Markers
    ) -> Tuple[Optional[np.ndarray], Optional[np.ndarray]]:
        """The board's corners between markers, and their numbers."""
        corners, numbers = markers
        if self._new:
            return self._detector.detectBoard(gray, markerCorners=corners, markerIds=numbers)[:2]
        return cv2.aruco.interpolateCornersCharuco(corners, numbers, gray, self._board)[1:]


def _dictionary(name: str) -> "cv2.aruco.Dictionary":
    number = getattr(cv2.aruco, "DICT_" + name.upper(), None)
    if number is None:
        known = [key[5:].lower() for key in sorted(vars(cv2.aruco)) if key.startswith("DICT_")]
        raise ValueError(f"dictionary is '{name}', must be one of {', '.join(known)}")
    return cv2.aruco.getPredefinedDictionary(number)
