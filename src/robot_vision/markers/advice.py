"""What people should know of the markers that they make."""

import math
import shlex
from typing import Sequence

from .._core import tag_family
from .drawing import INCH
from .marker import Marker

LEAST_CELL = 0.4  # mm, for a camera that is more than a few centimetres away
LEAST_DOTS = 3.0  # for a cell, as many as code_reader wants pixels


def require_dots(marker: Marker, dpi: int) -> None:
    """Raises ValueError if the cells of a marker run into each other when it is printed."""
    dots = marker.cell * dpi / INCH
    if dots < LEAST_DOTS:
        raise ValueError(
            f"{marker.label}: a cell has {marker.cell:.2f} mm, {dots:.1f} dots at {dpi} dpi, must "
            f"have {LEAST_DOTS:g} dots: {_remedy(marker, LEAST_DOTS * INCH / dpi)}"
        )


def cell_advice(marker: Marker) -> str:
    """What to do about a marker that few cameras can read; empty: nothing."""
    if marker.cell >= LEAST_CELL:
        return ""
    return (
        f"{marker.label}: a cell has {marker.cell:.2f} mm, and few cameras read less than "
        f"{LEAST_CELL:g} mm: {_remedy(marker, LEAST_CELL)}"
    )


def _remedy(marker: Marker, cell: float) -> str:
    """How the cells come to have so many mm; of tags those of all sizes are large enough."""
    size = math.ceil(marker.size * cell / marker.cell)
    return f"take a --size of {size / 10:g}, a shorter text or another --level"


def words_advice(words: Sequence[str]) -> str:
    """For those who have forgotten the quotes around a text; empty: it is but one word."""
    if len(words) < 2:
        return ""
    text = shlex.quote(" ".join(words))
    return f"each of the {len(words)} words has become a marker; for one QR code write {text}"


def tag_size_line(family: str, size: float) -> str:
    """The parameter of apriltag_detector for tags of so many mm, a line of YAML."""
    facts = tag_family(family)
    is_classic = facts.width - facts.width_at_border == 2
    square = "the black square" if is_classic else "the square inside the black frame"
    return f"tag_size: {size / 1000:g}  # m, side of {square}, for apriltag_detector"
