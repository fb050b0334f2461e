"""What is to be printed, in millimetres."""

from dataclasses import dataclass, field
from typing import Iterator, List, Tuple

import numpy as np

INCH = 25.4  # mm

Bar = Tuple[float, float, float, float]  # x, y, width, height, mm


@dataclass(frozen=True)
class Text:
    """A line of text in the middle of `x`, on the base line `y`; `size` (mm) is its font's."""

    text: str
    x: float
    y: float
    size: float


@dataclass
class Drawing:
    """A page: black bars and text on white; x goes right and y down from its top left corner."""

    width: float  # mm
    height: float  # mm
    bars: List[Bar] = field(default_factory=list)
    texts: List[Text] = field(default_factory=list)

    def add_cells(self, cells: np.ndarray, x: float, y: float, cell: float) -> None:
        """Draws the True ones of (rows, columns) cells, each `cell` mm to a side."""
        for row, begin, end in runs(cells):
            self.bars.append((x + begin * cell, y + row * cell, (end - begin) * cell, cell))


def runs(cells: np.ndarray) -> Iterator[Tuple[int, int, int]]:
    """The row, the first column and the column after the last, of cells that touch in a row."""
    edges = np.diff(np.pad(cells, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    begins, ends = np.argwhere(edges > 0), np.argwhere(edges < 0)
    for (row, begin), (_, end) in zip(begins.tolist(), ends.tolist()):
        yield row, begin, end
