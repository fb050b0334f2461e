"""Tags and QR codes as black cells of a size."""

from dataclasses import dataclass

import numpy as np
import qrcode
from qrcode.exceptions import DataOverflowError

from .._core import tag_cells, tag_family
from .drawing import Drawing

QUIET = 4  # white modules that a QR code has around it
LEVELS = {
    "L": qrcode.ERROR_CORRECT_L,
    "M": qrcode.ERROR_CORRECT_M,
    "Q": qrcode.ERROR_CORRECT_Q,
    "H": qrcode.ERROR_CORRECT_H,
}


@dataclass(frozen=True)
class Marker:
    """A marker with the white that it needs around it.

    Attributes:
        cells: (n, n) bool, True where it is black.
        cell: side of a cell, mm.
        size: what people measure, mm: between the corners of a tag that are found, or of a QR
            code without the white around it.
        label: for people.
    """

    cells: np.ndarray
    cell: float
    size: float
    label: str

    @property
    def side(self) -> float:
        """With the white around it, mm."""
        return len(self.cells) * self.cell

    def drawing(self) -> Drawing:
        """The marker by itself."""
        drawing = Drawing(self.side, self.side)
        drawing.add_cells(self.cells, 0.0, 0.0, self.cell)
        return drawing


def tag_marker(family: str, id: int, size: float) -> Marker:
    """An AprilTag; size (mm) is that of apriltag_ros, and of a classic tag its black square's.

    Raises:
        ValueError: there is no such family, or no such tag in it.
    """
    facts = tag_family(family)
    cells = tag_cells(family, id) < 255
    if facts.width - facts.width_at_border > 2:  # its outer cells have a meaning: not to be cut
        cells = np.pad(cells, 1)
    return Marker(cells, size / facts.width_at_border, size, f"{family}  id {id}  {size:g} mm")


def qr_marker(data: bytes, label: str, size: float, level: str = "M") -> Marker:
    """A QR code of the smallest version that holds the data, at one of the LEVELS.

    Raises:
        ValueError: so much data fits no QR code.
    """
    modules = qr_modules(data, level)
    return Marker(np.pad(modules, QUIET), size / len(modules), size, f"{label}  {size:g} mm")


def qr_modules(data: bytes, level: str = "M") -> np.ndarray:
    """The modules of a QR code, (n, n) bool, True where it is black.

    Raises:
        ValueError: so much data fits no QR code.
    """
    code = qrcode.QRCode(error_correction=LEVELS[level], border=0)
    code.add_data(data)
    try:
        code.make(fit=True)
    except (DataOverflowError, ValueError):  # older ones of qrcode say it so, others so
        raise ValueError(f"{len(data)} bytes fit no QR code of level {level}") from None
    return np.array(code.get_matrix(), bool)
