"""Calibration boards: where OpenCV finds their points in an image."""

from dataclasses import dataclass, replace
from typing import Callable, Dict, NamedTuple, Optional, Tuple

import numpy as np

from ..common import opencv as cv2
from .charuco import Charuco

SUB_PIXEL_END = (3, 40, 0.001)  # 3: after so many steps, or when they are shorter
MAX_CORNER_WINDOW = 11  # px, half the side of the window in which a corner is refined


class Observation(NamedTuple):
    """The points of a board seen in an image: (n, 3) m on the board, with z = 0, and (n, 2) px."""

    points: np.ndarray
    pixels: np.ndarray


@dataclass(frozen=True)
class Board:
    """A calibration board.

    Attributes:
        points: All points of the board, (n, 3) m.
        finder: A function that finds points in a gray image. It returns their indices and their
            pixels, (n, 2), or None.
        refine: A function that moves pixels, (n, 2), of all points to where they are in a gray
            image, if they have been found in a smaller one. None: that would not do.
    """

    points: np.ndarray
    finder: Callable[[np.ndarray], Optional[Tuple[np.ndarray, np.ndarray]]]
    refine: Optional[Callable[[np.ndarray, np.ndarray], np.ndarray]] = None

    def find(self, gray: np.ndarray) -> Optional[Observation]:
        """Finds the board in an image, (height, width) uint8; returns None if it is not there."""
        found = self.finder(gray)
        if found is None:
            return None
        seen, pixels = found
        return Observation(self.points[seen], pixels)


def chessboard(columns: int, rows: int, square: float) -> Board:
    """Returns a checkerboard with this number of inner corners, and squares of `square` m."""

    def find(gray: np.ndarray) -> Optional[np.ndarray]:
        # CALIB_CB_NORMALIZE_IMAGE finds no more boards, and takes seconds if a part of the board
        # is hidden or the board has another size.
        flags = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_FAST_CHECK
        found, pixels = cv2.findChessboardCorners(gray, (columns, rows), flags=flags)
        return refine(gray, pixels) if found else None

    def refine(gray: np.ndarray, pixels: np.ndarray) -> np.ndarray:
        grid = pixels.reshape(rows, columns, 2)
        nearest = min(np.linalg.norm(np.diff(grid, axis=axis), axis=2).min() for axis in (0, 1))
        half = int(min(max(nearest / 2.0, 2.0), MAX_CORNER_WINDOW))  # No other corner is inside.
        start = pixels.reshape(-1, 1, 2).astype(np.float32)
        return cv2.cornerSubPix(gray, start, (half, half), (-1, -1), SUB_PIXEL_END).reshape(-1, 2)

    return replace(_whole(_grid(columns, rows, square), find), refine=refine)


def circles(columns: int, rows: int, spacing: float) -> Board:
    """Returns a grid of dark circles, whose centres are `spacing` m apart."""
    # CALIB_CB_CLUSTERING would mix up the circles in images of a fisheye lens.
    find = _circle_finder((columns, rows), cv2.CALIB_CB_SYMMETRIC_GRID)
    return _whole(_grid(columns, rows, spacing), find)


def asymmetric_circles(columns: int, rows: int, spacing: float) -> Board:
    """Returns a board of dark circles in rows, of which every other is shifted, as in OpenCV.

    Args:
        columns: The number of circles in a row.
        rows: The number of rows.
        spacing: The distance between neighbouring rows in m; the circles of a row are twice as
            far apart.
    """
    points = _grid(columns, rows, spacing)
    points[:, 0] = 2.0 * points[:, 0] + spacing * (np.repeat(np.arange(rows), columns) % 2)
    return _whole(points, _circle_finder((columns, rows), cv2.CALIB_CB_ASYMMETRIC_GRID))


def charuco(columns: int, rows: int, square: float, marker: float, dictionary: str) -> Board:
    """Returns a checkerboard with ArUco markers of `marker` m in its white squares.

    Raises:
        ValueError: OpenCV has no such dictionary, or no ArUco module.
    """
    board = Charuco((columns, rows), square, marker, dictionary)
    return Board(board.points, board.find)


BOARDS: Dict[str, Callable[..., Board]] = {
    "chessboard": chessboard,
    "circles": circles,
    "acircles": asymmetric_circles,
    "charuco": charuco,
}


def _grid(columns: int, rows: int, spacing: float) -> np.ndarray:
    """Returns grid points, (rows * columns, 3) m, row by row."""
    points = np.zeros((rows, columns, 3))
    points[:, :, 0] = spacing * np.arange(columns)
    points[:, :, 1] = spacing * np.arange(rows)[:, None]
    return points.reshape(-1, 3)


def _whole(points: np.ndarray, find: Callable[[np.ndarray], Optional[np.ndarray]]) -> Board:
    """Returns a board that is found as a whole or not at all."""

    def find_all(gray: np.ndarray) -> Optional[Tuple[np.ndarray, np.ndarray]]:
        pixels = find(gray)
        return None if pixels is None else (np.arange(len(points)), pixels.reshape(-1, 2))

    return Board(points, find_all)


def _circle_finder(
    size: Tuple[int, int], flags: int
) -> Callable[[np.ndarray], Optional[np.ndarray]]:
    def find(gray: np.ndarray) -> Optional[np.ndarray]:
        params = cv2.SimpleBlobDetector_Params()
        params.minArea = 12.0
        params.maxArea = gray.size / (size[0] * size[1])  # OpenCV's limit suits small images only.
        if params.maxArea < params.minArea:
            return None  # In so small an image is no board.
        params.minDistBetweenBlobs = 3.0
        blobs = cv2.SimpleBlobDetector_create(params)
        found, pixels = cv2.findCirclesGrid(gray, size, flags=flags, blobDetector=blobs)
        return pixels if found else None

    return find
