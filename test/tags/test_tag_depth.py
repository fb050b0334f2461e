"""Poses of tags by corners and depth, beside those by corners alone, with the noise of sensors."""

import numpy as np
import pytest
from tag_depths import (
    FACING,
    SENSORS,
    errors_of,
    is_the_wrong_one,
    narrow_camera,
    shots,
    tilt_of,
    tilted,
    view_of,
)
from tags import bundle_of, corners_of, error_of, matrix, squared_error, turned

import robot_vision as rv
from robot_vision.tags.tag_depth import TagDepth

FREEDOM = 6  # of a pose
NAN = float("nan")


@pytest.mark.parametrize("sensor", SENSORS)
def test_tilts_are_better_by_half_from_the_front_and_never_worse(sensor):
    camera = narrow_camera(160, 120)
    for tilt in (0, 5, 10, 25, 40, 55):
        angles, distances, squares, planes = [], [], [], 0
        for truth, *both in shots(sensor, camera, 0.12, 1.0, [tilt], 80):
            bests = [poses.best for poses in both]
            angles.append([tilt_of(best.pose, truth) for best in bests])
            distances.append([error_of(best.pose, truth)[2] for best in bests])
            squares.append(squared_error(bests[1], truth))
            planes += both[1].planes
        alone, fused = np.sqrt(np.mean(np.square(angles), axis=0))
        assert fused < (0.5 if tilt <= 10 else 1.02) * alone, tilt
        alone, fused = np.sqrt(np.mean(np.square(distances), axis=0))
        assert fused < 1.02 * alone, tilt
        assert planes > 70
        if tilt >= 10:  # From the front there are two poses that are nearly the same.
            assert 0.5 < np.mean(squares) / FREEDOM < 1.5, tilt


@pytest.mark.parametrize("sensor", ["kinect", "stereo", "tof"])
def test_the_other_pose_of_a_small_tag_is_hardly_ever_taken(sensor):
    """Tags of 10 px, as a small one near the sensor is.

    Errors of stereo are alike in blocks of 5x5 px, of which such a tag has four: with them depth
    tells less of its tilt.
    """
    wrong = {"alone": 0, "fused": 0}
    count = 1000
    camera = narrow_camera(48, 48)
    for truth, alone, fused in shots(sensor, camera, 0.02, 1.05, [25, 35, 45, 55], count):
        for name, poses in (("alone", alone), ("fused", fused)):
            wrong[name] += is_the_wrong_one(poses, truth)
    assert wrong["alone"] > 0.03 * count
    assert wrong["fused"] <= (0.2 * wrong["alone"] if sensor == "stereo" else 0.001 * count), wrong


def test_a_bundle_takes_the_planes_of_its_tags():
    rng = np.random.default_rng(4)
    camera = narrow_camera(320, 240)
    view = view_of(camera, "kinect")
    places = {0: matrix(np.eye(3), [-0.08, 0, 0]), 1: matrix(np.eye(3), [0.08, 0, 0])}
    body, errors = bundle_of(places, 0.1), []
    for number in range(40):
        truth = tilted(rng, np.radians(5), np.array([0.0, 0.0, 1.2]))
        image = view.image(truth, number, rng)
        corners, both = {}, {}
        for tag, place in places.items():
            seen = corners_of(truth @ place, camera, 0.1) + rng.normal(0.0, 0.3, (4, 2))
            plane = rv.measure_tag_plane(image, seen, camera, SENSORS["kinect"])
            corners[tag], both[tag] = seen, rv.MeasuredCorners(seen, plane=plane)
        found = [rv.estimate_pose(body, one, camera, 0.3, 0.0) for one in (corners, both)]
        errors.append([tilt_of(poses.best.pose, truth) for poses in found])
        assert found[1].planes == 2
    alone, fused = np.sqrt(np.mean(np.square(errors), axis=0))
    assert fused < 0.5 * alone


@pytest.mark.parametrize("dtype", [np.uint16, np.float32])
def test_a_depth_image_may_have_another_size_and_lens(dtype):
    """Of the same optical frame; 3/2 as large here, half as large, and of another shape."""
    camera = rv.CameraModel(320, 240, [[300, 0, 160], [0, 300, 120], [0, 0, 1]], [-0.2, 0.05, 0, 0])
    truth = tilted(np.random.default_rng(5), 0.4, np.array([0.1, -0.05, 1.0]))
    corners = corners_of(truth, camera, 0.2)
    expected = truth[:3, 2] / (truth[:3, 2] @ truth[:3, 3])
    for other in (
        camera,
        rv.CameraModel(480, 360, [[450, 0, 240], [0, 450, 180], [0, 0, 1]]),
        rv.CameraModel(160, 120, [[150, 0, 80], [0, 150, 60], [0, 0, 1]], [-0.1, 0, 0, 0]),
        rv.CameraModel(200, 160, [[190, 0, 90], [0, 200, 85], [0, 0, 1]]),
    ):
        normal = truth[:3, 2]
        depth = (normal @ truth[:3, 3]) / (view_of(other).rays @ normal)
        depth = depth.astype(np.float32) if dtype is np.float32 else np.rint(1000 * depth)
        tag_depth = TagDepth(depth.astype(dtype), other, rv.DepthErrorParams())
        plane = tag_depth.plane_of(corners, camera)
        limit = 1e-4 if dtype is np.float32 else 0.01
        assert np.abs(plane.inverse_depth - expected).max() < limit
        assert plane.pixels > 100
        poses = rv.estimate_pose(
            rv.single_tag(0, 0.2), {0: rv.MeasuredCorners(corners, plane=plane)}, camera
        )
        assert poses.planes == 1
        assert np.abs(error_of(poses.best.pose, truth)).max() < 2e-3


def test_a_part_of_a_tag_outside_of_the_depth_image_is_left_out():
    camera = narrow_camera(200, 150)
    truth = matrix(turned([0.3, 0.0, 0.0]) @ FACING, [0.1, 0.0, 1.0])
    corners = corners_of(truth, camera, 0.15)
    other = narrow_camera(120, 150)  # ends in the middle of the tag
    view = view_of(other)
    depth = TagDepth(view.image(truth, 0, np.random.default_rng(0)), other, rv.DepthErrorParams())
    plane = depth.plane_of(corners, camera)
    assert plane is not None and plane.pixels < 0.75 * 79 * 79
    assert depth.plane_of(corners + np.array([1000.0, 0.0]), camera) is None


HOLES = {
    "none at all": lambda depth: np.full_like(depth, NAN),
    "zeros": np.zeros_like,
    "infinities": lambda depth: np.full_like(depth, np.inf),
    "negative": lambda depth: -depth,
    "in mm": lambda depth: depth * 1000,
    "in km": lambda depth: depth / 1000,
    "tiny": lambda depth: depth * np.float32(1e-38),
    "huge": lambda depth: depth * np.float32(1e37),
    "noise": lambda depth: np.random.default_rng(0).uniform(0, 5, depth.shape).astype(np.float32),
    "a step": lambda depth: np.where(np.arange(depth.shape[1]) % 40 < 20, depth, depth + 1),
    "ten times too far": lambda depth: depth * 10,
    "near and far": lambda depth: np.where(np.indices(depth.shape).sum(0) % 2, 1e-30, 1e30),
}


@pytest.mark.parametrize("what", HOLES)
def test_depths_that_cannot_be_leave_the_pose_of_the_corners(what):
    camera = narrow_camera(160, 120)
    truth = matrix(turned([0.5, 0.2, 0.0]) @ FACING, [0.0, 0.0, 1.0])
    corners = corners_of(truth, camera, 0.15)
    exact = view_of(camera).image(truth, 0, np.random.default_rng(0))
    plane = rv.measure_tag_plane(HOLES[what](exact).astype(np.float32), corners, camera)
    tag, seen = rv.single_tag(0, 0.15), rv.MeasuredCorners(corners, plane=plane)
    alone, both = (rv.estimate_pose(tag, {0: one}, camera) for one in (corners, seen))
    tracked = rv.TagPoseTracker(tag).update(0.0, {0: seen}, camera)
    for poses in (both, tracked):
        assert np.isfinite(poses.best.pose).all() and np.isfinite(poses.best.covariance).all()
        assert np.abs(error_of(poses.best.pose, alone.best.pose)).max() < 1e-3
        variances = np.linalg.eigvalsh(poses.best.covariance)
        assert variances[0] > -1e-9 * variances[-1]


def test_arrays_that_are_no_depths_are_refused():
    camera = narrow_camera(64, 48)
    corners = np.array([[10, 30], [30, 30], [30, 10], [10, 10]], float)
    for depth, error, reason in (
        (np.zeros((48, 64), np.uint8), TypeError, "expected depths of uint16 .* or float32"),
        (np.zeros((48, 64, 2), np.float32), ValueError, "expected a \\(height, width\\) array"),
        (np.zeros((24, 64), np.float32), ValueError, "size of the depth image is 64x24, must be"),
    ):
        with pytest.raises(error, match=reason):
            rv.measure_tag_plane(depth, corners, camera)
    depth = np.ones((48, 64), np.float32)
    with pytest.raises(ValueError, match="4, 2"):
        rv.measure_tag_plane(depth, corners[:3], camera)
    with pytest.raises(ValueError, match="depth_noise is 2, must be"):
        rv.measure_tag_plane(depth, corners, camera, errors_of(depth_noise=2.0))
    with pytest.raises(ValueError, match="3 numbers"):
        rv.DepthPlane([1.0, 2.0], np.eye(3))
    with pytest.raises(ValueError, match="positive definite"):
        rv.DepthPlane([0.0, 0.0, 1.0], np.zeros((3, 3)))
    assert rv.MeasuredCorners(corners).covariance is None
    assert rv.MeasuredCorners(corners).plane is None
    plane = rv.DepthPlane([0.0, 0.1, 1.0], 2.0 * np.eye(3), 9)
    found = rv.MeasuredCorners(corners, plane=plane).plane
    assert found.pixels == 9 and np.array_equal(found.covariance, 2.0 * np.eye(3))
    assert np.array_equal(found.inverse_depth, [0.0, 0.1, 1.0])
