"""JPEGs and PNGs of images of every encoding, to look at."""

import cv2
import numpy as np
import pytest

from robot_vision import WHITE_DEPTH, DisplayEncoder, DisplayParams, compressed_info

BGR = np.uint8([40, 160, 220])  # of a pixel
JPEG_ERROR = 6  # levels, of a smooth image at quality 95


def view(image, encoding, **params):
    """What the encoder shows of an image, decoded; BGR."""
    wanted = DisplayParams()
    wanted.quality = 95
    for name, value in params.items():
        setattr(wanted, name, value)
    data = DisplayEncoder().encode(image, encoding, wanted)
    decoded = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    assert decoded is not None
    return decoded


def smooth(height=48, width=64):
    """A BGR image in which each channel rises along another direction."""
    y, x = np.mgrid[:height, :width].astype(np.float32)
    planes = [40 + 150 * x / width, 200 - 120 * y / height, 60 + 90 * (x + y) / (width + height)]
    return np.dstack(planes).astype(np.uint8)


def differs(found, expected):
    assert found.shape == expected.shape
    return np.abs(found.astype(int) - expected.astype(int)).mean()


def uyvy(bgr, luma_first):
    ycrcb = cv2.cvtColor(bgr, cv2.COLOR_BGR2YCrCb).astype(np.float32)
    luma = 16 + ycrcb[..., 0] * 219 / 255
    chroma = [16 + (ycrcb[:, ::2, at]) * 224 / 255 for at in (2, 1)]
    packed = np.zeros((*bgr.shape[:2], 2), np.uint8)
    packed[..., 0 if luma_first else 1] = luma
    other = packed[..., 1 if luma_first else 0]
    other[:, ::2], other[:, 1::2] = chroma
    return packed


COLORS = {
    "bgr8": lambda bgr: bgr,
    "8UC3": lambda bgr: bgr,
    "rgb8": lambda bgr: bgr[..., ::-1],
    "bgra8": lambda bgr: np.dstack([bgr, np.zeros(bgr.shape[:2], np.uint8)]),
    "8UC4": lambda bgr: np.dstack([bgr, np.zeros(bgr.shape[:2], np.uint8)]),
    "rgba8": lambda bgr: np.dstack([bgr[..., ::-1], np.zeros(bgr.shape[:2], np.uint8)]),
    "bgr16": lambda bgr: bgr.astype(np.uint16) * 257,
    "rgb16": lambda bgr: bgr[..., ::-1].astype(np.uint16) * 257,
    "yuv422": lambda bgr: uyvy(bgr, False),
    "yuv422_yuy2": lambda bgr: uyvy(bgr, True),
}


@pytest.mark.parametrize("encoding", COLORS)
def test_colors_are_those_of_the_image(encoding):
    bgr = smooth()
    assert differs(view(COLORS[encoding](bgr), encoding), bgr) < JPEG_ERROR


@pytest.mark.parametrize("encoding", COLORS)
def test_png_has_the_same_colors_and_loses_nothing(encoding):
    bgr = smooth()
    limit = 3 if encoding.startswith("yuv") else 0
    assert differs(view(COLORS[encoding](bgr), encoding, format="png"), bgr) <= limit


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("order", ["rggb", "bggr", "gbrg", "grbg"])
def test_a_mosaic_has_the_color_of_what_it_shows(order, bits):
    mosaic = np.zeros((32, 40), np.uint8)
    for at, name in enumerate(order):
        mosaic[at // 2 :: 2, at % 2 :: 2] = BGR["bgr".index(name)]
    if bits == 16:
        mosaic = mosaic.astype(np.uint16) * 257
    shown = view(mosaic, f"bayer_{order}{bits}")
    assert differs(shown[4:-4, 4:-4], np.broadcast_to(BGR, (24, 32, 3))) < JPEG_ERROR


@pytest.mark.parametrize("encoding", ["mono8", "8UC1", "mono16"])
def test_gray_is_one_channel(encoding):
    gray = smooth()[..., 0]
    image = gray.astype(np.uint16) * 257 if encoding == "mono16" else gray
    assert differs(view(image, encoding), gray) < 2


@pytest.mark.parametrize("dtype", [np.uint16, np.float32, np.float64])
def test_depths_are_gray_by_the_root_of_the_distance(dtype):
    metres = np.float64([[0.0, 0.1, 1.0, 2.5, 9.0, WHITE_DEPTH, 12.0, 60.0]] * 16)
    encoding = {np.uint16: "16UC1", np.float32: "32FC1", np.float64: "64FC1"}[dtype]
    image = (metres * (1000 if dtype is np.uint16 else 1)).astype(dtype)
    expected = np.round(255 * np.sqrt(np.minimum(metres, WHITE_DEPTH) / WHITE_DEPTH))
    assert np.abs(view(image, encoding, format="png").astype(int) - expected).max() <= 1


def test_what_is_no_depth_is_black_and_infinitely_far_is_white():
    image = np.float32([[np.nan, -1.0, -np.inf, 0.0, np.inf, 1e38]])
    assert view(image, "32FC1", format="png").tolist() == [[0, 0, 0, 0, 255, 255]]


@pytest.mark.parametrize(
    "encoding, dtype",
    [("mono16", np.uint16), ("8SC1", np.int8), ("16SC1", np.int16), ("32SC1", np.int32)],
)
def test_labels_have_colors_that_differ(encoding, dtype):
    labels = np.repeat(np.arange(12, dtype=dtype)[np.newaxis], 4, 0)
    shown = view(labels, encoding, format="png")
    colors = {tuple(color) for color in shown[0]}
    assert len(colors) == 12 and tuple(shown[0, 0]) == (0, 0, 0)


def test_labels_beyond_the_colors_and_below_zero_can_be_seen():
    labels = np.int32([[0, 255, 256, 2**31 - 1, -1, -(2**31)]])
    shown = view(labels, "32SC1", format="png")[0]
    assert all(color.any() for color in shown[1:4])
    assert shown[4].tolist() == shown[5].tolist() == [128] * 3
    assert shown[2].tolist() == view(np.int32([[1]]), "32SC1", format="png")[0, 0].tolist()


def test_gray_of_16_bits_that_is_not_all_black_is_no_label():
    image = np.full((8, 8), 200, np.uint16)
    image[0, 0] = 256
    assert view(image, "mono16").ndim == 2


@pytest.mark.parametrize("size", [(32, 24), (20, 15), (64, 12), (1, 1), (200, 100)])
def test_an_image_is_resized_as_by_areas(size):
    bgr = smooth()
    smaller = size[0] <= 64 and size[1] <= 48
    method = cv2.INTER_AREA if smaller else cv2.INTER_LINEAR
    expected = cv2.resize(bgr, size, interpolation=method)
    shown = view(bgr, "bgr8", width=size[0], height=size[1])
    assert differs(shown, expected) < JPEG_ERROR
    lossless = view(bgr, "bgr8", width=size[0], height=size[1], format="png")
    assert differs(lossless, expected) == 0


def test_an_image_is_turned_by_half_a_turn():
    bgr = smooth()
    assert differs(view(bgr, "bgr8", turned=True, format="png"), bgr[::-1, ::-1]) == 0


def test_quality_tells_how_large_a_jpeg_is():
    noise = np.random.default_rng(1).integers(0, 256, (100, 100, 3), np.uint8)
    sizes = []
    for quality in (1, 50, 100):
        params = DisplayParams()
        params.quality = quality
        sizes.append(len(DisplayEncoder().encode(noise, "bgr8", params)))
    assert sizes[0] < sizes[1] / 2 < sizes[2] / 4


def test_rows_may_be_padded_and_the_image_stays_as_it_is():
    wide = np.zeros((48, 100, 3), np.uint8)
    wide[:, :64] = smooth()
    padded = wide[:, :64]
    before = wide.copy()
    assert differs(view(padded, "bgr8", format="png"), smooth()) == 0
    view(padded, "bgr8", width=32, height=24, turned=True)
    assert np.array_equal(wide, before)


def test_one_encoder_makes_views_of_any_images_in_turn():
    encoder, params = DisplayEncoder(), DisplayParams()
    params.format = "png"
    bgr = smooth()
    first = bgr.copy()
    for _ in range(2):
        for image, encoding in [
            (bgr, "bgr8"),
            (np.full((48, 64), 2500, np.uint16), "16UC1"),
            (COLORS["yuv422"](bgr), "yuv422"),
            (np.ones((48, 64), np.int32), "32SC1"),
        ]:
            shown = encoder.encode(image, encoding, params)
            assert shown == DisplayEncoder().encode(image, encoding, params)
    assert np.array_equal(bgr, first)


@pytest.mark.parametrize("shape", [(1, 1), (1, 640), (480, 1), (2160, 3840)])
def test_images_of_any_size_are_shown(shape):
    image = np.full((*shape, 3), BGR, np.uint8)
    assert differs(view(image, "bgr8"), image) < JPEG_ERROR


@pytest.mark.parametrize(
    "image, encoding, words",
    [
        (np.zeros((4, 4, 3), np.uint8), "mono8", "expected pixels of 1 x 8 bits"),
        (np.zeros((4, 4), np.uint8), "bgr8", "expected pixels of 3 x 8 bits"),
        (np.zeros((4, 4, 2), np.float32), "32FC2", "encoding '32FC2' cannot be shown, must be one"),
        (np.zeros((4, 4), np.uint8), "\n\x1b[31m", r"'\\x0a\\x1b\[31m' cannot be shown"),
        (np.zeros((4, 4), np.uint8), "jpeg", "cannot be shown"),
        (np.zeros((0, 4, 3), np.uint8), "bgr8", "is empty"),
        (np.zeros((4, 3, 2), np.uint8), "yuv422", "columns to be a multiple of 2"),
        (np.zeros(4, np.uint8), "mono8", "2 or 3 dimensions"),
        (np.zeros((4, 4, 0), np.uint8), "bgr8", "0 channels"),
    ],
)
def test_what_cannot_be_shown_is_refused_in_words(image, encoding, words):
    with pytest.raises(ValueError, match=words):
        DisplayEncoder().encode(image, encoding, DisplayParams())


@pytest.mark.parametrize(
    "name, value, words",
    [
        ("quality", 0, "quality is 0, must be from 1 to 100"),
        ("quality", 101, "quality is 101"),
        ("width", -1, "width is -1"),
        ("height", 16385, "height is 16385"),
        ("format", "gif", "format is 'gif', must be jpeg or png"),
    ],
)
def test_parameters_out_of_range_are_refused(name, value, words):
    params = DisplayParams()
    setattr(params, name, value)
    with pytest.raises(ValueError, match=words):
        DisplayEncoder().encode(smooth(), "bgr8", params)


def test_more_pixels_than_can_be_decoded_are_refused():
    params = DisplayParams()
    params.width = params.height = 16384
    with pytest.raises(ValueError, match="16384x16384, the most is"):
        DisplayEncoder().encode(smooth(), "bgr8", params)


def encoded(ending, height=30, width=40):
    return cv2.imencode(ending, smooth(height, width))[1].tobytes()


@pytest.mark.parametrize("ending, name", [(".jpg", "jpeg"), (".png", "png")])
def test_a_stream_tells_its_format_and_size(ending, name):
    assert compressed_info(encoded(ending)) == (name, 40, 30)


@pytest.mark.parametrize(
    "data, words",
    [
        (b"", "0 bytes are neither JPEG nor PNG"),
        (b"GIF89a" * 10, "neither"),
        (encoded(".jpg")[:-40], "damaged or truncated"),
        (encoded(".png")[:-40], "damaged or truncated"),
        (b"\xff\xd8\xff\xe0", "damaged or truncated"),
        (encoded(".png")[:16] + bytes(4) + encoded(".png")[20:], "has no pixels"),
        (encoded(".png")[:16] + b"\xff" * 8 + encoded(".png")[24:], "claims to be of"),
    ],
)
def test_a_stream_that_cannot_be_passed_on_is_refused_in_words(data, words):
    with pytest.raises(ValueError, match=words):
        compressed_info(data)
