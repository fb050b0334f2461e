"""Sheets of markers, to be printed and cut."""

import math
import unicodedata
from typing import Dict, List, Sequence, Tuple

from .drawing import Drawing, Text
from .marker import Marker

PAGES: Dict[str, Tuple[float, float]] = {"A4": (210.0, 297.0), "Letter": (215.9, 279.4)}  # mm
MARGIN = 10.0  # mm, where many printers cannot print
FOOT = 14.0  # mm, height of the ruler's area
LABEL = 5.0  # mm, height of the label below a marker
GAP = 8.0  # mm between markers, with room for the cut marks
LINE = 0.2  # mm, width of a line
RULER = 100.0  # mm


def sheets(markers: Sequence[Marker], page: str) -> List[Drawing]:
    """Returns the pages that the markers need, placed row by row in a grid of the largest one.

    Raises:
        ValueError: A marker is larger than the page.
    """
    width, height = PAGES[page]
    free_width, free_height = width - 2 * MARGIN, height - 2 * MARGIN - FOOT
    side = max(marker.side for marker in markers)
    columns, rows = number(free_width, side), number(free_height, side + LABEL)
    if not columns or not rows:
        raise ValueError(
            f"a marker is {side:.1f} mm wide with the white around it, and on {page} there is room "
            f"for {min(free_width, free_height - LABEL):.1f} mm"
        )
    pages = []
    for first in range(0, len(markers), columns * rows):
        drawing = Drawing(width, height)
        for place, marker in enumerate(markers[first : first + columns * rows]):
            row, column = divmod(place, columns)
            x, y = MARGIN + column * (side + GAP), MARGIN + row * (side + LABEL + GAP)
            add_tile(drawing, marker, x, y)
        add_ruler(drawing)
        pages.append(drawing)
    return pages


def number(room: float, side: float) -> int:
    """Returns how many markers of a side fit into a width or height."""
    return math.floor((room + GAP) / (side + GAP) + 1e-9)


def add_tile(drawing: Drawing, marker: Marker, x: float, y: float) -> None:
    """Adds a marker, its label, and marks outside its corners, along which it is cut out."""
    drawing.add_cells(marker.cells, x, y, marker.cell)
    drawing.texts.append(
        fitting(marker.label, x + marker.side / 2, y + marker.side + LABEL - 1.8, marker.side)
    )
    begin, length = 1.0, GAP / 2 - 1.5  # mm from the corner
    bottom = marker.side + LABEL
    for corner_x, outwards in ((x, -1), (x + marker.side, 1)):
        for corner_y, up in ((y, -1), (y + bottom, 1)):
            left = corner_x + (begin if outwards > 0 else -begin - length)
            top = corner_y + (begin if up > 0 else -begin - length)
            drawing.bars.append((left, corner_y - LINE / 2, length, LINE))
            drawing.bars.append((corner_x - LINE / 2, top, LINE, length))


def fitting(text: str, x: float, y: float, width: float) -> Text:
    """Returns a text that fits into a width; letters are 0.6 of its size wide, Chinese ones 1."""
    letters = sum(1.0 if unicodedata.east_asian_width(letter) in "WF" else 0.6 for letter in text)
    return Text(text, x, y, min(3.0, width / letters))


def add_ruler(drawing: Drawing) -> None:
    """Adds a ruler at the foot of the page; it measures between the left edges of its lines."""
    left, base = MARGIN, drawing.height - MARGIN
    drawing.bars.append((left, base, RULER + LINE, LINE))
    for tick in range(0, int(RULER) + 1, 10):
        high = 4.0 if tick % 50 == 0 else 2.5
        drawing.bars.append((left + tick, base - high, LINE, high))
        if tick % 50 == 0:
            drawing.texts.append(Text(str(tick), left + tick, base - high - 1.0, 2.5))
    room = drawing.width - 2 * MARGIN - RULER - 6.0
    text = "mm. Print at 100 %, then measure this ruler."
    drawing.texts.append(fitting(text, left + RULER + 6.0 + room / 2, base - 1.0, room))
