"""The scene of a road: what it shows is where its truth says, and what the lane detector finds."""

import functools
import math

import numpy as np
import pytest

import robot_vision as rv

RADIUS, WIDTH, STRAIGHT, PERIOD = 2.0, 0.4, 1.5, 20.0  # m, m, m, s
TRIP = 2.0 * (STRAIGHT + math.pi * RADIUS)  # m, once around
RATE = 30.0  # Hz
AHEAD = 1.2  # m, what is seen of the road


@functools.lru_cache(maxsize=None)
def scene(still=False):
    params = rv.SceneParams()
    params.still = still
    return rv.RoadScene(params)


def lane_of(frame):
    (lane,) = scene().truth(frame).objects
    assert lane.name == "lane"
    return lane


def in_image(frame, x, y):
    """The pixels of places in the frame of the lane, (n,) m each."""
    places = np.column_stack([x, np.broadcast_to(y, np.shape(x)), np.zeros(len(x))])
    pose = lane_of(frame).pose
    pixels, _ = scene().camera.project(places @ pose[:3, :3].T + pose[:3, 3])
    return np.rint(pixels).astype(int)


def robot_in_lane(frame):
    """Offset (m) and heading (rad) by the poses of lane and camera."""
    camera = np.linalg.inv(lane_of(frame).pose)
    ahead = camera[:3, 2]
    return camera[1, 3], math.atan2(ahead[1], ahead[0])


def curvature(frame):
    """Of the road that is seen; None where a straight goes over into a curve."""
    along = TRIP * frame / RATE / PERIOD % (TRIP / 2.0)
    if along + AHEAD < STRAIGHT:
        return 0.0
    return 1.0 / RADIUS if STRAIGHT < along < TRIP / 2.0 - AHEAD else None


@pytest.mark.parametrize("frame", [0, 10, 305])
def test_lines_are_where_the_truth_has_them(frame):
    assert curvature(frame) == 0.0
    image, x = scene().render(frame).astype(int), np.linspace(0.35, 0.9, 12)
    right = in_image(frame, x, -WIDTH / 2.0)
    middle = in_image(frame, x, 0.0)
    left = in_image(frame, np.linspace(0.35, 0.9, 60), WIDTH / 2.0)
    assert (image[right[:, 1], right[:, 0]] > 200).all()
    assert (np.abs(image[middle[:, 1], middle[:, 0]] - 106) < 30).all()
    yellow = image[left[:, 1], left[:, 0], 2] > 180
    assert 0.3 < yellow.mean() < 0.7  # dashed
    outline = lane_of(frame).outline
    assert (outline > -1.0).all() and (outline < (640, 480)).all()
    assert outline[:, 0].min() < middle[:, 0].min() and outline[:, 0].max() > middle[:, 0].max()


def test_the_camera_is_on_a_robot_that_drives_around():
    poses = [scene().truth(frame).camera for frame in range(0, 600, 10)]
    places = np.array([pose[:3, 3] for pose in poses])
    assert np.allclose(places[:, 2], 0.25)
    assert np.allclose([math.asin(-pose[2, 2]) for pose in poses], 0.6)
    steps = np.linalg.norm(np.diff(places[:, :2], axis=0), axis=1)
    assert np.allclose(steps, TRIP / 60, rtol=0.1)
    assert np.allclose(scene().truth(600).camera, poses[0])
    offsets = np.array([robot_in_lane(frame)[0] for frame in range(0, 600, 10)])
    assert offsets.max() == pytest.approx(0.05, abs=0.002)
    assert offsets.min() == pytest.approx(-0.05, abs=0.002)


@pytest.mark.parametrize("width, height, share", [(240, 320, 0.02), (320, 240, 0.0)])
def test_the_sky_is_where_there_is_no_floor(width, height, share):
    params = rv.SceneParams()
    params.width, params.height = width, height
    road = rv.RoadScene(params)
    image, nothing = road.render(0).astype(int), np.isnan(road.render_depth(0, "color"))
    assert (nothing.mean() > share) if share else not nothing.any()
    sky = (np.abs(image - (222, 200, 172)) < 20).all(axis=2)
    assert (sky & nothing).sum() == nothing.sum()
    assert (sky & ~nothing).mean() < 0.01  # the lines are painted white


def test_the_lane_is_visible_as_its_outline_is_cut_off_at_the_border():
    assert all(lane_of(frame).visible for frame in range(0, 600, 20))


def test_a_still_robot_stays():
    assert np.allclose(scene(True).truth(100).camera, scene().truth(0).camera)
    assert np.abs(scene(True).render(0).astype(int) - scene(True).render(100)).max() < 30


def test_the_lane_detector_finds_the_lane_of_the_truth():
    detector, checked = rv.LaneDetector(), 0
    for frame in range(0, 600, 12):
        lane = detector.update(frame / RATE, scene().render(frame), camera=scene().camera)
        offset, heading = robot_in_lane(frame)
        assert lane.found and lane.offset == pytest.approx(offset, abs=0.06), frame
        if curvature(frame) is None:
            continue  # The detector's lane has one curvature, and this road two.
        checked += 1
        assert lane.offset == pytest.approx(offset, abs=0.01), frame
        assert lane.heading == pytest.approx(heading, abs=math.radians(1.5)), frame
        assert lane.curvature == pytest.approx(curvature(frame), abs=0.06), frame
        assert lane.width == pytest.approx(WIDTH, abs=0.01), frame
    assert checked > 30
