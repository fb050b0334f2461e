"""Warnings and hints about the markers that a user makes."""

import math
import shlex
from typing import Sequence

from .._core import tag_family
from .board import Board
from .drawing import INCH
from .marker import Marker

MIN_CELL = 0.4  # mm, for a camera that is more than a few centimetres away
MIN_DOTS = 3.0  # printed dots per cell, as many as code_reader needs pixels


def require_dots(marker: Marker, dpi: int) -> None:
    """Raises ValueError if the printed cells of a marker would run into each other."""
    dots = marker.cell * dpi / INCH
    if dots < MIN_DOTS:
        raise ValueError(
            f"{marker.label}: a cell has {marker.cell:.2f} mm, {dots:.1f} dots at {dpi} dpi, must "
            f"have {MIN_DOTS:g} dots: {_remedy(marker, MIN_DOTS * INCH / dpi)}"
        )


def require_board_dots(board: Board, dpi: int) -> None:
    """Raises ValueError if the printed cells of a board's markers would run into each other."""
    dots = board.cell * dpi / INCH
    if dots < MIN_DOTS:
        raise ValueError(
            f"{board.label}: a cell of its markers has {board.cell:.2f} mm, {dots:.1f} dots at "
            f"{dpi} dpi, must have {MIN_DOTS:g} dots: take a larger --square and --marker"
        )


def cell_advice(marker: Marker) -> str:
    """Returns a warning about a marker that few cameras can read, or ""."""
    if marker.cell >= MIN_CELL:
        return ""
    return (
        f"{marker.label}: a cell has {marker.cell:.2f} mm, and few cameras read less than "
        f"{MIN_CELL:g} mm: {_remedy(marker, MIN_CELL)}"
    )


def _remedy(marker: Marker, cell: float) -> str:
    """Returns how to get cells of `cell` mm in a QR code; those of tags are never too small."""
    size = math.ceil(marker.size * cell / marker.cell)
    return f"take a --size of {size / 10:g}, a shorter text or another --level"


def words_advice(words: Sequence[str]) -> str:
    """Returns a hint for users who forgot the quotes around a text; "" for a single word."""
    if len(words) < 2:
        return ""
    text = shlex.quote(" ".join(words))
    return f"each of the {len(words)} words has become a marker; for one QR code write {text}"


def tag_size_line(family: str, size: float) -> str:
    """Returns the line of YAML that tells apriltag_detector about tags of `size` mm."""
    facts = tag_family(family)
    is_classic = facts.width - facts.width_at_border == 2
    square = "the black square" if is_classic else "the square inside the black frame"
    return f"tag_size: {size / 1000:g}  # m, side of {square}, for apriltag_detector"
