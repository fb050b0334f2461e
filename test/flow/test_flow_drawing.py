"""Drawings of a flow, against OpenCV's functions called by hand."""

import cv2
import numpy as np
import pytest

import robot_vision as rv

RED, CYAN = (0, 0, 255), (255, 255, 0)  # BGR
GREEN = (0, 255, 0)


def uniform(x, y, height=3, width=5):
    return np.full((height, width, 2), (x, y), np.float32)


def wheel(flow, brightest):
    """The colors as OpenCV's tutorial makes them."""
    speed, angle = cv2.cartToPolar(flow[..., 0], flow[..., 1], angleInDegrees=True)
    hsv = np.full((*speed.shape, 3), 255, np.uint8)
    hsv[..., 0] = np.rint(angle / 2)
    hsv[..., 2] = np.rint(np.minimum(speed / brightest, 1.0) * 255)
    return cv2.cvtColor(hsv, cv2.COLOR_HSV2BGR)


def random_flow(height=37, width=51):
    return np.random.default_rng(5).normal(0.0, 6.0, (height, width, 2)).astype(np.float32)


@pytest.mark.parametrize("max_speed", [0.0, 4.0, 20.0])
def test_colors_are_those_of_the_tutorial(max_speed):
    flow = random_flow()
    brightest = max_speed or np.linalg.norm(flow, axis=2).max()
    colors = rv.flow_to_colors(flow, max_speed)
    # A speed next to a half may be rounded the other way.
    assert np.abs(colors.astype(int) - wheel(flow, brightest)).max() <= 1


@pytest.mark.parametrize(
    "motion, color",
    [((5, 0), RED), ((0, 5), (0, 255, 128)), ((-5, 0), CYAN), ((0, -5), (255, 0, 128))],
    ids=["right", "down", "left", "up"],
)
def test_the_hue_is_the_direction(motion, color):
    colors = rv.flow_to_colors(uniform(*motion), 5.0)
    assert colors.shape == (3, 5, 3)
    assert np.abs(colors.astype(int) - color).max() <= 1


def test_the_brightness_is_the_speed():
    for speed, level in ((0.0, 0), (2.0, 102), (5.0, 255), (50.0, 255)):
        assert (rv.flow_to_colors(uniform(speed, 0), 5.0) == (0, 0, level)).all()


def test_without_a_speed_the_largest_is_brightest_but_noise_stays_dark():
    flow = uniform(10, 0)
    flow[0, 0] = (20, 0)
    colors = rv.flow_to_colors(flow)
    assert colors[0, 0, 2] == 255 and abs(int(colors[1, 1, 2]) - 128) <= 1
    assert (rv.flow_to_colors(uniform(0.1, 0)) == (0, 0, 26)).all()
    assert not rv.flow_to_colors(uniform(0, 0)).any()


def test_arrows_begin_where_the_pixel_was_and_show_its_way():
    image = np.full((60, 80, 3), 50, np.uint8)
    flow = uniform(0, 0, 60, 80)
    flow[10, 30] = (5, 0)
    rv.draw_flow_arrows(image, flow, spacing=20, scale=2.0)
    expected = np.full_like(image, 50)
    expected[10::20, 10::20] = GREEN
    expected[10, 30] = 50
    cv2.arrowedLine(expected, (30, 10), (40, 10), GREEN, 1, cv2.LINE_AA, 0, 0.3)
    assert np.array_equal(image, expected)


def test_arrows_have_their_spacing_and_scale():
    flow = uniform(4, 3, 90, 120)
    drawn = []
    for spacing, scale in ((16, 3.0), (16, 6.0), (30, 3.0)):
        image = np.zeros((90, 120, 3), np.uint8)
        rv.draw_flow_arrows(image, flow, spacing, scale)
        drawn.append(int((image[..., 1] > 0).sum()))
        assert not image[..., (0, 2)].any()
    assert drawn[1] > drawn[0] > drawn[2] > 0


@pytest.mark.parametrize("x", [np.nan, np.inf, 1e30])
def test_arrows_of_any_length_can_be_drawn(x):
    image = np.zeros((20, 20, 3), np.uint8)
    rv.draw_flow_arrows(image, uniform(x, 0, 20, 20))
    assert image[8, 8, 1] > 128


def test_small_images():
    for shape in ((1, 1), (1, 9), (9, 1)):
        flow = uniform(3, 4, *shape)
        assert rv.flow_to_colors(flow).shape == (*shape, 3)
        rv.draw_flow_arrows(np.zeros((*shape, 3), np.uint8), flow, 4, 1.0)


def test_what_does_not_fit_is_refused():
    image, flow = np.zeros((4, 6, 3), np.uint8), uniform(1, 0, 4, 6)
    with pytest.raises(ValueError, match="the flow's size is 5x3, must be the image's, 6x4"):
        rv.draw_flow_arrows(image, uniform(1, 0))
    with pytest.raises(ValueError, match="spacing is 0, must be from 1"):
        rv.draw_flow_arrows(image, flow, spacing=0)
    with pytest.raises(ValueError, match="scale is nan"):
        rv.draw_flow_arrows(image, flow, scale=np.nan)
    with pytest.raises(ValueError, match="max_speed is -1, must be from 0 to 1000"):
        rv.flow_to_colors(flow, -1.0)
    with pytest.raises(ValueError, match="bgr8 image of 6x4: expected pixels of 3 x 8 bits"):
        rv.draw_flow_arrows(image[..., 0].copy(), flow)
    image.setflags(write=False)
    with pytest.raises(ValueError, match="read-only"):
        rv.draw_flow_arrows(image, flow)
