"""A drawing in millimetres, which is printed."""

from dataclasses import dataclass, field
from typing import Iterator, List, Tuple

import numpy as np

INCH = 25.4  # mm

Bar = Tuple[float, float, float, float]  # x, y, width, height in mm
Disc = Tuple[float, float, float]  # x and y of the centre, and radius in mm


@dataclass(frozen=True)
class Text:
    """A line of text centred at `x`, with the base line `y` and the font size `size`, all in mm."""

    text: str
    x: float
    y: float
    size: float


@dataclass
class Drawing:
    """A page of black bars, discs and text, x to the right and y down from its top left corner."""

    width: float  # mm
    height: float  # mm
    bars: List[Bar] = field(default_factory=list)
    texts: List[Text] = field(default_factory=list)
    discs: List[Disc] = field(default_factory=list)

    def add_cells(self, cells: np.ndarray, x: float, y: float, cell: float) -> None:
        """Draws the cells that are True, (rows, columns), as squares with sides of `cell` mm."""
        for row, begin, end in runs(cells):
            self.bars.append((x + begin * cell, y + row * cell, (end - begin) * cell, cell))


def runs(cells: np.ndarray) -> Iterator[Tuple[int, int, int]]:
    """Yields row, first column and end column of each run of adjacent True cells in a row."""
    edges = np.diff(np.pad(cells, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    begins, ends = np.argwhere(edges > 0), np.argwhere(edges < 0)
    for (row, begin), (_, end) in zip(begins.tolist(), ends.tolist()):
        yield row, begin, end
