"""The bindings: arrays, parameters and errors. The gtests test the algorithms."""

import cv2
import numpy as np
import pytest

import robot_vision as rv


@pytest.fixture
def image():
    return np.random.RandomState(1).randint(0, 256, (48, 64, 3), np.uint8)


def opencv_edges(gray):
    return cv2.Canny(cv2.blur(gray, (7, 7)), 15, 30)


def test_edges_equal_opencv(image):
    before = image.copy()
    edges = rv.find_edges(image)
    assert np.array_equal(edges, opencv_edges(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)))
    assert np.array_equal(image, before)
    assert np.array_equal(
        rv.find_edges(image[:, :, 0].copy(), "mono8"), opencv_edges(image[:, :, 0])
    )


def test_rows_may_be_padded(image):
    part = image[4:40, 10:50]
    assert not part.flags.c_contiguous
    assert np.array_equal(rv.find_edges(part), rv.find_edges(part.copy()))


@pytest.mark.parametrize(
    "part", [np.s_[:, ::2], np.s_[::-1], np.s_[:, :, ::-1], np.s_[:, ::-1, :2]], ids=str
)
def test_any_other_layout_is_copied(image, part):
    view = image[part]
    encoding = "bgr8" if view.shape[2] == 3 else "yuv422"
    assert np.array_equal(rv.find_edges(view, encoding), rv.find_edges(view.copy(), encoding))
    channel = view[:, :, 1]
    assert np.array_equal(rv.find_edges(channel, "mono8"), opencv_edges(channel.copy()))


def test_brightness_equals_opencv(image):
    params = rv.BrightnessParams()
    params.gain = 1.5
    params.offset = -20
    assert np.array_equal(
        rv.adjust_brightness(image, "rgb8", params), np.clip(np.rint(image * 1.5 - 20), 0, 255)
    )
    wide = np.arange(64, dtype=np.uint16).reshape(8, 8) * 1000
    assert np.array_equal(
        rv.adjust_brightness(wide, "mono16"), np.minimum(wide + 50.0 * 257, 65535)
    )


def test_misaligned_samples_are_read():
    bytes_of_noise = np.random.default_rng(3).integers(0, 256, 1 + 4 * 9, np.uint8)
    odd_place = np.frombuffer(bytes_of_noise.tobytes(), np.uint16, 16, offset=1).reshape(4, 4)
    odd_rows = np.ndarray((4, 4), np.uint16, bytes_of_noise.tobytes(), 0, (9, 2))
    for wide in (odd_place, odd_rows):
        expected = np.minimum(wide.astype(int) + 50 * 257, 65535)
        assert np.array_equal(rv.adjust_brightness(wide, "mono16"), expected)


@pytest.mark.parametrize(
    "array, encoding, error",
    [
        (np.zeros((4, 4, 3), np.float32), "bgr8", TypeError),
        (np.zeros((4, 4, 3), np.int8), "bgr8", TypeError),
        (np.zeros(16, np.uint8), "mono8", ValueError),
        (np.zeros((4, 4, 5), np.uint8), "bgr8", ValueError),
        (np.zeros((4, 4), np.uint8), "bgr8", ValueError),
        (np.zeros((0, 4, 3), np.uint8), "bgr8", ValueError),
        (np.zeros((4, 4, 3), np.uint8), "rgb565", ValueError),
        (np.zeros((4, 5, 2), np.uint8), "yuv422", ValueError),
    ],
)
def test_invalid_images_are_refused(array, encoding, error):
    with pytest.raises(error):
        rv.find_edges(array, encoding)


def test_results_outlive_their_source(image):
    edges = rv.find_edges(image)
    expected = edges.copy()
    del image
    assert np.array_equal(edges, expected)


def test_line_is_found_in_a_mask():
    mask = np.zeros((60, 320), np.uint8)
    mask[:, 200:241] = 255
    mask[10:50, 20:71] = 255
    before = mask.copy()
    line = rv.find_line(mask)
    assert line.found
    assert line.center == (220.0, 29.5) and line.area == 41 * 60
    assert (line.offset, line.error, line.angle) == (60.5, 60.5 / 160.0, 0.0)
    assert line.outline.dtype == np.int32
    assert sorted(map(tuple, line.outline)) == [(200, 0), (200, 59), (240, 0), (240, 59)]
    assert np.array_equal(mask, before)
    # The smaller region is chosen if the previous line was there.
    left = rv.find_line(mask[:, :160])
    assert left.center == (45.0, 29.5)
    assert rv.find_line(mask, previous=left).center == left.center


def test_no_line_is_not_found():
    line = rv.find_line(np.zeros((60, 320), np.uint8))
    assert not line.found and line.confidence == 0.0 and line.outline.shape == (0, 2)
    params = rv.LineParams()
    params.min_area = 1201.0
    assert not rv.find_line(np.full((30, 40), 255, np.uint8), params).found
    with pytest.raises(ValueError):
        rv.find_line(np.zeros((4, 4, 3), np.uint8))


def test_scene_is_rendered_with_its_truth():
    params = rv.SceneParams()
    params.noise = 0.0
    scene = rv.Scene(params)
    objects = {o.name: o for o in scene.truth(0).objects}
    assert {"ball", "tag_0", "tag_1", "qr_code", "checkerboard", "line", "box", "poster"} <= set(
        objects
    )
    image = scene.render(0)
    assert image.shape == (480, 640, 3)
    ball = objects["ball"]
    assert ball.outline.shape[1] == 2 and ball.pose.shape == (4, 4)
    # The scene's camera projects the true position to the true centre, and the ball is blue there.
    point, _ = cv2.projectPoints(
        ball.pose[:3, 3].reshape(1, 3),
        np.zeros(3),
        np.zeros(3),
        scene.camera.K,
        np.array(scene.camera.D),
    )
    assert np.allclose(point.ravel(), ball.center, atol=1e-6)
    x, y = np.rint(ball.center).astype(int)
    blue, green, red = image[y, x].astype(int)
    assert blue > green + 40 and blue > red + 40


def test_poster_hangs_on_the_wall():
    params = rv.SceneParams()
    params.noise = 0.0
    scene = rv.Scene(params, np.full((30, 20, 3), (0, 255, 0), np.uint8))
    poster = next(o for o in scene.truth(0).objects if o.name == "poster")
    x, y = np.rint(poster.center).astype(int)
    blue, green, red = scene.render(0)[y, x].astype(int)
    assert green > blue + 60 and green > red + 60
