"""Registration and planes against the exact depth of the scene, with the noise of every sensor."""

import functools

import numpy as np
import pytest

import robot_vision as rv
from robot_vision import depth

SIZE = 320, 240  # px
FRAME = 30
SENSORS = ("none", "kinect", "stereo", "tof")


@functools.lru_cache(maxsize=None)
def scene():
    params = rv.SceneParams()
    params.width, params.height = SIZE
    return rv.Scene(params)


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


@functools.lru_cache(maxsize=None)
def seen_by_both():
    """The exact depth of the color camera, and where the depth camera sees the same surface."""
    camera, pose = scene().view_camera("depth"), scene().view_pose("depth")
    truth, exact = scene().render_depth(FRAME, "color"), scene().render_depth(FRAME)
    places = depth.points(truth, scene().view_camera("color")).reshape(-1, 3)
    places = (places - pose[:3, 3]) @ pose[:3, :3]
    places = np.nan_to_num(places, nan=-1.0)
    pixels = np.nan_to_num(camera.project(places)[0], nan=-1.0)
    left, top = np.floor(pixels).astype(int).T
    inside = (left >= 1) & (top >= 1) & (left < camera.width - 2) & (top < camera.height - 2)
    visible = inside.copy()
    for x in range(-1, 3):
        for y in range(-1, 3):
            around = exact[np.where(inside, top + y, 0), np.where(inside, left + x, 0)]
            visible &= np.abs(np.nan_to_num(around) - places[:, 2]) < 0.03 * places[:, 2]
    return truth, visible.reshape(truth.shape)


@pytest.mark.parametrize("sensor", SENSORS)
def test_a_color_camera_sees_what_is_there(sensor):
    truth, visible = seen_by_both()
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


def test_nothing_is_seen_that_is_nowhere_near():
    truth, _ = seen_by_both()
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
