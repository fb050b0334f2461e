"""Colours of pixels in frames of all encodings."""

import cv2
import numpy as np
import pytest

from robot_vision.dashboard.color_pixels import ENCODINGS, bgr_around
from robot_vision.ros.transport import Frame

COLOR = (200, 120, 40)  # BGR, of the right half; the left half is black


def scene():
    image = np.zeros((48, 64, 3), np.uint8)
    image[:, 32:] = COLOR
    return image


def bayer(first, second):
    """A mosaic of the scene: channels of the first row's two pixels, then of the second row's."""
    image = scene()
    made = np.zeros(image.shape[:2], np.uint8)
    for row, channels in enumerate((first, second)):
        for column, channel in enumerate(channels):
            made[row::2, column::2] = image[row::2, column::2, "bgr".index(channel)]
    return made


def yuv(luma_first):
    ycrcb = cv2.cvtColor(scene(), cv2.COLOR_BGR2YUV)
    made = np.zeros((48, 64, 2), np.uint8)
    made[:, :, 0 if luma_first else 1] = (ycrcb[:, :, 0] * (219 / 255) + 16).round()
    chroma = made[:, :, 1 if luma_first else 0]
    blue, green, red = scene().astype(float).transpose(2, 0, 1)
    chroma[:, 0::2] = (-0.148 * red - 0.291 * green + 0.439 * blue + 128)[:, 0::2].round()
    chroma[:, 1::2] = (0.439 * red - 0.368 * green - 0.071 * blue + 128)[:, 0::2].round()
    return made


def gray():
    return cv2.cvtColor(scene(), cv2.COLOR_BGR2GRAY)


def with_alpha(image):
    return np.dstack([image, np.full(image.shape[:2], 9, np.uint8)])


GRAY = tuple([int(gray()[0, 40])] * 3)
FRAMES = {
    "bgr8": (scene, COLOR),
    "8UC3": (scene, COLOR),
    "rgb8": (lambda: scene()[:, :, ::-1], COLOR),
    "bgra8": (lambda: with_alpha(scene()), COLOR),
    "8UC4": (lambda: with_alpha(scene()), COLOR),
    "rgba8": (lambda: with_alpha(scene()[:, :, ::-1]), COLOR),
    "mono8": (gray, GRAY),
    "8UC1": (gray, GRAY),
    "mono16": (lambda: gray().astype(np.uint16) * 257, GRAY),
    "yuv422": (lambda: yuv(False), COLOR),
    "yuv422_yuy2": (lambda: yuv(True), COLOR),
    "bayer_rggb8": (lambda: bayer("rg", "gb"), COLOR),
    "bayer_bggr8": (lambda: bayer("bg", "gr"), COLOR),
    "bayer_gbrg8": (lambda: bayer("gb", "rg"), COLOR),
    "bayer_grbg8": (lambda: bayer("gr", "bg"), COLOR),
    "bayer_rggb16": (lambda: bayer("rg", "gb").astype(np.uint16) * 257, COLOR),
    "bayer_bggr16": (lambda: bayer("bg", "gr").astype(np.uint16) * 257, COLOR),
    "bayer_gbrg16": (lambda: bayer("gb", "rg").astype(np.uint16) * 257, COLOR),
    "bayer_grbg16": (lambda: bayer("gr", "bg").astype(np.uint16) * 257, COLOR),
}


def test_all_encodings_are_tested():
    assert set(FRAMES) == ENCODINGS


@pytest.mark.parametrize("encoding", FRAMES)
@pytest.mark.parametrize("x, y", [(40, 20), (41, 21), (63, 47), (63, 0), (50, 47)])
def test_the_color_of_a_pixel(encoding, x, y):
    make, expected = FRAMES[encoding]
    image = make()
    before = image.copy()
    part = bgr_around(Frame(image, encoding, None), x, y)
    assert np.median(part.reshape(-1, 3), axis=0) == pytest.approx(expected, abs=4)
    assert np.array_equal(image, before)


@pytest.mark.parametrize("encoding", FRAMES)
def test_the_window_is_around_the_pixel(encoding):
    image = FRAMES[encoding][0]()
    dark = bgr_around(Frame(image, encoding, None), 20, 10)
    assert dark.shape == (5, 5, 3) and dark.max() <= 4
    one = bgr_around(Frame(image, encoding, None), 40, 10, 0)
    assert one.shape == (1, 1, 3) and one.max() > 30


@pytest.mark.parametrize("x, y, shape", [(0, 0, (3, 3, 3)), (63, 0, (3, 3, 3)), (1, 20, (5, 4, 3))])
def test_the_window_ends_at_the_border(x, y, shape):
    assert bgr_around(Frame(scene(), "bgr8", None), x, y).shape == shape


@pytest.mark.parametrize("x, y", [(-1, 0), (64, 0), (0, 48), (1000, 1000)])
def test_pixels_outside_are_refused(x, y):
    with pytest.raises(ValueError, match="not inside of the image of 64x48"):
        bgr_around(Frame(scene(), "bgr8", None), x, y)


def test_an_image_of_one_pixel():
    image = np.full((1, 1, 3), 7, np.uint8)
    assert bgr_around(Frame(image, "bgr8", None), 0, 0).tolist() == [[[7, 7, 7]]]


def test_half_a_pair_of_pixels_is_refused():
    with pytest.raises(ValueError, match="1x1"):
        bgr_around(Frame(np.zeros((1, 1, 2), np.uint8), "yuv422", None), 0, 0)


@pytest.mark.parametrize("encoding", ["32FC1", "16UC1", "<b>"])
def test_depths_have_no_color(encoding):
    with pytest.raises(ValueError, match="no colours"):
        bgr_around(Frame(np.zeros((4, 4), np.float32), encoding, None), 0, 0)
