"""Finds a calibration board in each frame of a camera, fast enough for all of them."""

import math
from dataclasses import dataclass
from typing import Optional, Tuple

import numpy as np

from ..common import opencv as cv2
from ..common.plain_text import brief
from ..common.ranges import require_range
from .boards import BOARDS, Board, Observation, charuco

MIN_MARGIN = 16  # px around the last place of the board where it is looked for first
GROWTH = 0.5  # of this place on each side, as a share of its size


@dataclass(frozen=True)
class BoardParams:
    """A calibration board, and where it is looked for.

    Raises:
        ValueError: A field is out of range; the message has its name, its value and the range.
    """

    board: str = "chessboard"  # or circles, acircles, charuco
    columns: int = 8  # inner corners of a row, circles, or squares of a ChArUco board; 3 to 100
    rows: int = 6  # 3 to 100
    square: float = 0.025  # m, side of a square, or from circle to circle; 0.0001 to 10
    marker: float = 0.018  # m, charuco: side of a marker; less than square
    dictionary: str = "4x4_50"  # charuco: of the markers
    search_size: int = (
        320  # px, longer side of the image in which a chessboard is found; 64 to 8192
    )
    search_period: float = 0.25  # s between searches of the image in its full size; 0 to 60

    def __post_init__(self) -> None:
        if self.board not in BOARDS:
            raise ValueError(f"board is {brief(self.board)}, must be {_listed()}")
        if not 0 < len(self.dictionary) <= 40 or not self.dictionary.isprintable():
            what = brief(self.dictionary)
            raise ValueError(f"dictionary is {what}, must be one of OpenCV's, such as 4x4_50")
        for name, low, high in (("columns", 3, 100), ("rows", 3, 100), ("search_size", 64, 8192)):
            require_range(name, getattr(self, name), low, high)
        require_range("square", self.square, 0.0001, 10.0)
        require_range("marker", self.marker, 0.0001, 10.0)
        require_range("search_period", self.search_period, 0.0, 60.0)
        if self.board == "charuco" and self.marker >= self.square:
            raise ValueError(f"marker is {self.marker:g}, must be below square, {self.square:g}")


def make_board(params: BoardParams) -> Board:
    """Returns the board.

    Raises:
        ValueError: OpenCV cannot find such a board.
    """
    size = params.columns, params.rows
    if params.board == "charuco":
        return charuco(*size, params.square, params.marker, params.dictionary)
    return BOARDS[params.board](*size, params.square)


class BoardSearch:
    """Finds a board in one frame after the other.

    It is looked for where it was, then in the whole image; both are made smaller first if the
    board's points can be refined in the full image. As small boards are lost so, and points that
    come into sight beyond the place of those seen before, the image is searched in its full size
    now and then.

    Args:
        board: The board to look for.
        search_size: The longer side in px of the images that are searched.
        search_period: The time in s between searches of an image in its full size.
    """

    def __init__(self, board: Board, search_size: int, search_period: float):
        self._board = board
        self._search_size = search_size
        self._search_period = search_period
        self._shape: Optional[Tuple[int, int]] = None  # of the last frame
        self._last: Optional[Tuple[slice, slice]] = None  # its rows and columns around the board
        self._last_full = -math.inf  # s, the last search of an image in its full size

    def find(self, time: float, gray: np.ndarray) -> Optional[Observation]:
        """Finds the board in the frame of a time in s, (height, width) uint8; None: not there."""
        if gray.shape != self._shape:
            self._shape, self._last = gray.shape, None
        whole = slice(0, gray.shape[0]), slice(0, gray.shape[1])
        is_due = not 0.0 <= time - self._last_full < self._search_period
        found = self._find_in(gray, self._last) if self._last else None
        if found is not None:
            if is_due and len(found.points) < len(self._board.points):
                self._last_full = time
                found = max(found, self._board.find(gray) or found, key=_count)
        else:
            found = self._find_in(gray, whole)
            if found is None and is_due and self._scale(gray.shape) < 1.0:
                self._last_full = time
                found = self._board.find(gray)
        self._last = _around(found.pixels, gray.shape) if found else None
        return found

    def _scale(self, shape: Tuple[int, int]) -> float:
        return min(self._search_size / max(shape), 1.0) if self._board.refine else 1.0

    def _find_in(self, gray: np.ndarray, part: Tuple[slice, slice]) -> Optional[Observation]:
        cut = np.ascontiguousarray(gray[part])
        scale = self._scale(cut.shape)
        if scale < 1.0:
            size = max(round(cut.shape[1] * scale), 1), max(round(cut.shape[0] * scale), 1)
            cut = cv2.resize(cut, size, interpolation=cv2.INTER_AREA)
        found = self._board.find(cut)
        if found is None:
            return None
        # Positions count from the centre of the first pixel, in either size.
        pixels = (found.pixels + 0.5) / scale - 0.5 + (part[1].start, part[0].start)
        if scale < 1.0:
            pixels = self._board.refine(gray, pixels)
        return Observation(found.points, pixels)


def _around(pixels: np.ndarray, shape: Tuple[int, int]) -> Tuple[slice, slice]:
    """Returns the part of an image around points, with room for them to move."""
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    margin = np.maximum(GROWTH * (high - low), MIN_MARGIN)
    left, top = np.maximum(low - margin, 0.0).astype(int)
    right, bottom = np.minimum(high + margin + 1.0, shape[::-1]).astype(int)
    return slice(top, bottom), slice(left, right)


def _count(found: Observation) -> int:
    return len(found.points)


def _listed() -> str:
    *names, last = BOARDS
    return f"{', '.join(names)} or {last}"
