"""The scene's cameras, its depth, and the noise of depth sensors, as Python has them."""

import functools

import cv2
import numpy as np
import pytest

import robot_vision as rv

HALF_TAG = 0.12  # m


@functools.lru_cache(maxsize=None)
def scene(width=640, height=480):
    params = rv.SceneParams()
    params.width, params.height, params.noise = width, height, 0.0
    return rv.Scene(params)


def found(name, frame=0):
    return next(one for one in scene().truth(frame).objects if one.name == name)


def facing(camera, z):
    """The depth of a wall, and a brightness that nothing is lost at."""
    shape = (camera.height, camera.width)
    return np.full(shape, z, np.float32), np.full(shape, 200, np.uint8)


def test_cameras_of_the_views():
    assert np.array_equal(scene().view_pose("color"), np.eye(4))
    assert np.allclose(scene().view_pose("right")[:3, 3], (0.1, 0.0, 0.0))
    assert np.allclose(scene().view_pose("depth")[:3, 3], (-0.025, 0.0, 0.0))
    assert np.array_equal(scene().view_camera("right").K, scene().camera.K)
    depth = scene().view_camera("depth")
    assert (depth.width, depth.height) == (640, 480) and depth.K[0, 0] < scene().camera.K[0, 0]
    for call in (scene().view_camera, scene().view_pose):
        with pytest.raises(ValueError, match=r"^view is 'left', must be color, right or depth$"):
            call("left")


def test_images_of_the_views():
    assert np.array_equal(scene().render(5), scene().render(5, "color"))
    assert scene().render(5, "right").shape == (480, 640, 3)
    with pytest.raises(ValueError, match=r"^view is 'depth', must be color or right"):
        scene().render(5, "depth")
    for view in ("color", "right", "depth"):
        depth = scene().render_depth(5, view)
        assert depth.shape == (480, 640) and depth.dtype == np.float32
    assert np.array_equal(scene().render_depth(5), depth)
    with pytest.raises(ValueError, match=r"^view is 'left'"):
        scene().render_depth(5, "left")


def test_tags_are_where_the_truth_is_for_both_cameras_of_the_pair():
    detector = rv.TagDetector(rv.TagDetectorParams())
    corners = HALF_TAG * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    for view in ("color", "right"):
        gray = cv2.cvtColor(scene().render(0, view), cv2.COLOR_BGR2GRAY)
        tags = {tag.id: tag for tag in detector.detect(gray, "mono8")}
        assert set(tags) == {0, 1}
        for number, tag in tags.items():
            pose = np.linalg.inv(scene().view_pose(view)) @ found(f"tag_{number}").pose
            expected, _ = scene().camera.project(corners @ pose[:3, :3].T + pose[:3, 3])
            assert np.abs(tag.corners - expected).max() < 0.3, view


def test_depth_of_a_tag_is_that_of_its_plane():
    camera, pose = scene().view_camera("depth"), found("tag_1").pose
    pose = np.linalg.inv(scene().view_pose("depth")) @ pose
    normal, origin = pose[:3, 2], pose[:3, 3]
    (pixel,), _ = camera.project(origin[np.newaxis])
    x, y = np.rint(pixel).astype(int)
    ray = np.append(camera.rays([(x, y)])[0], 1.0)
    expected = normal @ origin / (normal @ ray)
    assert scene().render_depth(0)[y, x] == pytest.approx(expected, abs=1e-5)
    assert abs(expected - origin[2]) < 0.01


def test_depth_is_nan_where_there_is_nothing():
    depth = rv.CalibrationScene(rv.SceneParams()).render_depth(0)
    assert 0.1 < np.isnan(depth).mean() < 0.95


@pytest.mark.parametrize("sensor, deviation", [("kinect", 6.1), ("stereo", 15.9), ("tof", 2.3)])
def test_noise_of_a_sensor(sensor, deviation):
    """At 2 m, in mm. The disparities of this wall are a little beside the steps."""
    camera = scene().view_camera("depth")
    exact, light = facing(camera, 2.0)
    exact /= np.linspace(0.99, 1.01, camera.width, dtype=np.float32)
    before = exact.copy()
    noise = rv.DepthNoise(sensor, camera, 3)
    noisy = noise.apply(7, exact, light)
    assert noisy.shape == exact.shape and noisy.dtype == np.float32
    assert 1000.0 * (noisy - exact).std() == pytest.approx(deviation, rel=0.05)
    assert np.array_equal(exact, before)
    assert np.array_equal(rv.DepthNoise(sensor, camera, 3).apply(7, exact, light), noisy)
    assert not np.array_equal(noise.apply(8, exact, light), noisy)
    assert not np.array_equal(rv.DepthNoise(sensor, camera).apply(7, exact, light), noisy)


def test_without_noise_depth_stays_as_it_is():
    exact = scene().render_depth(0)
    none = rv.DepthNoise("none", scene().view_camera("depth"))
    assert np.array_equal(none.apply(0, exact), exact)


def test_the_room_as_a_kinect_measures_it():
    """A little is lost: what the projector does not reach. The rest is near the truth."""
    exact = scene().render_depth(0)
    noisy = rv.DepthNoise("kinect", scene().view_camera("depth")).apply(0, exact)
    seen = ~np.isnan(noisy)
    assert 0.9 < seen.mean() < 1.0
    deviation = 0.0012 + 0.0019 * (exact - 0.4) ** 2
    assert ((noisy - exact)[seen] / deviation[seen]).std() == pytest.approx(1.0, abs=0.05)


def test_arrays_of_other_layouts_are_taken():
    camera = scene(320, 240).view_camera("depth")
    noise = rv.DepthNoise("kinect", camera)
    exact = scene(320, 240).render_depth(0)
    expected = noise.apply(0, exact)
    with_gaps = np.repeat(exact, 2, axis=1)[:, ::2]
    for same in (np.asfortranarray(exact), exact.astype(np.float64), with_gaps):
        np.testing.assert_array_equal(noise.apply(0, same), expected)


def test_what_is_no_depth_is_refused():
    camera = scene().view_camera("depth")
    exact, light = facing(camera, 1.5)
    noise = rv.DepthNoise("tof", camera)
    with pytest.raises(ValueError, match=r"^sensor is 'sonar', must be none, kinect"):
        rv.DepthNoise("sonar", camera)
    with pytest.raises(TypeError, match="expected depth as an array of float32, got uint16"):
        noise.apply(0, (1000.0 * exact).astype(np.uint16))
    with pytest.raises(ValueError, match=r"expected a \(height, width\) array of depth"):
        noise.apply(0, exact[:, :, np.newaxis])
    with pytest.raises(ValueError, match="depth image is 639x480, must be that of the camera"):
        noise.apply(0, exact[:, 1:])
    with pytest.raises(ValueError, match="brightness image is 640x479, must be that"):
        noise.apply(0, exact, light[1:])
    with pytest.raises(ValueError, match="depth image of 0x480 is empty"):
        noise.apply(0, exact[:, :0])
