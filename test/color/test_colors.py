"""The bindings of colours and regions. The gtests test the algorithms."""

import cv2
import numpy as np
import pytest

import robot_vision as rv

BLUE = rv.HsvRange(low=(90, 50, 50), high=(120, 255, 255))


@pytest.fixture
def image():
    return np.random.RandomState(1).randint(0, 256, (48, 64, 3), np.uint8)


def opencv_mask(bgr, low, high):
    return cv2.inRange(cv2.cvtColor(bgr, cv2.COLOR_BGR2HSV), low, high)


def test_range_has_named_limits():
    assert (BLUE.h_low, BLUE.s_low, BLUE.v_low) == BLUE.low == (90, 50, 50)
    assert (BLUE.h_high, BLUE.s_high, BLUE.v_high) == BLUE.high == (120, 255, 255)
    changed = rv.HsvRange()
    assert (changed.low, changed.high) == (BLUE.low, BLUE.high)
    changed.low = (1, 2, 3)
    changed.high = (4, 5, 6)
    changed.s_high = 7
    assert (changed.low, changed.high) == ((1, 2, 3), (4, 7, 6))


@pytest.mark.parametrize(
    "low, high", [((90, 50, 50), (120, 255, 255)), ((0, 35, 0), (57, 255, 99))]
)
def test_mask_equals_opencv(image, low, high):
    before = image.copy()
    expected = opencv_mask(image, low, high)
    assert 0 < np.count_nonzero(expected) < expected.size
    color = rv.HsvRange(low=low, high=high)
    mask = rv.hsv_mask(image, color)
    assert mask.dtype == np.uint8
    assert np.array_equal(mask, expected)
    assert np.array_equal(rv.HsvMask(color).apply(image), expected)
    rgb = image[:, :, ::-1].copy()
    assert np.array_equal(rv.hsv_mask(rgb, color, "rgb8"), expected)
    assert np.array_equal(rv.hsv_mask(rgb, color, encoding="bgr8"), opencv_mask(rgb, low, high))
    part = image[3:40, 5:33]
    assert np.array_equal(rv.hsv_mask(part, color), expected[3:40, 5:33])
    assert np.array_equal(image, before)


def test_colors_are_converted_as_by_opencv(image):
    hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV)
    assert rv.to_hsv((255, 0, 0)) == (120, 255, 255)
    for y, x in [(0, 0), (20, 30), (47, 63)]:
        assert rv.to_hsv(tuple(image[y, x])) == tuple(hsv[y, x])


@pytest.mark.parametrize(
    "low, high, message",
    [
        ((181, 0, 0), (90, 9, 9), "h_low is 181, must be from 0 to 180"),
        ((0, 9, 0), (90, 8, 9), "s_high is 8, must be from 9 to 255"),
    ],
)
def test_invalid_ranges_are_refused(image, low, high, message):
    color = rv.HsvRange(low=low, high=high)
    for use in (rv.validate, rv.HsvMask, lambda r: rv.hsv_mask(image, r)):
        with pytest.raises(ValueError, match=message):
            use(color)


@pytest.mark.parametrize("color", [(256, 0, 0), (-1, 0, 0), (1, 2)])
def test_invalid_colors_are_refused(color):
    for use in (rv.to_hsv, rv.range_around):
        with pytest.raises(TypeError):
            use(color)


def test_regions_of_a_mask():
    mask = np.zeros((60, 90), np.uint8)
    mask[9:21, 30:50] = 255
    mask[30:50, 60:80] = 255
    mask[5, 5] = 255
    before = mask.copy()
    cleaned, regions = rv.RegionFinder().apply(mask)
    assert np.array_equal(mask, before)
    assert cleaned[5, 5] == 0 and cleaned[15, 40] == 255
    large, small = regions
    assert large.box == (60, 30, 20, 20)
    assert large.area > small.area >= 236
    assert small.center == pytest.approx((39.5, 14.5))
    assert small.circle_center == pytest.approx((39.5, 14.5), abs=0.5)
    assert small.circle_radius == pytest.approx(np.hypot(9.5, 5.5), abs=0.8)
    assert small.roundness == pytest.approx(
        small.area / (np.pi * (small.circle_radius + 0.5) ** 2), rel=1e-6
    )
    assert small.outline.dtype.kind == "i" and small.outline.shape[1] == 2
    assert tuple(cv2.boundingRect(small.outline)) == small.box
    with pytest.raises(AttributeError):
        small.area = 1.0


def test_region_parameters():
    params = rv.RegionParams()
    assert (params.min_area, params.opening, params.closing) == (200.0, 3, 3)
    params.opening = 1
    mask = np.zeros((40, 40), np.uint8)
    mask[20, 10:30] = 255
    params.min_area = 20
    (line,) = rv.RegionFinder(params).apply(mask)[1]
    assert line.area == 20
    params.min_area = 21
    assert rv.RegionFinder(params).apply(mask)[1] == []
    params.opening = 4
    for use in (rv.validate, rv.RegionFinder):
        with pytest.raises(ValueError, match="opening is 4, must be odd and from 1 to 31"):
            use(params)


def test_invalid_masks_are_refused(image):
    with pytest.raises(ValueError):
        rv.RegionFinder().apply(image)
    with pytest.raises(TypeError):
        rv.RegionFinder().apply(np.zeros((4, 4), bool))
