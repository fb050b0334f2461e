"""Tags of the scene by its images and its registered depth, against the ground truth."""

import functools

import numpy as np
import pytest
from tag_depths import SENSORS, tilt_of
from tags import error_of, squared_error

import robot_vision as rv
from robot_vision.tags.tag_depth import TagDepth
from robot_vision.tags.tag_layout import TagLayout
from robot_vision.tags.tag_poses import TagLocator

FRAMES = range(0, 600, 40)
SIZE = 0.24  # m
FREEDOM = 6


@functools.lru_cache(maxsize=None)
def scene():
    return rv.Scene()


@functools.lru_cache(maxsize=None)
def seen(number):
    """The gray image of a frame, and the tags in it."""
    gray = rv.to_gray(scene().render(number), "bgr8")
    return gray, rv.TagDetector().detect(gray, "mono8")


@functools.lru_cache(maxsize=None)
def exact_depth(number):
    return scene().render_depth(number)


@functools.lru_cache(maxsize=None)
def measured_depth(sensor, number):
    return rv.DepthNoise(sensor, scene().view_camera("depth")).apply(number, exact_depth(number))


def registered(sensor, number, camera):
    depth_camera = scene().view_camera("depth")
    noisy = measured_depth(sensor, number)
    pose = scene().view_pose("depth")
    return rv.DepthRegistration(depth_camera, camera, pose).apply(noisy)


@functools.lru_cache(maxsize=None)
def located_alone(number):
    return located(number)


def located(number, depth=None):
    """(pose, truth) of the tags of a frame."""
    gray, tags = seen(number)
    locator = TagLocator(TagLayout("tag36h11", SIZE), rv.TagPoseParams())
    found, _ = locator.locate_at_once(tags, scene().camera, gray, depth)
    truths = {one.name: one.pose for one in scene().truth(number).objects}
    return [(tag.poses, truths[f"tag_{tag.tag.id}"]) for tag in found if tag.poses]


def half_as_large(camera):
    shrunk = np.diag([0.5, 0.5, 1.0]) @ camera.K
    shrunk[:2, 2] -= 0.25  # where the middle of the first of four pixels is
    size = camera.width // 2, camera.height // 2
    return rv.CameraModel(*size, shrunk, camera.D, camera.distortion_model)


@pytest.mark.parametrize("size", [1, 2])
@pytest.mark.parametrize("sensor", SENSORS)
def test_poses_are_never_worse_with_the_depth_of_a_sensor(sensor, size):
    camera = scene().camera if size == 1 else half_as_large(scene().camera)
    tilts, places, squares, planes = [], [], [], 0
    for number in FRAMES:
        depth = TagDepth(registered(sensor, number, camera), camera, SENSORS[sensor])
        for (alone, truth), (both, _) in zip(located_alone(number), located(number, depth)):
            bests = alone.best, both.best
            tilts.append([tilt_of(best.pose, truth) for best in bests])
            places.append([np.linalg.norm(error_of(best.pose, truth)[:3]) for best in bests])
            squares.append([squared_error(best, truth) / FREEDOM for best in bests])
            planes += both.planes
    assert len(tilts) >= 12 and planes > 0.75 * len(tilts)
    for errors in (tilts, places):
        alone, both = np.sqrt(np.mean(np.square(errors), axis=0))
        assert both < 1.05 * alone, (alone, both)
    alone, both = np.mean(squares, axis=0)
    assert both < max(1.05 * alone, 1.3), (alone, both)
