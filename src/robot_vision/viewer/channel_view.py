"""The channels of a colour space as an image: what the viewer shows of an image."""

from typing import Tuple

import numpy as np

from .. import color_channels, draw_text, image_to_space

SHOWS = ("bgr", "hsv", "hls", "lab", "ycrcb")  # bgr is the image as it is
STEP = 2  # px of the image from one pixel of a tile to the next
LABEL = (6, 18)  # px, where the text of a tile begins
GREEN = (0, 255, 0)

Rectangle = Tuple[int, int, int, int]  # x, y, width and height in px


class ChannelView:
    """What is shown of images of one size.

    In a space that is an image of about the same size, made of four tiles: every second pixel of
    the image, and beside and below it those of the three channels, whose gray levels are the
    numbers that ranges are given in.

    Args:
        show: One of SHOWS.
        size: (width, height) of the images in px.
    """

    def __init__(self, show: str, size: Tuple[int, int]):
        self._show = show
        self._size = size
        self._tile = tuple(-(-side // STEP) for side in size)

    def of(self, image: np.ndarray) -> np.ndarray:
        """Returns what is shown of an image, (height, width, 3) uint8, BGR."""
        if self._show == "bgr":
            return image
        tiles = [np.ascontiguousarray(image[::STEP, ::STEP])]
        space = image_to_space(tiles[0], self._show)
        for number, (name, _, _) in enumerate(color_channels(self._show)):
            tile = np.repeat(space[:, :, number : number + 1], 3, axis=2)
            draw_text(tile, name.upper(), LABEL, GREEN)
            tiles.append(tile)
        return np.vstack([np.hstack(tiles[:2]), np.hstack(tiles[2:])])

    def pixel(self, x: int, y: int) -> Tuple[int, int]:
        """Returns the pixel of the image that is seen at a place of what is shown."""
        if self._show == "bgr":
            return x, y
        width, height = self._tile
        return x % width * STEP, y % height * STEP

    def region(self, x: int, y: int, width: int, height: int) -> Rectangle:
        """Returns the part of the image in a rectangle, of the tile that its middle lies in."""
        if self._show == "bgr":
            return x, y, width, height
        ranges = []
        for begin, length, tile, size in zip((x, y), (width, height), self._tile, self._size):
            first = (begin + length // 2) // tile * tile
            low = max(begin - first, 0) * STEP
            high = min(min(begin + length - first, tile) * STEP, size)
            ranges.append((low, high - low))
        (left, wide), (top, high) = ranges
        return left, top, wide, high
