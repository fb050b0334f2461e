"""Tables and what stands on them, drawn into the depth image in which they were found."""

from typing import Optional, Sequence

import numpy as np

from .. import CameraModel, Table, TableObject, draw_outline, draw_text
from .table_markers import size_text

HULL = (255.0, 160.0, 40.0)  # BGR
COLORS = np.array(  # BGR, which objects have in turn
    [(80, 230, 60), (60, 90, 250), (40, 210, 250), (230, 80, 220), (220, 210, 60), (60, 150, 255)],
    np.uint8,
)
MAX_COORDINATE = 1e6  # px, that is drawn
# The corners of a box from -1 to 1: of the bottom, and in the same order of the top.
CORNERS = np.array([(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def draw_tables(
    bgr: np.ndarray, tables: Sequence[Table], labels: np.ndarray, camera: CameraModel
) -> None:
    """Draws hulls and sizes of tables, and tints objects and draws their boxes.

    Args:
        bgr: The image, (height, width, 3) uint8, which is changed.
        tables: The tables.
        labels: Which pixel is of which object, as the finder gives them.
        camera: The camera.
    """
    objects = [thing for table in tables for thing in table.objects]
    shown = (labels > 0) & (labels <= len(objects))
    bgr[shown] = bgr[shown] // 2 + COLORS[(labels[shown] - 1) % len(COLORS)] // 2
    for table in tables:
        _draw(bgr, table.plane.hull, camera, "", HULL)
        middle = _pixels(table.pose[:3, 3:].T, camera)
        if middle is not None:
            draw_text(bgr, size_text(table.size), tuple(middle[0].tolist()), HULL)
    for number, thing in enumerate(objects):
        _draw_box(bgr, thing, camera, number)


def _draw_box(bgr: np.ndarray, thing: TableObject, camera: CameraModel, number: int) -> None:
    corners = (0.5 * thing.size * CORNERS) @ thing.pose[:3, :3].T + thing.pose[:3, 3]
    color = COLORS[number % len(COLORS)].tolist()
    bottom, top = corners[:4], corners[4:]
    for edge in zip(bottom, top):
        _draw(bgr, np.array(edge), camera, "", color)
    _draw(bgr, bottom, camera, "", color)
    _draw(bgr, top, camera, f"{number}: {size_text(thing.size)}", color)


def _draw(
    bgr: np.ndarray, points: np.ndarray, camera: CameraModel, label: str, color: Sequence[float]
) -> None:
    """Draws a closed polygon of points in the optical frame, (n, 3) m, if it is seen as a whole."""
    pixels = _pixels(points, camera)
    if pixels is not None:
        draw_outline(bgr, pixels, label, tuple(color))


def _pixels(points: np.ndarray, camera: CameraModel) -> Optional[np.ndarray]:
    pixels, _ = camera.project(points)
    if not (np.abs(pixels) < MAX_COORDINATE).all():
        return None
    return np.rint(pixels).astype(int)
