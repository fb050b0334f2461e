"""Faces in images: finding them, cutting them out, and normalizing them for a recogniser."""

import functools
import threading
from typing import Optional, Tuple

import cv2
import numpy as np

from .._core import FaceDetector, FaceParams

Box = Tuple[int, int, int, int]  # x, y, width, height in px

SIDE = 100  # px, side of a normalized face
MARGIN = 0.5  # margin around the face in a portrait, as a share of the face's size
PORTRAIT_SIDE = 400  # px, longer side of the largest portrait
SEARCH_SIDE = 640  # px, longer side to which a larger image is reduced for a search
MAX_SIDE_RATIO = 2  # longest side of a box, as a multiple of the image's longer side


def check_box(image: np.ndarray, box: Box) -> None:
    """Raises ValueError if a box is empty, outside the image, or far larger than the image."""
    x, y, width, height = box
    rows, columns = image.shape[:2]
    if width <= 0 or height <= 0 or x + width <= 0 or y + height <= 0 or x >= columns or y >= rows:
        raise ValueError(
            f"the box {width}x{height} at ({x}, {y}) is not in the image of {columns}x{rows}"
        )
    most = MAX_SIDE_RATIO * max(rows, columns)
    if max(width, height) > most:
        raise ValueError(f"the box {width}x{height}, must have sides of at most {most} px")


def cut_out(image: np.ndarray, box: Box, margin: float = 0.0) -> np.ndarray:
    """Returns the pixels of a box; outside the image they repeat its border.

    Args:
        image: (height, width) or (height, width, 3).
        box: The box around a face.
        margin: The margin that is cut out around the box, as a share of its size.

    Raises:
        ValueError: check_box() refuses the box.
    """
    check_box(image, box)
    return _cut_out(image, box, margin)


def _cut_out(image: np.ndarray, box: Box, margin: float) -> np.ndarray:
    x, y, width, height = box
    across, down = round(margin * width), round(margin * height)
    left, top, right, bottom = x - across, y - down, x + width + across, y + height + down
    rows, columns = image.shape[:2]
    inside = image[max(top, 0) : max(bottom, 0), max(left, 0) : max(right, 0)]
    borders = max(-top, 0), max(bottom - rows, 0), max(-left, 0), max(right - columns, 0)
    return cv2.copyMakeBorder(inside, *borders, cv2.BORDER_REPLICATE)


def _cut_out_small(image: np.ndarray, box: Box, side: int, margin: float = 0.0) -> np.ndarray:
    """Returns what cut_out() does, reduced to some 2 * `side` px if it is larger than the image.

    What is repeated outside of a large image would take hundreds of megabytes.
    """
    check_box(image, box)
    longer = (1.0 + 2.0 * margin) * max(box[2:])
    scale = 2.0 * side / longer
    if scale >= 1.0 or longer <= max(image.shape[:2]):
        return _cut_out(image, box, margin)
    x, y, width, height, rows, columns = (
        round(scale * value) for value in (*box, *image.shape[:2])
    )
    width, height, rows, columns = (max(1, value) for value in (width, height, rows, columns))
    # A box that touches the image still does.
    x, y = min(max(x, 1 - width), columns - 1), min(max(y, 1 - height), rows - 1)
    reduced = cv2.resize(image, (columns, rows), interpolation=cv2.INTER_AREA)
    return _cut_out(reduced, (x, y, width, height), margin)


def normalized(image: np.ndarray, box: Box) -> np.ndarray:
    """Returns a face in the form that all recognisers get, independent of its size and lighting.

    Args:
        image: (height, width) gray or (height, width, 3) BGR, uint8.
        box: The box around the face.

    Returns:
        (SIDE, SIDE) uint8, gray, equalised, and smoothed against the noise that would dominate
        local binary patterns.

    Raises:
        ValueError: check_box() refuses the box.
    """
    face = gray(_cut_out_small(image, box, SIDE))
    shrinks = min(face.shape) > SIDE
    face = cv2.resize(
        face, (SIDE, SIDE), interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    )
    return cv2.equalizeHist(cv2.GaussianBlur(face, (5, 5), 0.0))


def portrait(image: np.ndarray, box: Optional[Box] = None) -> np.ndarray:
    """Returns an image of one face with a margin around it, small enough to be stored.

    Args:
        image: (height, width, 3) BGR or (height, width) gray, uint8.
        box: The box around the face. None takes the largest face.

    Raises:
        ValueError: There is no face, or check_box() refuses the box.
    """
    face = _cut_out_small(image, box or _require_face(image), PORTRAIT_SIDE, MARGIN)
    rows, columns = face.shape[:2]
    scale = min(1.0, PORTRAIT_SIDE / max(rows, columns))
    size = max(1, round(columns * scale)), max(1, round(rows * scale))
    return cv2.resize(face, size, interpolation=cv2.INTER_AREA) if scale < 1.0 else face


def face_of(image: np.ndarray) -> np.ndarray:
    """Returns the largest face of an image, normalized.

    Raises:
        ValueError: There is no face.
    """
    return normalized(image, _require_face(image))


def _require_face(image: np.ndarray) -> Box:
    box = find_face(image)
    if box is None:
        raise ValueError("no face is found in it")
    return box


def gray(image: np.ndarray) -> np.ndarray:
    """Returns a gray or BGR image in gray."""
    return image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)


def find_face(image: np.ndarray) -> Optional[Box]:
    """Returns the box of the largest face in an image, gray or BGR, uint8; None if there is none.

    A face that fills the image is found too; its box may then extend beyond the image.
    """
    gray_image = gray(image)
    # The detector needs some margin around a face.
    for border in (0, max(gray_image.shape) // 4):
        wider = cv2.copyMakeBorder(gray_image, *[border] * 4, cv2.BORDER_REPLICATE)
        box = _largest_face(wider)
        if box:
            x, y, width, height = box
            return x - border, y - border, width, height
    return None


def _largest_face(image: np.ndarray) -> Optional[Box]:
    scale = max(*image.shape, SEARCH_SIDE) / SEARCH_SIDE
    rows, columns = image.shape
    size = max(1, round(columns / scale)), max(1, round(rows / scale))
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    with _detecting:
        faces = _detector().detect(small, "mono8")
    if not faces:
        return None
    x, y, width, height = (round(value * scale) for value in faces[0].box)
    return x, y, width, height


_detecting = threading.Lock()  # A detector can be used by one thread at a time.


@functools.lru_cache(maxsize=None)
def _detector() -> FaceDetector:
    params = FaceParams()
    params.cascade_2 = ""  # The cascade of profiles, by which nobody can be recognised.
    params.scale_factor = 1.1
    params.min_neighbors = 4
    return FaceDetector(params)
