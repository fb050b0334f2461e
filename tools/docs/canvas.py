"""Images side by side, with captions, as small files."""

import pathlib
from typing import Sequence, Tuple

import cv2
import numpy as np

WIDTH = 640  # px, of the widest
LARGEST = 30000  # bytes of a file
PAGE_WIDTH = 1280  # px, of a page of a browser, whose words must be legible
LARGEST_PAGE = 150000  # bytes
QUALITIES = range(90, 30, -2)  # of JPEG, %
GAP = 4  # px between images
STRIP = 20  # px, height of a caption
DARK, RED, BLUE = (50, 40, 40), (0, 0, 230), (230, 60, 0)  # BGR


def bgr_of(image: np.ndarray) -> np.ndarray:
    """A (height, width, 3) copy of a gray or BGR image."""
    return cv2.cvtColor(image, cv2.COLOR_GRAY2BGR) if image.ndim == 2 else image.copy()


def fitted(image: np.ndarray, width: int, height: int) -> np.ndarray:
    """The image as large as fits, in the middle of a white one of this size (px)."""
    scale = min(width / image.shape[1], height / image.shape[0])
    size = round(image.shape[1] * scale), round(image.shape[0] * scale)
    method = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_NEAREST
    inner = bgr_of(cv2.resize(image, size, interpolation=method))
    canvas = np.full((height, width, 3), 255, np.uint8)
    left, top = (width - size[0]) // 2, (height - size[1]) // 2
    canvas[top : top + size[1], left : left + size[0]] = inner
    return canvas


def captioned(image: np.ndarray, caption: str) -> np.ndarray:
    """The image with a line of text above it."""
    strip = np.full((STRIP, image.shape[1], 3), 255, np.uint8)
    write(strip, caption, (2, STRIP - 6))
    return np.vstack([strip, image])


def write(image: np.ndarray, text: str, place: Tuple[int, int], color: Tuple = DARK) -> None:
    """Writes text (ASCII) from the left end of its base line (px)."""
    cv2.putText(image, text, place, cv2.FONT_HERSHEY_DUPLEX, 0.42, color, 1, cv2.LINE_AA)


def beside(
    images: Sequence[np.ndarray],
    captions: Sequence[str] = (),
    columns: int = 0,
    width: int = WIDTH,
) -> np.ndarray:
    """All images in cells of one size, in rows of `columns` (0: one row), `width` px in all."""
    columns = columns or len(images)
    width = (width - GAP * (columns - 1)) // columns
    height = max(round(one.shape[0] * width / one.shape[1]) for one in images)
    cells = [fitted(one, width, height) for one in images]
    if captions:
        cells = [captioned(cell, caption) for cell, caption in zip(cells, captions)]
    rows = []
    for first in range(0, len(cells), columns):
        row = cells[first : first + columns]
        row += [np.full_like(row[0], 255)] * (columns - len(row))
        rows.append(joined(row, axis=1))
    return joined(rows, axis=0)


def joined(images: Sequence[np.ndarray], axis: int) -> np.ndarray:
    """Images with gaps between them, below (axis 0) or beside (1) each other."""
    shape = list(images[0].shape)
    shape[axis] = GAP
    gap = np.full(shape, 255, np.uint8)
    parts = [part for image in images for part in (gap, image)]
    return np.concatenate(parts[1:], axis=axis)


def save(image: np.ndarray, path: pathlib.Path, width: int = WIDTH, largest: int = LARGEST) -> int:
    """Writes a JPEG of the best quality whose file is not too large; its bytes.

    Args:
        image: of at most `width` px.
        path: of the file.
        width: px.
        largest: bytes of the file.

    Raises:
        ValueError: the image is too wide, or too large at every quality.
    """
    if image.shape[1] > width:
        raise ValueError(f"{path.name} would be {image.shape[1]} px wide, of {width}")
    for quality in QUALITIES:
        options = [cv2.IMWRITE_JPEG_QUALITY, quality, cv2.IMWRITE_JPEG_OPTIMIZE, 1]
        data = cv2.imencode(".jpg", image, options)[1].tobytes()
        if len(data) <= largest:
            path.write_bytes(data)
            return len(data)
    raise ValueError(f"{path.name} is larger than {largest} bytes at every quality")
