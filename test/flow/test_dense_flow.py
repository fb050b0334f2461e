"""Dense flow of textures that move in a known way, against the truth and OpenCV."""

import math
import os
import subprocess
import sys

import cv2
import numpy as np
import pytest

import robot_vision as rv

WIDTH, HEIGHT = 160, 120
BORDER = 16  # px, where the texture that comes in was not seen before
METHODS = ("farneback", "dis")
PRESETS = {
    "ultrafast": cv2.DISOPTICAL_FLOW_PRESET_ULTRAFAST,
    "fast": cv2.DISOPTICAL_FLOW_PRESET_FAST,
    "medium": cv2.DISOPTICAL_FLOW_PRESET_MEDIUM,
}


def clouds():
    """A gray texture, larger than the images, with details of every size."""
    rng = np.random.default_rng(3)
    layers = [
        cv2.resize(rng.normal(0.0, size**0.5, (320 // size, 320 // size)), (320, 320))
        for size in (2, 4, 8, 16, 32)
    ]
    texture = sum(layers)
    return np.clip(128 + 40 * texture / texture.std(), 0, 255).astype(np.uint8)


TEXTURE = clouds()


def moved(motion):
    """The image after a motion, 3x3, of the one before: positions in px to positions."""
    window = np.float64([[1, 0, -80], [0, 1, -100], [0, 0, 1]])
    return cv2.warpAffine(TEXTURE, (motion @ window)[:2], (WIDTH, HEIGHT), flags=cv2.INTER_CUBIC)


def shift(x, y):
    return np.float64([[1, 0, x], [0, 1, y], [0, 0, 1]])


def turn(degrees, scale):
    middle = ((WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    return np.vstack([cv2.getRotationMatrix2D(middle, degrees, scale), [0, 0, 1]])


FIRST = moved(shift(0, 0))
SECOND = moved(shift(3, -2))


def params(**values):
    made = rv.DenseFlowParams()
    for name, value in values.items():
        setattr(made, name, value)
    return made


def flow_of(first, second, encoding="mono8", **values):
    finder = rv.DenseFlow(params(**values))
    assert finder.update(0.0, first, encoding) is None
    return finder.update(0.1, second, encoding)


def farneback(first, second, values):
    """OpenCV's flow with the same parameters."""
    used = {name: getattr(params(**values), name) for name in FARNEBACK}
    flags = cv2.OPTFLOW_FARNEBACK_GAUSSIAN if used.pop("gaussian_window") else 0
    return cv2.calcOpticalFlowFarneback(first, second, None, *used.values(), flags)


# In the order of OpenCV's arguments, with another value than the default.
FARNEBACK = {
    "pyr_scale": 0.7,
    "levels": 0,
    "window": 9,
    "iterations": 1,
    "poly_n": 7,
    "poly_sigma": 1.5,
    "gaussian_window": True,
}


@pytest.mark.parametrize("changed", [None, *FARNEBACK])
def test_farneback_equals_opencv_with_each_parameter(changed):
    values = {changed: FARNEBACK[changed]} if changed else {}
    flow = flow_of(FIRST, SECOND, method="farneback", scale=1.0, **values)
    assert (flow.dtype, flow.shape) == (np.float32, (HEIGHT, WIDTH, 2))
    assert np.array_equal(flow, farneback(FIRST, SECOND, values))
    if changed:
        assert not np.array_equal(flow, farneback(FIRST, SECOND, {}))


def dis(first, second, preset="medium"):
    """OpenCV's flow."""
    return cv2.DISOpticalFlow_create(PRESETS[preset]).calc(first, second, None)


def test_dis_equals_opencv_with_each_preset():
    flows = [flow_of(FIRST, SECOND, scale=1.0, preset=preset) for preset in PRESETS]
    for preset, flow in zip(PRESETS, flows):
        assert np.array_equal(flow, dis(FIRST, SECOND, preset)), preset
    assert len({flow.tobytes() for flow in flows}) == len(PRESETS)


ONE_THREAD = """
import os
import numpy as np
import robot_vision as rv
rv.set_threads(4)
params = rv.DenseFlowParams()
params.scale = 1.0
finder = rv.DenseFlow(params)
before = len(os.listdir("/proc/self/task"))
for time in range(2):
    finder.update(time, np.random.default_rng(time).integers(0, 256, (240, 320), np.uint8), "mono8")
print(len(os.listdir("/proc/self/task")) - before)
"""


def test_one_thread_does_it():
    env = {key: value for key, value in os.environ.items() if key != "OPENCV_FOR_THREADS_NUM"}
    command = [sys.executable, "-c", ONE_THREAD]
    result = subprocess.run(command, stdout=subprocess.PIPE, env=env, check=True, text=True)
    assert int(result.stdout) == 0


def test_each_flow_begins_with_nothing():
    """DIS would take the last flow for a first guess."""
    finder = rv.DenseFlow(params(scale=1.0))
    third = moved(shift(-4, 5))
    finder.update(0.0, FIRST, "mono8")
    finder.update(0.1, SECOND, "mono8")
    flow = finder.update(0.2, third, "mono8")
    assert np.array_equal(flow, dis(SECOND, third))


@pytest.mark.parametrize("scale", [1.0, 0.5])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "motion",
    [shift(4, -2.5), shift(-7, 6), turn(2.0, 1.0), turn(0.0, 1.03)],
    ids=["shift", "large shift", "rotation", "zoom"],
)
def test_motion_is_found(motion, method, scale):
    flow = flow_of(FIRST, moved(motion), method=method, scale=scale)
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    places = np.stack([x, y, np.ones_like(x)], axis=2)
    truth = (places @ motion.T)[:, :, :2] - places[:, :, :2]
    errors = np.linalg.norm(flow - truth, axis=2)[BORDER:-BORDER, BORDER:-BORDER]
    assert np.median(errors) < 0.15 and np.percentile(errors, 95) < 0.4


def test_smaller_scales_find_the_same_at_less_detail():
    flows = {scale: flow_of(FIRST, SECOND, scale=scale) for scale in (1.0, 0.5, 0.3)}
    for scale, flow in flows.items():
        assert flow.shape == (HEIGHT, WIDTH, 2)
        pixel = 1.0 / scale  # of the image in which it is found
        assert rv.median_flow(flow) == pytest.approx((3, -2), abs=pixel / 30)
    assert len({flow.tobytes() for flow in flows.values()}) == 3


def test_frames_that_follow_on_none_begin_anew():
    finder = rv.DenseFlow(params(max_gap=0.5))
    small = FIRST[:100]
    for time, image, found in [
        (10.0, FIRST, False),
        (10.1, SECOND, True),
        (10.6, FIRST, True),
        (11.2, SECOND, False),  # after a gap
        (11.3, FIRST, True),
        (11.4, small, False),
        (11.5, small, True),
        (5.0, small, False),  # a recording that begins again
        (5.0, small, True),  # stamps that stand still
        (math.nan, small, False),
        (5.2, small, False),
        (5.3, small, True),
    ]:
        assert (finder.update(time, image, "mono8") is not None) == found, time
    finder.reset()
    assert finder.update(5.4, small, "mono8") is None


def test_the_interval_is_that_between_both_frames():
    finder = rv.DenseFlow()
    assert finder.interval == 0.0
    for time, interval in [(1.0, 0.0), (1.25, 0.25), (1.25, 0.0), (2.25, 1.0), (0.0, 0.0)]:
        finder.update(time, FIRST, "mono8")
        assert finder.interval == interval


@pytest.mark.parametrize(
    "encoding, convert",
    [
        ("bgr8", lambda gray: cv2.cvtColor(gray, cv2.COLOR_GRAY2BGR)),
        ("rgba8", lambda gray: cv2.cvtColor(gray, cv2.COLOR_GRAY2RGBA)),
        ("mono16", lambda gray: gray.astype(np.uint16) * 257),
        ("yuv422_yuy2", lambda gray: np.dstack([gray, np.full_like(gray, 128)])),
    ],
)
def test_images_of_any_encoding_are_taken_and_not_modified(encoding, convert):
    images = []
    for gray in (FIRST, SECOND):
        image = convert(gray)
        padded = np.full((HEIGHT, WIDTH + 7, *image.shape[2:]), 99, image.dtype)
        padded[:, :WIDTH] = image
        images.append(padded[:, :WIDTH])
    before = [image.copy() for image in images]
    flow = flow_of(*images, encoding)
    assert np.array_equal(flow, flow_of(FIRST, SECOND))
    assert all(map(np.array_equal, images, before))


@pytest.mark.parametrize(
    "shape", [(1, 1), (1, 40), (40, 1), (16, 200), (33, 47), (60, 80), (93, 31), (95, 95)]
)
@pytest.mark.parametrize("values", [{"method": "farneback"}, *({"preset": p} for p in PRESETS)])
def test_small_and_odd_images(values, shape):
    first, second = np.resize(FIRST, shape), np.resize(SECOND, shape)
    for scale in (1.0, 0.5):
        flow = flow_of(first, second, scale=scale, **values)
        assert flow.shape == (*shape, 2) and np.isfinite(flow).all()


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("size", [(20, 160), (120, 20), (60, 80)])
def test_small_images_move_as_large_ones(size, preset):
    """OpenCV's DIS fails for such sizes, not in all versions with an error."""
    first, second = (image[: size[0], : size[1]] for image in (FIRST, SECOND))
    flow = flow_of(first, second, scale=1.0, preset=preset)
    assert rv.median_flow(flow) == pytest.approx((3, -2), abs=0.7)


def test_images_that_dis_cannot_have_are_refused():
    long = np.zeros((1, 16385), np.uint8)
    with pytest.raises(ValueError, match="is 16385, must be at most 16384 px with dis"):
        flow_of(long, long, scale=1.0)
    assert flow_of(long, long, scale=0.5).shape == (1, 16385, 2)
    assert flow_of(long, long, scale=1.0, method="farneback").shape == (1, 16385, 2)


def test_what_would_take_many_seconds_is_refused():
    slow = {"window": 99, "iterations": 20, "levels": 10, "pyr_scale": 0.9, "gaussian_window": True}
    image = np.zeros((1080, 1920), np.uint8)
    limit = r"must be less, or the image of 1920x1080 have at most \d+ pixels"
    with pytest.raises(
        ValueError, match=f"^window, iterations, levels are 99, 20, 10 at scale 1, {limit}$"
    ):
        flow_of(image, image, scale=1.0, method="farneback", **slow)
    small = image[:32, :48]
    assert flow_of(small, small, scale=1.0, method="farneback", **slow).shape == (32, 48, 2)


@pytest.mark.parametrize("level", [0, 255])
@pytest.mark.parametrize("method", METHODS)
def test_nothing_moves_where_nothing_can_be_seen(method, level):
    plain = np.full((HEIGHT, WIDTH), level, np.uint8)
    assert np.abs(flow_of(plain, plain, method=method)).max() < 1e-3


def test_mean_and_median():
    flow = np.zeros((3, 5, 2), np.float32)
    flow[..., 0] = np.arange(15).reshape(3, 5)
    flow[0, 0] = (1, 150)
    assert rv.mean_flow(flow) == pytest.approx((106 / 15, 10))
    assert rv.median_flow(flow) == (7, 0)
    assert rv.median_flow(flow[:1, :4]) == (2, 0)  # of 1, 1, 2, 3 the upper one in the middle
    flow[2, 4, 0] = np.nan
    for average, expected in ((rv.mean_flow, 10), (rv.median_flow, 0)):
        x, y = average(flow)
        assert math.isnan(x) and y == pytest.approx(expected)


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("method", "lucas", "method is lucas, must be farneback or dis"),
        ("preset", "slow", "preset is slow, must be ultrafast, fast or medium"),
        ("scale", 0.0, "scale is 0, must be from 0.05 to 1"),
        ("window", 4, "window is 4, must be odd and from 3 to 99"),
        ("poly_n", 6, "poly_n is 6, must be 5 or 7"),
        ("max_gap", 0.0, "max_gap is 0, must be above 0 and at most 3600"),
    ],
)
def test_parameters_are_refused(name, value, text):
    with pytest.raises(ValueError, match=text):
        rv.DenseFlow(params(**{name: value}))


def test_what_is_no_image_is_refused_and_forgotten():
    finder = rv.DenseFlow()
    finder.update(0.0, FIRST, "mono8")
    with pytest.raises(ValueError, match="bgr8 image of 160x120: expected pixels of 3 x 8 bits"):
        finder.update(0.1, FIRST, "bgr8")
    assert rv.median_flow(finder.update(0.2, SECOND, "mono8")) == pytest.approx((3, -2), abs=0.1)
    for wrong in (np.zeros((4, 4)), np.zeros((4, 4, 3)), np.zeros((0, 4, 2))):
        with pytest.raises(ValueError, match=r"expected a \(height, width, 2\) array|is empty"):
            rv.mean_flow(wrong)
