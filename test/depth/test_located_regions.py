"""Places of regions in Python, and of the scene's objects by the depth of each sensor."""

import functools

import cv2
import numpy as np
import pytest

import robot_vision as rv
from robot_vision import depth

WIDTH, HEIGHT = 160, 120
CAMERA = rv.CameraModel(WIDTH, HEIGHT, [[150.0, 0, 79.5], [0, 150.0, 59.5], [0, 0, 1]])
BOX = (40, 30, 24, 30)
FRAMES = (60, 240)
SENSORS = ("none", "kinect", "stereo", "tof")
FLAT = ("tag_0", "tag_1", "qr_code", "checkerboard", "poster")


def board(kind=np.float32):
    metres = np.full((HEIGHT, WIDTH), 2.5, np.float32)
    metres[30:60, 40:64] = 1.2
    return metres if kind == np.float32 else (metres * 1000).astype(kind)


@pytest.mark.parametrize("kind", [np.uint16, np.float32])
def test_a_board_before_a_wall(kind):
    image = board(kind)
    before = image.copy()
    found = depth.locate(image, CAMERA, BOX)
    # The middle of its pixels is (51.5, 44.5).
    assert found.position == pytest.approx([-28 / 150 * 1.2, -15 / 150 * 1.2, 1.2], abs=1e-6)
    assert found.size == pytest.approx([24 / 150 * 1.2, 30 / 150 * 1.2, 0.0], abs=1e-6)
    assert found.pixels == 24 * 30
    assert found.covariance.shape == (3, 3)
    assert np.array_equal(found.covariance, found.covariance.T)
    assert (np.linalg.eigvalsh(found.covariance) > 0.0).all()
    assert np.array_equal(image, before)


def test_what_is_said_of_errors_is_in_the_covariance():
    """Across it is the box, along the ray it is the depth."""
    errors = rv.DepthErrorParams()
    errors.depth_bias = 0.1
    center = 79.5, 59.5
    image = np.full((HEIGHT, WIDTH), 1.5, np.float32)
    box = 60, 40, 40, 40
    found = depth.locate(image, CAMERA, box, center=center, errors=errors, box_error=0.1)
    across = np.hypot(0.1 * 40, 0.5) / 150 * 1.5
    assert np.sqrt(np.diag(found.covariance)) == pytest.approx([across, across, 0.1], rel=0.01)


def test_parts_of_larger_arrays_and_lists_are_used():
    padded = np.zeros((HEIGHT, WIDTH + 9), np.uint16)
    padded[:, :WIDTH] = board(np.uint16)
    outline = [(42, 32), (60, 33), (50, 58)]
    expected = depth.locate(board(np.uint16), CAMERA, BOX, np.array(outline, np.float32))
    for view in (padded[:, :WIDTH], np.asfortranarray(padded[:, :WIDTH])):
        found = depth.locate(view, CAMERA, BOX, outline)
        assert np.array_equal(found.position, expected.position)
        assert found.pixels == expected.pixels < 24 * 30


def test_nothing_is_there_without_depths():
    assert depth.locate(np.full((HEIGHT, WIDTH), np.nan, np.float32), CAMERA, BOX) is None
    assert depth.locate(board(), CAMERA, BOX, min_pixels=1000) is None


@pytest.mark.parametrize(
    "arguments, error, said",
    [
        ({"box": (200, 0, 5, 5)}, ValueError, "the box is 5x5 at \\(200, 0\\), must be in"),
        ({"center": (np.nan, 3)}, ValueError, "a point of the region is \\(nan, 3\\)"),
        ({"outline": np.zeros((4, 3))}, ValueError, "an \\(n, 2\\) array as outline"),
        ({"radius": -1.0}, ValueError, "the radius is -1, must be from 0"),
        ({"shape": "cube"}, ValueError, "shape is cube, must be surface or sphere"),
        ({"box_eror": 1.0}, AttributeError, "no parameter box_eror of LocatorParams"),
        ({"image": np.zeros((9, 9), np.uint16)}, ValueError, "is 9x9, must be 160x120"),
        ({"image": np.zeros((9, 9), np.uint8)}, TypeError, "uint16 .mm. or float32 .m."),
    ],
)
def test_errors(arguments, error, said):
    given = {"image": board(), "camera": CAMERA, "box": BOX, **arguments}
    with pytest.raises(error, match=said):
        depth.locate(**given)


@functools.lru_cache(maxsize=None)
def scene():
    params = rv.SceneParams()
    params.width, params.height = 320, 240
    return rv.Scene(params)


def registered(sensor, frame):
    """What the color camera sees of the depth camera's measurements."""
    camera, pose = scene().view_camera("depth"), scene().view_pose("depth")
    noisy = rv.DepthNoise(sensor, camera).apply(frame, scene().render_depth(frame))
    return depth.register(noisy, camera, scene().camera, pose)


def squared_error(truth, found):
    error = found.position - truth
    return error @ np.linalg.solve(found.covariance, error)


@pytest.mark.parametrize("sensor", SENSORS)
def test_what_is_on_the_walls_and_the_ball_are_where_they_are(sensor):
    seen = set()
    for frame in FRAMES:
        image = registered(sensor, frame)
        for one in scene().truth(frame).objects:
            if not one.visible or one.name not in (*FLAT, "ball"):
                continue
            outline = np.float32(one.outline)
            values = {}
            if one.name == "ball":
                center, radius = cv2.minEnclosingCircle(outline)
                values = {"shape": "sphere", "center": center, "radius": radius}
            found = depth.locate(image, scene().camera, cv2.boundingRect(outline), **values)
            assert squared_error(one.pose[:3, 3], found) < 14.2, one.name  # that of 99.7 %
            if one.name == "ball":
                assert found.size == pytest.approx([0.2] * 3, rel=0.05)
            seen.add(one.name)
    assert {"ball", "tag_0", "tag_1", "qr_code", "checkerboard"} <= seen
