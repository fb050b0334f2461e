"""What the viewer shows of an image in a space, and which pixels are clicked and dragged there."""

import cv2
import numpy as np
import pytest

from robot_vision import draw_text
from robot_vision.viewer.channel_view import SHOWS, ChannelView

CODES = {
    "hsv": cv2.COLOR_BGR2HSV,
    "hls": cv2.COLOR_BGR2HLS,
    "lab": cv2.COLOR_BGR2Lab,
    "ycrcb": cv2.COLOR_BGR2YCrCb,
}
NAMES = {"hsv": "H S V", "hls": "H L S", "lab": "L A B", "ycrcb": "Y CR CB"}


@pytest.fixture
def image():
    return np.random.RandomState(1).randint(0, 256, (75, 101, 3), np.uint8)


def test_the_image_itself_is_shown_as_it_is(image):
    view = ChannelView("bgr", (101, 75))
    assert view.of(image) is image
    assert view.pixel(7, 9) == (7, 9) and view.region(1, 2, 3, 4) == (1, 2, 3, 4)


@pytest.mark.parametrize("show", CODES)
def test_tiles_have_the_image_and_the_channels_of_opencv(image, show):
    before = image.copy()
    shown = ChannelView(show, (101, 75)).of(image)
    assert shown.shape == (76, 102, 3) and np.array_equal(image, before)
    small = np.ascontiguousarray(image[::2, ::2])
    assert np.array_equal(shown[:38, :51], small)
    channels = cv2.split(cv2.cvtColor(small, CODES[show]))
    tiles = shown[:38, 51:], shown[38:, :51], shown[38:, 51:]
    for channel, tile, name in zip(channels, tiles, NAMES[show].split()):
        expected = cv2.merge([channel] * 3)
        draw_text(expected, name, (6, 18))
        assert np.array_equal(tile, expected), name


@pytest.mark.parametrize("show", SHOWS)
@pytest.mark.parametrize("size", [(101, 75), (100, 74), (1, 1), (2, 1)])
def test_a_click_is_on_the_pixel_that_is_seen_there(show, size):
    numbers = np.arange(size[0] * size[1], dtype=np.uint32).reshape(size[::-1])
    image = np.ascontiguousarray(numbers[..., None].view(np.uint8)[..., :3])
    view = ChannelView(show, size)
    shown = view.of(image)
    height, width = (-(-side // 2) for side in size[::-1]) if show != "bgr" else size[::-1]
    for y in range(0, shown.shape[0], 7):
        for x in range(0, shown.shape[1], 5):
            column, row = view.pixel(x, y)
            in_first_tile = shown[y % height, x % width]
            assert np.array_equal(image[row, column], in_first_tile)


@pytest.mark.parametrize(
    "drawn, expected",
    [
        ((0, 0, 51, 38), (0, 0, 101, 75)),  # the first tile is the whole image
        ((10, 12, 4, 3), (20, 24, 8, 6)),
        ((51, 38, 1, 1), (0, 0, 2, 2)),
        ((61, 50, 30, 20), (20, 24, 60, 40)),
        ((40, 30, 20, 30), (80, 0, 21, 44)),  # over tiles: that of its middle, x 50, y 45
        ((0, 0, 102, 76), (0, 0, 101, 75)),
    ],
)
def test_a_rectangle_is_of_the_tile_in_which_its_middle_lies(drawn, expected):
    assert ChannelView("lab", (101, 75)).region(*drawn) == expected
