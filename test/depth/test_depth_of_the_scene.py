"""Registration and planes against the exact depth of the scene, with the noise of every sensor."""

import functools

import numpy as np
import pytest
from seen_depths import scene_of, seen_by_both

import robot_vision as rv
from robot_vision import depth

SIZE = 320, 240  # px
FRAME = 30
SENSORS = ("none", "kinect", "stereo", "tof")


@functools.lru_cache(maxsize=None)
def scene():
    return scene_of(SIZE)


@functools.lru_cache(maxsize=None)
def inside_of_surfaces():
    """As seen_by_both(); not where a surface ends, as the noise of sensors is another there."""
    return seen_by_both(scene(), FRAME, around=2)


def measured(sensor):
    exact = scene().render_depth(FRAME)
    return rv.DepthNoise(sensor, scene().view_camera("depth")).apply(FRAME, exact)


def deviation(sensor, z):
    """The largest standard deviation of a sensor's depth, m, at brightness 128."""
    return {
        "none": 1e-4 + 0.0 * z,
        "kinect": 0.0012 + 0.0019 * (z - 0.4) ** 2 + 0.01 * z**2,  # its steps are coarse here
        "stereo": 2.0 * z**2 / scene().view_camera("depth").K[0, 0],
        "tof": 0.001 + 0.064 * z**2 / 128.0,
    }[sensor]


@pytest.mark.parametrize("sensor", SENSORS)
def test_a_color_camera_sees_what_is_there(sensor):
    truth, visible = inside_of_surfaces()
    assert visible.mean() > 0.8
    color = scene().view_camera("color")
    seen = depth.register(
        measured(sensor), scene().view_camera("depth"), color, scene().view_pose("depth")
    )
    found = visible & ~np.isnan(seen)
    # What a sensor does not measure cannot be filled.
    assert found.sum() >= (0.995 if sensor == "none" else 0.85) * visible.sum()
    errors = np.abs(seen - truth)[found] / deviation(sensor, truth[found])
    assert np.median(errors) < 1.0
    assert np.mean(errors < 4.0) > 0.97


@pytest.mark.parametrize("size", [SIZE, (640, 360)])
def test_all_that_both_cameras_see_is_filled_up_to_its_edges(size):
    one = scene_of(size)
    truth, visible = seen_by_both(one, FRAME)
    color, camera = one.view_camera("color"), one.view_camera("depth")
    seen = depth.register(one.render_depth(FRAME), camera, color, one.view_pose("depth"))
    assert visible.mean() > 0.75
    assert (~np.isnan(seen))[visible].mean() > 0.99
    assert (np.abs(seen - truth) < 0.01 * truth)[visible].mean() > 0.99


def test_nothing_is_seen_that_is_nowhere_near():
    truth, _ = inside_of_surfaces()
    seen = depth.register(
        scene().render_depth(FRAME),
        scene().view_camera("depth"),
        scene().view_camera("color"),
        scene().view_pose("depth"),
    )
    near = np.zeros(truth.shape, bool)
    for x in range(-2, 3):
        for y in range(-2, 3):
            near |= np.abs(np.roll(truth, (y, x), (0, 1)) - seen) < 0.02 * seen
    wrong = ~np.isnan(seen) & ~near
    assert wrong[2:-2, 2:-2].mean() < 1e-3


@pytest.mark.parametrize("sensor", SENSORS)
def test_planes_are_those_of_the_room(sensor):
    """Within 2 mm and 0.2 degrees of a fit to the exact depth of the same pixels.

    With noise a board and the wall behind it are one plane: the fit tells how far both are from it.
    The errors of stereo are alike in blocks of 5x5 px, which is as if it had a 25th of the pixels.
    """
    block = 5 if sensor == "stereo" else 1  # px
    camera = scene().view_camera("depth")
    exact = scene().render_depth(FRAME)
    noise = {"none": 0.0005, "kinect": 0.004, "stereo": 0.008, "tof": 0.001}[sensor]
    found, labels = depth.planes(measured(sensor), camera, noise=noise, min_area=0.05)
    assert found
    for number, plane in enumerate(found, 1):
        points = depth.points(exact, camera)[labels == number].astype(float)
        points = points[~np.isnan(points).any(axis=1)]
        rays = points / points[:, 2:]
        scaled = np.linalg.lstsq(rays, 1.0 / points[:, 2], rcond=None)[0]
        normal, distance = -scaled / np.linalg.norm(scaled), 1.0 / np.linalg.norm(scaled)
        best = np.median(np.abs(points @ normal + distance))
        assert np.median(np.abs(points @ plane.normal + plane.distance)) < best + 2e-3
        angle = np.degrees(np.arccos(np.clip(normal @ plane.normal, -1.0, 1.0)))
        assert angle < 0.1 * (1 + block)
        middle = points.mean(axis=0)
        assert abs(middle @ plane.normal + plane.distance) < 1e-3 * (1 + block)
