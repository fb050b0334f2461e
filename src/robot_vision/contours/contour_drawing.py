"""Contours in the overlay."""

from typing import Callable, Dict, Iterable, List, Tuple

import numpy as np

from .. import Contour, TurnedShape, draw_outline
from ..common.drawing import CIRCLE

GREEN, YELLOW, RED = (0.0, 255.0, 0.0), (0.0, 255.0, 255.0), (0.0, 0.0, 255.0)


def draw_contours(overlay: np.ndarray, contours: Iterable[Tuple[Contour, str]], what: str) -> None:
    """Draws what one of the names in DRAWN means of each contour, with its label; holes yellow."""
    for contour, label in contours:
        color = YELLOW if contour.hole else GREEN
        for number, outline in enumerate(DRAWN[what](contour)):
            # Only the hull has others behind it: its defects, as red triangles.
            draw_outline(
                overlay,
                np.rint(outline).astype(int),
                label if number == 0 else "",
                color if number == 0 else RED,
            )


def _turned(shape: TurnedShape, along: np.ndarray, across: np.ndarray) -> np.ndarray:
    """Returns points of a turned shape, (n, 2) px, by their places in half lengths and widths."""
    direction = np.array([np.cos(shape.angle), np.sin(shape.angle)])
    normal = np.array([-direction[1], direction[0]])
    sides = np.outer(along, direction * shape.length), np.outer(across, normal * shape.width)
    return np.array(shape.center) + (sides[0] + sides[1]) / 2.0


def _rectangle(contour: Contour) -> List[np.ndarray]:
    along, across = np.array([-1, 1, 1, -1]), np.array([-1, -1, 1, 1])
    return [_turned(contour.rectangle, along, across)]


def _ellipse(contour: Contour) -> List[np.ndarray]:
    if contour.ellipse is None:
        return []
    return [_turned(contour.ellipse, *CIRCLE.T)]


def _defects(contour: Contour) -> List[np.ndarray]:
    found = [np.array([one.start, one.farthest, one.end]) for one in contour.defects]
    return [contour.hull, *found]


def _line(contour: Contour) -> List[np.ndarray]:
    """Returns the fitted line, as long as the diagonal of the contour's box."""
    half = np.hypot(*contour.box[2:]) / 2.0
    direction = np.array([np.cos(contour.line_angle), np.sin(contour.line_angle)])
    return [np.array(contour.line_point) + np.outer([-half, half], direction)]


DRAWN: Dict[str, Callable[[Contour], List[np.ndarray]]] = {
    "contour": lambda contour: [contour.outline],
    "approximation": lambda contour: [contour.approximation],
    "hull": lambda contour: [contour.hull],
    "defects": _defects,
    "rectangle": _rectangle,
    "ellipse": _ellipse,
    "line": _line,
}
