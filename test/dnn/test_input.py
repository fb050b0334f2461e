"""What a network gets, bit for bit as plain NumPy computes it, and where things are in it."""

import cv2
import numpy as np
import pytest

import robot_vision as rv

COCO_MEAN, COCO_STD = (123.675, 116.28, 103.53), (58.395, 57.12, 57.375)


def params(**values):
    made = rv.InputParams()
    for name, value in values.items():
        setattr(made, name, value)
    return made


def noise(height, width, seed=0):
    return np.random.default_rng(seed).integers(0, 256, (height, width, 3), np.uint8)


def filled(image, wanted, roi=None):
    shape = (3, wanted.height, wanted.width) if wanted.layout == "nchw" else None
    out = np.full((1, *(shape or (wanted.height, wanted.width, 3))), np.nan, np.float32)
    return rv.fill_input(image, roi, wanted, out), out


def samples(length, resized):
    """The pixels before and after each one of a resized side, and the share of the second."""
    at = np.maximum((np.arange(resized) + 0.5) * (length / resized) - 0.5, 0.0)
    first = np.minimum(at.astype(int), length - 1)
    last = first == length - 1
    return (
        first,
        np.minimum(first + 1, length - 1),
        np.where(last, 0, at - first).astype(np.float32),
    )


def resized_by_numpy(image, width, height):
    """In float32, rows first; NumPy rounds each operation by itself, too."""
    pixels = image.astype(np.float32)
    a, b, share = samples(image.shape[0], height)
    rows = pixels[a] + (pixels[b] - pixels[a]) * share[:, None, None]
    a, b, share = samples(image.shape[1], width)
    return rows[:, a] + (rows[:, b] - rows[:, a]) * share[None, :, None]


def place_by_numpy(size, wanted):
    """x, y, width, height of the image in the input."""
    if wanted.fit == "stretch":
        return 0, 0, wanted.width, wanted.height
    scale = min(wanted.width / size[0], wanted.height / size[1])
    width, height = (max(1, int(side * scale + 0.5)) for side in size)
    width, height = min(width, wanted.width), min(height, wanted.height)
    if wanted.fit == "corner":
        return 0, 0, width, height
    return (wanted.width - width) // 2, (wanted.height - height) // 2, width, height


def by_numpy(image, wanted):
    x, y, width, height = place_by_numpy((image.shape[1], image.shape[0]), wanted)
    canvas = np.full((wanted.height, wanted.width, 3), wanted.pad, np.float32)
    canvas[y : y + height, x : x + width] = resized_by_numpy(image, width, height)
    if wanted.order == "rgb":
        canvas = canvas[:, :, ::-1]
    factor = np.array([np.float32(1.0 / std) for std in wanted.std], np.float32)
    offset = np.array([np.float32(-m / s) for m, s in zip(wanted.mean, wanted.std)], np.float32)
    values = canvas * factor + offset
    return values.transpose(2, 0, 1)[None] if wanted.layout == "nchw" else values[None]


SIZES = [(48, 64), (64, 48), (1, 1), (1, 7), (5, 1), (33, 17), (100, 333), (480, 640), (16, 16)]
WANTED = [
    {"width": 32, "height": 32},
    {"width": 41, "height": 23, "order": "bgr", "pad": 0},
    {"width": 64, "height": 32, "fit": "stretch", "mean": COCO_MEAN, "std": COCO_STD},
    {"width": 33, "height": 65, "fit": "corner", "mean": (1, 2, 3), "std": (1, 1, 1)},
    {"width": 50, "height": 40, "layout": "nhwc", "mean": COCO_MEAN, "std": COCO_STD},
    {"width": 1, "height": 1},
    {"width": 300, "height": 200, "fit": "stretch", "order": "bgr", "layout": "nhwc"},
]


@pytest.mark.parametrize("wanted", WANTED, ids=str)
@pytest.mark.parametrize("size", SIZES, ids=str)
def test_input_has_the_bits_that_numpy_computes(size, wanted):
    image = noise(*size)
    before = image.copy()
    wanted = params(**wanted)
    _, out = filled(image, wanted)
    np.testing.assert_array_equal(out, by_numpy(image, wanted))
    np.testing.assert_array_equal(image, before)


@pytest.mark.parametrize("layout", ["nchw", "nhwc"])
def test_region_is_filled_as_if_it_were_the_image(layout):
    image = noise(60, 90)
    wanted = params(width=40, height=40, layout=layout)
    placement, out = filled(image, wanted, (7, 5, 51, 33))
    np.testing.assert_array_equal(out, by_numpy(image[5:38, 7:58], wanted))
    assert (placement.x, placement.y) == (7, 5)


def test_padded_rows_and_views_are_read_as_they_are():
    wide = noise(30, 80)
    wanted = params(width=24, height=24)
    for view in (wide[:, 3:60], wide[::2], wide[:, ::-1], wide[:, ::3]):
        _, out = filled(view, wanted)
        np.testing.assert_array_equal(out, by_numpy(np.ascontiguousarray(view), wanted))


@pytest.mark.parametrize("size", [(48, 64), (240, 320), (31, 57)])
def test_pixels_are_sampled_where_opencv_samples_them(size):
    image = noise(*size)
    wanted = params(width=80, height=50, fit="stretch", order="bgr", std=(1, 1, 1))
    _, out = filled(image, wanted)
    theirs = cv2.resize(image, (80, 50), interpolation=cv2.INTER_LINEAR)
    assert np.abs(out[0].transpose(1, 2, 0) - theirs).max() <= 1.0  # gray levels: theirs are whole


@pytest.mark.parametrize(
    "fit, size, scale, corner",
    [
        ("letterbox", (480, 640), (0.65, 0.65), (0, 52)),
        ("letterbox", (640, 480), (0.65, 0.65), (52, 0)),
        ("letterbox", (100, 301), (416 / 301, 138 / 100), (0, 139)),
        ("corner", (480, 640), (0.65, 0.65), (0, 0)),
        ("stretch", (480, 640), (0.65, 416 / 480), (0, 0)),
        ("letterbox", (1, 4096), (416 / 4096, 1.0), (0, 207)),
    ],
)
def test_placement_says_where_the_image_is(fit, size, scale, corner):
    placement, _ = filled(noise(*size), params(width=416, height=416, fit=fit))
    assert (placement.scale_x, placement.scale_y) == pytest.approx(scale)
    assert (placement.left, placement.top) == corner


def test_a_bright_spot_is_where_the_placement_says():
    image = np.zeros((120, 160, 3), np.uint8)
    cv2.rectangle(image, (60, 70), (67, 77), (255, 255, 255), -1)  # its middle is at (64, 74)
    for fit in ("letterbox", "corner", "stretch"):
        placement, out = filled(
            image, params(width=96, height=160, fit=fit, pad=0), (20, 10, 130, 90)
        )
        light = out[0].sum(axis=0)
        ys, xs = np.mgrid[: light.shape[0], : light.shape[1]] + 0.5
        spot = (xs * light).sum() / light.sum(), (ys * light).sum() / light.sum()
        x = placement.scale_x * (64 - placement.x) + placement.left
        y = placement.scale_y * (74 - placement.y) + placement.top
        assert spot == pytest.approx((x, y), abs=0.1)


@pytest.mark.parametrize(
    "roi",
    [
        (0, 0, 65, 48),
        (-1, 0, 5, 5),
        (0, 48, 1, 1),
        (3, 3, 0, 5),
        (3, 3, 5, -2),
        (2**31 - 1, 0, 9, 9),
    ],
)
def test_region_that_is_not_inside_the_image_is_refused(roi):
    with pytest.raises(ValueError, match="is not inside the image of 64x48"):
        filled(noise(48, 64), params(), roi)


@pytest.mark.parametrize(
    "image, error",
    [
        (np.zeros((0, 0, 3), np.uint8), ValueError),
        (np.zeros((4, 4), np.uint8), ValueError),
        (np.zeros((4, 4, 4), np.uint8), ValueError),
        (np.zeros((4, 4, 3), np.uint16), ValueError),
        (np.zeros((4, 4, 3), np.float32), TypeError),
        (np.zeros((4,), np.uint8), ValueError),
    ],
)
def test_what_is_no_bgr_image_is_refused(image, error):
    with pytest.raises(error):
        filled(image, params())


READ_ONLY = np.zeros((1, 3, 8, 8), np.float32)
READ_ONLY.flags.writeable = False


@pytest.mark.parametrize(
    "out, error, words",
    [
        (np.zeros((1, 3, 8, 9), np.float32), ValueError, r"out is \(1, 3, 8, 9\).*\(1, 3, 8, 8\)"),
        (np.zeros((1, 8, 8, 3), np.float32), ValueError, r"\(1, 3, 8, 8\)"),
        (np.zeros((2, 3, 8, 8), np.float32), ValueError, r"\(1, 3, 8, 8\)"),
        (np.zeros((3, 8, 8), np.float32), ValueError, "4 dimensions"),
        (np.zeros((), np.float32), ValueError, "4 dimensions"),
        (np.zeros((1, 3, 8, 8)), TypeError, "float64"),
        (np.zeros((1, 8, 8, 3), np.float32).transpose(0, 3, 1, 2), ValueError, "gaps"),
        (np.zeros((1, 3, 8, 16), np.float32)[..., ::2], ValueError, "gaps"),
        (READ_ONLY, ValueError, "read-only"),
    ],
)
def test_an_array_that_the_input_does_not_fit_is_refused(out, error, words):
    with pytest.raises(error, match=words):
        rv.fill_input(noise(4, 4), None, params(width=8, height=8), out)


@pytest.mark.parametrize(
    "values, words",
    [
        ({"width": 0}, "width is 0"),
        ({"height": 4097}, "height is 4097"),
        ({"fit": "crop"}, "fit is crop"),
        ({"pad": 256}, "pad is 256"),
        ({"order": "gray"}, "order is gray"),
        ({"layout": "chw"}, "layout is chw"),
        ({"mean": (0, float("nan"), 0)}, "mean is nan"),
        ({"std": (1, 0, 1)}, "std is 0"),
        ({"std": (1, 1, float("inf"))}, "std is inf"),
    ],
)
def test_parameter_out_of_range_is_refused(values, words):
    with pytest.raises(ValueError, match=words):
        rv.validate(params(**values))
