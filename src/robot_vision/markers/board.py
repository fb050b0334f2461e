"""Boards to calibrate a camera by, as calibrate_headless.py finds them."""

from dataclasses import dataclass
from typing import Dict, List, Optional, Tuple

import numpy as np

from ..common.aruco import aruco_cells, require_markers
from .drawing import Disc, Drawing, Text
from .sheet import FOOT, MARGIN, PAGES, RULER, add_ruler, fitting

BOARD_PAGES: Dict[str, Tuple[float, float]] = {  # mm
    **PAGES,
    "A3": (297.0, 420.0),
    "A2": (420.0, 594.0),
    "A1": (594.0, 841.0),
    "A0": (841.0, 1189.0),
}
# The kinds, and what calibrate_headless.py calls them.
BOARDS = {
    "checkerboard": "chessboard",
    "circles": "circles",
    "acircles": "acircles",
    "charuco": "charuco",
}
RADIUS = 0.3  # of a circle, as a share of the distance between circles
MARKER = 0.7  # side of a ChArUco marker, as a share of a square
DICTIONARY = "4x4_50"
LABEL_HEIGHT = 6.0  # mm above the foot of the page

Part = Tuple[np.ndarray, float, float, float]  # black cells, x, y and the side of a cell in mm


@dataclass(frozen=True)
class Board:
    """A pattern without the white around it.

    Attributes:
        width: In mm.
        height: In mm.
        parts: Squares and markers.
        discs: Circles.
        cell: The side of the smallest cell in mm.
        label: The text for people.
        words: The arguments by which calibrate_headless.py looks for it.
    """

    width: float
    height: float
    parts: List[Part]
    discs: List[Disc]
    cell: float
    label: str
    words: str


def make_board(
    kind: str,
    columns: int,
    rows: int,
    square: float,
    marker: Optional[float] = None,
    dictionary: Optional[str] = None,
) -> Board:
    """Returns a board of a kind of BOARDS.

    Args:
        kind: The kind.
        columns: Of inner corners of a checkerboard, of circles, or of squares of a ChArUco board.
        rows: The same.
        square: The side of a square in mm, or the distance of circles; of acircles that of rows.
        marker: The side of a ChArUco marker in mm; None: MARKER of a square.
        dictionary: Of the ChArUco markers; None: DICTIONARY.

    Raises:
        ValueError: The marker is as large as a square, or OpenCV has not got the markers.
    """
    label = f"{kind} {columns}x{rows}  {square:g} mm"
    words = f"--board {BOARDS[kind]} --size {columns}x{rows} --square {square / 1000:g}"
    if kind == "charuco":
        side, name = marker or round(MARKER * square, 1), dictionary or DICTIONARY
        parts = _charuco(columns, rows, square, side, name)
        label = f"{label}, markers {name} of {side:g} mm"
        words = f"{words} --marker {side / 1000:g} --dictionary {name}"
        return Board(columns * square, rows * square, parts, [], parts[-1][3], label, words)
    if kind == "checkerboard":
        squares = [(_squares(columns + 1, rows + 1), 0.0, 0.0, square)]
        size = (columns + 1) * square, (rows + 1) * square
        return Board(*size, squares, [], square, label, words)
    shifted = kind == "acircles"
    radius = RADIUS * square
    discs = [
        (radius + square * (2 * x + y % 2 if shifted else x), radius + square * y, radius)
        for y in range(rows)
        for x in range(columns)
    ]
    size = max(x for x, _, _ in discs) + radius, max(y for _, y, _ in discs) + radius
    return Board(*size, [], discs, square, label, words)


def board_sheet(board: Board, page: str) -> Drawing:
    """Returns a page, upright or turned, with the board in the middle of it, and a ruler.

    Raises:
        ValueError: The board is larger than the page.
    """
    short, long = BOARD_PAGES[page]
    ways = [(short, long), (long, short)]
    if board.width > board.height:
        ways.reverse()
    rooms = [(width - 2 * MARGIN, height - 2 * MARGIN - FOOT) for width, height in ways]
    fit = [board.width <= wide + 1e-9 and board.height <= high + 1e-9 for wide, high in rooms]
    if not any(fit):
        there = " or ".join(f"{wide:.1f}x{high:.1f} mm" for wide, high in rooms)
        raise ValueError(
            f"the board has {board.width:.1f}x{board.height:.1f} mm, and on {page} there is room "
            f"for {there}"
        )
    way = fit.index(True)
    drawing, (wide, high) = Drawing(*ways[way]), rooms[way]
    left, top = MARGIN + (wide - board.width) / 2, MARGIN + (high - board.height) / 2
    for cells, x, y, cell in board.parts:
        drawing.add_cells(cells, left + x, top + y, cell)
    drawing.discs += [(left + x, top + y, radius) for x, y, radius in board.discs]
    add_ruler(drawing)
    drawing.texts.append(_label(board.label, drawing))
    return drawing


def _label(text: str, page: Drawing) -> Text:
    """Returns the text beside the ruler, above what is written there."""
    left = MARGIN + RULER + 6.0
    room = page.width - MARGIN - left
    return fitting(text, left + room / 2, page.height - MARGIN - LABEL_HEIGHT, room)


def _squares(columns: int, rows: int) -> np.ndarray:
    """Returns the black squares of a checkerboard, (rows, columns) bool, the first among them."""
    return np.indices((rows, columns)).sum(axis=0) % 2 == 0


def _charuco(columns: int, rows: int, square: float, marker: float, dictionary: str) -> List[Part]:
    """Returns the squares and the markers, which lie in the white squares, row by row.

    The first square is black, as OpenCV has it since 4.6. Before, it was white where the number
    of rows is even.
    """
    if marker >= square:
        raise ValueError(f"marker is {marker:g} mm, must be less than a square, {square:g} mm")
    black = _squares(columns, rows)
    white = np.argwhere(~black)
    found = require_markers(dictionary, len(white))
    margin = (square - marker) / 2
    parts: List[Part] = [(black, 0.0, 0.0, square)]
    for number, (row, column) in enumerate(white.tolist()):
        cells = aruco_cells(found, number)
        side = marker / len(cells)
        parts.append((cells, column * square + margin, row * square + margin, side))
    return parts
