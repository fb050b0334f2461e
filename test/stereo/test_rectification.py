"""Rectified images against OpenCV's, and the pairs that robot_vision.stereo makes."""

import cv2
import numpy as np
import pytest

import robot_vision as rv
from robot_vision import stereo

SIZE = WIDTH, HEIGHT = 160, 120
K = np.float64([[140, 0, 78], [0, 141, 61], [0, 0, 1]])
TURN = cv2.Rodrigues(np.float64([0.02, -0.05, 0.03]))[0]
P = np.float64([[120, 0, 82, -12], [0, 120, 58, 0], [0, 0, 1, 0]])
LENSES = {
    "none": ("plumb_bob", []),
    "plumb_bob": ("plumb_bob", [-0.25, 0.07, 0.001, -0.002, 0.01]),
    "rational": ("rational_polynomial", [0.45, -0.3, 0.001, -0.002, -0.02, 0.8, -0.1, -0.07]),
    "fisheye": ("equidistant", [0.05, -0.02, 0.006, -0.001]),
}
IMAGE = np.random.default_rng(2).integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8)


def camera(lens, projection=P):
    model, coefficients = LENSES[lens]
    return rv.RectifiedCamera(rv.CameraModel(*SIZE, K, coefficients, model), TURN, projection)


def maps(lens):
    """OpenCV's, in fixed point."""
    coefficients = np.float64(LENSES[lens][1] or [0.0] * 4)
    make = cv2.fisheye if lens == "fisheye" else cv2
    arguments = K, coefficients, TURN, P[:, :3], SIZE, cv2.CV_16SC2
    return make.initUndistortRectifyMap(*arguments)


def floats(lens):
    """OpenCV's maps in floating point: x and y in the camera's image."""
    return cv2.convertMaps(*maps(lens), cv2.CV_32FC1)


@pytest.mark.parametrize("lens", LENSES)
def test_rectified_images_equal_those_of_opencv(lens):
    rectifier, before = rv.Rectifier(camera(lens)), IMAGE.copy()
    expected = cv2.remap(IMAGE, *maps(lens), cv2.INTER_LINEAR)
    assert np.array_equal(rectifier.apply(IMAGE), expected)
    gray = cv2.cvtColor(IMAGE, cv2.COLOR_BGR2GRAY)
    expected = cv2.remap(gray, *maps(lens), cv2.INTER_LINEAR)
    assert np.array_equal(rectifier.apply(IMAGE, "bgr8", "mono8"), expected)
    assert np.array_equal(rectifier.apply(gray, "mono8", "mono8"), expected)
    assert np.array_equal(IMAGE, before)


@pytest.mark.parametrize("lens", LENSES)
def test_what_is_seen_is_what_lies_in_the_image(lens):
    x, y = floats(lens)
    inside = (x >= 0) & (x <= WIDTH - 1) & (y >= 0) & (y <= HEIGHT - 1)
    assert 0.5 < inside.mean() < 1.0
    assert np.array_equal(rv.Rectifier(camera(lens)).seen, np.where(inside, 255, 0))


def test_what_the_lens_does_not_show_is_not_seen():
    """OpenCV's maps lead back into the image there."""
    lens = rv.CameraModel(
        *SIZE, [[105, 0, 80], [0, 105, 60], [0, 0, 1]], [-0.35, 0.12, 0, 0, -0.02]
    )
    focal_length = 50.0  # px: the corners of the rectified image are at 2.0 on the plane z = 1
    wide = [[focal_length, 0, 80, -5], [0, focal_length, 60, 0], [0, 0, 1, 0]]
    rectified = rv.RectifiedCamera(lens, np.eye(3), wide)
    radii = np.linspace(0.0, 2.5, 10001)
    shown = lens.project(np.stack([radii, 0 * radii, radii**0], -1))[0][:, 0]
    turn = radii[np.argmax(shown)]
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    radius = np.hypot(columns - 80, rows - 60) / focal_length
    x, y = cv2.convertMaps(
        *cv2.initUndistortRectifyMap(
            np.float64(lens.K),
            np.float64(lens.D),
            np.eye(3),
            rectified.P[:, :3],
            SIZE,
            cv2.CV_16SC2,
        ),
        cv2.CV_32FC1,
    )
    inside = (x >= 0) & (x <= WIDTH - 1) & (y >= 0) & (y <= HEIGHT - 1)
    assert (inside & (radius > turn)).sum() > 100
    seen = rv.Rectifier(rectified).seen
    assert np.array_equal(seen, np.where(inside & (radius < turn), 255, 0))


def test_a_straight_line_through_a_bent_lens_is_straight_again():
    """The camera's own model, not OpenCV, says where the points of a line are seen."""
    lens = camera("plumb_bob")
    points = np.float64([[0.9 * t - 0.4, 0.3 * t - 0.2, 2.0] for t in np.linspace(0, 1, 9)])
    seen = lens.model.project(points)[0]
    x, y = floats("plumb_bob")
    for point, pixel in zip(points, seen):
        row = P[:, :3] @ TURN @ point
        column, line = row[:2] / row[2]
        at = np.float32([[column]]), np.float32([[line]])
        found = [cv2.remap(of, *at, cv2.INTER_LINEAR)[0, 0] for of in (x, y)]
        assert found == pytest.approx(pixel, abs=0.1)


RIGHT_TURN = cv2.Rodrigues(np.float64([0.01, 0.03, -0.02]))[0]
BASELINE = np.float64([-0.2, 0.004, -0.003])  # m, of the left camera in the right one's frame


@pytest.mark.parametrize("lens", LENSES)
def test_a_calibrated_pair_sees_the_same_in_the_same_rows(lens):
    model, coefficients = LENSES[lens]
    left, right = (rv.CameraModel(*SIZE, K, coefficients, model) for _ in range(2))
    pair = stereo.calibrated_pair(left, right, RIGHT_TURN, BASELINE)
    assert pair.geometry.baseline == pytest.approx(np.linalg.norm(BASELINE))
    points = np.random.default_rng(4).uniform((-0.5, -0.4, 1.0), (0.5, 0.4, 3.0), (20, 3))
    of_left = points @ pair.left.R.T
    of_right = (points @ RIGHT_TURN.T + BASELINE) @ pair.right.R.T
    left_pixels, right_pixels = (
        (seen @ of.P[:, :3].T / seen[:, 2:])[:, :2]
        for seen, of in ((of_left, pair.left), (of_right, pair.right))
    )
    assert left_pixels[:, 1] == pytest.approx(right_pixels[:, 1], abs=1e-6)
    disparities = left_pixels[:, 0] - right_pixels[:, 0]
    geometry = pair.geometry
    depth = geometry.fx * geometry.baseline / (disparities - geometry.offset)
    assert depth == pytest.approx(of_left[:, 2], rel=1e-6)


def test_cameras_that_are_no_pair_are_refused():
    plain, fisheye = (rv.CameraModel(*SIZE, K, *LENSES[lens][::-1]) for lens in ("none", "fisheye"))
    with pytest.raises(ValueError, match="one camera is equidistant, must be both or none"):
        stereo.calibrated_pair(plain, fisheye, np.eye(3), [-0.1, 0, 0])
    with pytest.raises(ValueError, match=r"P\[3\] of the right camera is .*, must be below 0"):
        stereo.calibrated_pair(plain, plain, np.eye(3), [0.1, 0, 0])
    with pytest.raises(ValueError, match=r"P\[7\] is .*, must be 0, for cameras beside each other"):
        stereo.calibrated_pair(plain, plain, np.eye(3), [0, -0.1, 0])
    with pytest.raises(ValueError, match="R has 4 numbers, must have 9"):
        rv.RectifiedCamera(plain, np.eye(2), P)
