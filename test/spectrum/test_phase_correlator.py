"""Shifts of whole images by phase correlation, against the truth and OpenCV."""

import cv2
import numpy as np
import pytest

import robot_vision as rv

TEXTURE = cv2.GaussianBlur(
    np.random.default_rng(6).integers(0, 256, (300, 300), np.uint8), (0, 0), 1.5
)
TEXTURE = cv2.normalize(TEXTURE, None, 0, 255, cv2.NORM_MINMAX)


def seen(x, y, height=120, width=160):
    """The texture moved by so many px."""
    window = np.float64([[1, 0, x - 60], [0, 1, y - 80]])
    return cv2.warpAffine(TEXTURE, window, (width, height), flags=cv2.INTER_CUBIC)


def shift_of(first, second, encoding="mono8", **values):
    params = rv.SpectrumParams()
    for name, value in values.items():
        setattr(params, name, value)
    correlator = rv.PhaseCorrelator(params)
    assert correlator.update(0.0, first, encoding) is None
    return correlator.update(0.1, second, encoding)


@pytest.mark.parametrize("size", [(120, 160), (121, 161), (135, 125), (175, 173)])
@pytest.mark.parametrize("x, y", [(0, 0), (3, -2), (-11, 7), (0, 12)])
def test_whole_pixels_are_found(size, x, y):
    shift = shift_of(seen(0, 0, *size), seen(x, y, *size))
    assert shift.found and shift.response > 0.5
    assert (shift.x, shift.y) == pytest.approx((x, y), abs=0.1)


@pytest.mark.parametrize("x, y", [(0.5, -0.5), (2.3, 1.8), (-4.7, 6.4)])
def test_parts_of_pixels_are_found_to_a_third(x, y):
    shift = shift_of(seen(0, 0), seen(x, y))
    assert (shift.x, shift.y) == pytest.approx((x, y), abs=0.33)


def test_it_is_opencv_s_phase_correlation():
    """Of images without their means, and a size that is even and fast."""
    first, second = seen(0, 0), seen(4, 5)
    window = np.float32(np.outer(np.hanning(120), np.hanning(160)))
    without_mean = (np.float32(image - image.mean()) for image in (first, second))
    (x, y), response = cv2.phaseCorrelate(*without_mean, window)
    shift = shift_of(first, second)
    assert (shift.x, shift.y) == pytest.approx((x, y), abs=1e-3)
    assert shift.response == pytest.approx(min(response, 1.0), abs=1e-3)


def test_brightness_is_no_shift():
    shift = shift_of(seen(0, 0), np.uint8(seen(3, 2) // 2 + 90))
    assert (shift.x, shift.y) == pytest.approx((3, 2), abs=0.1)


def test_images_that_have_nothing_in_common_have_no_shift():
    rng = np.random.default_rng(8)
    shift = shift_of(*rng.integers(0, 256, (2, 240, 320), np.uint8))
    assert not shift.found and (shift.x, shift.y) == (0, 0) and 0 <= shift.response < 0.1
    assert shift_of(*rng.integers(0, 256, (2, 240, 320), np.uint8), min_response=0.0).found
    assert not shift_of(seen(0, 0), seen(3, 2), min_response=1.0).found


@pytest.mark.parametrize("level", [0, 60, 255])
@pytest.mark.parametrize("size", [(60, 80), (120, 160), (243, 321)])
def test_nothing_is_found_in_plain_images(size, level):
    """Not even the window, which would not move."""
    plain, brighter = (np.full(size, gray, np.uint8) for gray in (level, min(level + 9, 255)))
    for after in (plain, brighter):
        shift = shift_of(plain, after, min_response=0.0)
        assert not shift.found and (shift.x, shift.y, shift.response) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("size", [(1, 1), (1, 64), (64, 1), (2, 3), (9, 200)])
def test_small_images(size):
    image = TEXTURE[: size[0], : size[1]]
    shift = shift_of(image, image)
    assert (shift.x, shift.y) == pytest.approx((0, 0), abs=0.1)


def test_colors_and_padded_rows():
    first, second = (cv2.cvtColor(seen(x, 0), cv2.COLOR_GRAY2BGR) for x in (0, 5))
    padded = np.hstack([second, second])[:, :160]
    before = padded.copy()
    shift = shift_of(first, padded, "bgr8")
    assert (shift.x, shift.y) == pytest.approx((5, 0), abs=0.1)
    assert np.array_equal(padded, before)


def test_frames_that_follow_on_none_begin_anew():
    params = rv.SpectrumParams()
    params.max_gap = 0.5
    correlator = rv.PhaseCorrelator(params)
    image, small = seen(0, 0), seen(0, 0, 100)
    for time, shown, found in [
        (1.0, image, False),
        (1.5, image, True),
        (2.1, image, False),
        (2.2, small, False),
        (2.3, small, True),
        (1.0, small, False),
        (1.1, small, True),
    ]:
        assert (correlator.update(time, shown, "mono8") is not None) == found, time
    assert correlator.interval == pytest.approx(0.1)
    correlator.reset()
    assert correlator.update(1.2, small, "mono8") is None
    with pytest.raises(ValueError, match="bgr8 image of 160x100: expected pixels of 3 x 8 bits"):
        correlator.update(1.3, small, "bgr8")
    assert correlator.update(1.4, small, "mono8").found
