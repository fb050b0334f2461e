"""Tags and QR codes as black and white cells of a given size."""

from dataclasses import dataclass

import numpy as np
import qrcode
from qrcode.exceptions import DataOverflowError

from .._core import tag_cells, tag_family
from .drawing import Drawing

QUIET_ZONE = 4  # width of the white border of a QR code, in modules
LEVELS = {
    "L": qrcode.ERROR_CORRECT_L,
    "M": qrcode.ERROR_CORRECT_M,
    "Q": qrcode.ERROR_CORRECT_Q,
    "H": qrcode.ERROR_CORRECT_H,
}


@dataclass(frozen=True)
class Marker:
    """A marker with the white border that it needs.

    Attributes:
        cells: (n, n) bool, True for black cells.
        cell: The side of a cell in mm.
        size: The side that people measure in mm: of a tag, between the corners that detectors
            find; of a QR code, without the white border.
        label: The text for people.
    """

    cells: np.ndarray
    cell: float
    size: float
    label: str

    @property
    def side(self) -> float:
        """The side with the white border in mm."""
        return len(self.cells) * self.cell

    def drawing(self) -> Drawing:
        """Returns a drawing of the marker alone."""
        drawing = Drawing(self.side, self.side)
        drawing.add_cells(self.cells, 0.0, 0.0, self.cell)
        return drawing


def tag_marker(family: str, id: int, size: float) -> Marker:
    """Returns an AprilTag of `size` mm, measured as apriltag_ros does it.

    Of a tag of a classic family that is the side of the black square.

    Raises:
        ValueError: There is no such family, or no such tag in it.
    """
    facts = tag_family(family)
    cells = tag_cells(family, id) < 255
    if facts.width - facts.width_at_border > 2:  # The outer cells are data and must not be cut.
        cells = np.pad(cells, 1)
    return Marker(cells, size / facts.width_at_border, size, f"{family}  id {id}  {size:g} mm")


def qr_marker(data: bytes, label: str, size: float, level: str = "M") -> Marker:
    """Returns the smallest QR code that holds the data, with an error correction of LEVELS.

    Raises:
        ValueError: The data does not fit into any QR code.
    """
    modules = qr_modules(data, level)
    return Marker(np.pad(modules, QUIET_ZONE), size / len(modules), size, f"{label}  {size:g} mm")


def qr_modules(data: bytes, level: str = "M") -> np.ndarray:
    """Returns the modules of a QR code, (n, n) bool, True for black.

    Raises:
        ValueError: The data does not fit into any QR code.
    """
    code = qrcode.QRCode(error_correction=LEVELS[level], border=0)
    code.add_data(data)
    try:
        code.make(fit=True)
    except (DataOverflowError, ValueError):  # Versions of qrcode differ in the error.
        raise ValueError(f"{len(data)} bytes fit no QR code of level {level}") from None
    return np.array(code.get_matrix(), bool)
