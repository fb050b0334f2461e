"""Each operation against OpenCV's functions, with parameters from all over their ranges."""

import inspect
import pathlib
import re
from importlib.machinery import SourceFileLoader

import cv2
import numpy as np
import pytest

import robot_vision as rv
from robot_vision import filters

CASES = 25  # of each operation
SIZES = [(48, 64), (33, 47), (1, 1), (7, 2)]  # height, width
CHANNELS = {"mono8": 1, "mono16": 1, "bgr8": 3, "rgb8": 3, "bgra8": 4, "rgba8": 4}
SHAPES = {"rect": cv2.MORPH_RECT, "cross": cv2.MORPH_CROSS, "ellipse": cv2.MORPH_ELLIPSE}
SPACES = {
    "hsv": cv2.COLOR_BGR2HSV,
    "hls": cv2.COLOR_BGR2HLS,
    "lab": cv2.COLOR_BGR2Lab,
    "luv": cv2.COLOR_BGR2Luv,
    "ycrcb": cv2.COLOR_BGR2YCrCb,
    "xyz": cv2.COLOR_BGR2XYZ,
}
INTERPOLATIONS = {
    "nearest": cv2.INTER_NEAREST,
    "linear": cv2.INTER_LINEAR,
    "cubic": cv2.INTER_CUBIC,
    "area": cv2.INTER_AREA,
    "lanczos4": cv2.INTER_LANCZOS4,
}
KINDS = {
    "binary": cv2.THRESH_BINARY,
    "binary_inv": cv2.THRESH_BINARY_INV,
    "trunc": cv2.THRESH_TRUNC,
    "tozero": cv2.THRESH_TOZERO,
    "tozero_inv": cv2.THRESH_TOZERO_INV,
}
OUTSIDE = {int: -5, float: -1e6, str: "magic", bool: None}  # of all limits
WITHOUT_OPACITY = [
    "add",
    "bitwise",
    "black_hat",
    "difference",
    "gradient",
    "invert",
    "kernel",
    "laplacian",
    "laplacian_pyramid",
    "morphological_gradient",
    "normalize",
    "scharr",
    "sobel",
    "top_hat",
]
METHODS = {"fixed": 0, "otsu": cv2.THRESH_OTSU, "triangle": cv2.THRESH_TRIANGLE}


class Case:
    """What one operation is given."""

    def __init__(self, image, second, encoding, values):
        self.image = image
        self.second = second
        self.encoding = encoding
        self.values = values

    def __getattr__(self, name):
        return self.values[name]

    @property
    def square(self):
        return (self.size, self.size)

    @property
    def middle(self):
        height, width = self.image.shape[:2]
        return ((width - 1) / 2, (height - 1) / 2)

    @property
    def gray_level(self):
        return 257 if self.encoding == "mono16" else 1

    @property
    def width_height(self):
        return self.image.shape[1::-1]


def morphology(rule):
    def reference(c):
        element = cv2.getStructuringElement(SHAPES[c.shape], c.square)
        return cv2.morphologyEx(c.image, rule, element, iterations=c.iterations)

    return reference


def channel_of(color, encoding):
    return encoding.index(color[0])


def channels(c):
    kept = c.image.copy()
    for color in ("blue", "green", "red"):
        if not c.values[color]:
            kept[..., channel_of(color, c.encoding)] = 0
    return kept


def sobel(c):
    return cv2.convertScaleAbs(
        cv2.Sobel(c.image, cv2.CV_16S, c.dx, c.dy, ksize=c.size, scale=c.scale)
    )


def gradient(c):
    of_x, of_y = (
        cv2.convertScaleAbs(cv2.Sobel(c.image, cv2.CV_16S, dx, 1 - dx, ksize=c.size, scale=c.scale))
        for dx in (1, 0)
    )
    return cv2.addWeighted(of_x, 0.5, of_y, 0.5, 0)


def scharr(c):
    dx = int(c.direction == "x")
    return cv2.convertScaleAbs(cv2.Scharr(c.image, cv2.CV_16S, dx, 1 - dx, scale=c.scale))


def laplacian(c):
    return cv2.convertScaleAbs(cv2.Laplacian(c.image, cv2.CV_16S, ksize=c.size, scale=c.scale))


def color_range(c):
    image = c.image if c.space == "bgr" else cv2.cvtColor(c.image, SPACES[c.space])
    parts = [(c.low_1, c.high_1)]
    if c.low_1 > c.high_1:
        parts = [(c.low_1, 255), (0, c.high_1)]
    masks = [
        cv2.inRange(image, (low, c.low_2, c.low_3), (high, c.high_2, c.high_3))
        for low, high in parts
    ]
    return np.maximum(masks[0], masks[-1])


def perspective(c):
    width, height = c.width_height
    right, bottom = width - 1, height - 1
    points = np.float32([[c.x1, c.y1], [c.x2, c.y2], [c.x3, c.y3], [c.x4, c.y4]])
    points = (points.astype(np.float64) * (right, bottom)).astype(np.float32)
    corners = np.float32([[0, 0], [right, 0], [right, bottom], [0, bottom]])
    matrix = cv2.getPerspectiveTransform(points, corners)
    return cv2.warpPerspective(c.image, matrix, c.width_height)


def polar(c):
    flags = cv2.INTER_LINEAR + (cv2.WARP_POLAR_LOG if c.log else cv2.WARP_POLAR_LINEAR)
    flags += cv2.WARP_FILL_OUTLIERS + (cv2.WARP_INVERSE_MAP if c.inverse else 0)
    radius = max(1.0, float(np.hypot(*c.middle)))
    return cv2.warpPolar(c.image, c.width_height, c.middle, radius, flags)


def laplacian_pyramid(image, levels):
    pyramid = [image.astype(np.float32)]
    while len(pyramid) <= levels and min(pyramid[-1].shape[:2]) > 1:
        pyramid.append(cv2.pyrDown(pyramid[-1]))
    for level, (large, small) in enumerate(zip(pyramid, pyramid[1:])):
        pyramid[level] = large - cv2.pyrUp(small, dstsize=large.shape[1::-1])
    return pyramid


def to_bytes(image):
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def level_of(c):
    pyramid = laplacian_pyramid(c.image, c.level + 1)
    return to_bytes(pyramid[min(c.level, len(pyramid) - 1)] + 128)


def pyramid_blend(c):
    pyramid = laplacian_pyramid(c.image, c.levels)
    for mine, other in zip(pyramid, laplacian_pyramid(c.second, c.levels)):
        half = mine.shape[1] // 2
        mine[:, :half] = other[:, :half]
    image = pyramid[-1]
    for level in reversed(pyramid[:-1]):
        image = cv2.pyrUp(image, dstsize=level.shape[1::-1]) + level
    return to_bytes(image)


def repeated(function):
    def reference(c):
        image = c.image
        for _ in range(c.levels):
            image = function(image)
        return image

    return reference


def kernel_of(text):
    return np.array([[float(number) for number in row.split()] for row in text.split(";")])


def alpha(c):
    image = cv2.cvtColor(c.image, cv2.COLOR_BGR2BGRA) if c.image.shape[2] == 3 else c.image.copy()
    image[..., 3] = c.value
    return image


def resized(c):
    width, height = (max(1, round(length * c.scale)) for length in c.width_height)
    return cv2.resize(c.image, (width, height), interpolation=INTERPOLATIONS[c.interpolation])


def roi(c):
    height, width = c.image.shape[:2]
    right = c.x + c.width if c.width else width
    bottom = c.y + c.height if c.height else height
    return c.image[c.y : bottom, c.x : right]


REFERENCES = {
    "adaptive_threshold": lambda c: cv2.adaptiveThreshold(
        c.image,
        255,
        {"mean": cv2.ADAPTIVE_THRESH_MEAN_C, "gaussian": cv2.ADAPTIVE_THRESH_GAUSSIAN_C}[c.mean],
        cv2.THRESH_BINARY_INV if c.inverse else cv2.THRESH_BINARY,
        c.size,
        c.offset,
    ),
    "add": lambda c: cv2.add(c.image, (c.value * c.gray_level,) * 4),
    "affine": lambda c: cv2.warpAffine(
        c.image, np.float64([[1, c.shear_x, c.x], [c.shear_y, 1, c.y]]), c.width_height
    ),
    "alpha": alpha,
    "bilateral": lambda c: cv2.bilateralFilter(c.image, c.diameter, c.sigma_color, c.sigma_space),
    "bitwise": lambda c: {"and": cv2.bitwise_and, "or": cv2.bitwise_or, "xor": cv2.bitwise_xor}[
        c.rule
    ](c.image, c.second),
    "black_hat": morphology(cv2.MORPH_BLACKHAT),
    "blend": lambda c: cv2.addWeighted(c.image, c.weight, c.second, 1 - c.weight, 0),
    "box": lambda c: cv2.blur(c.image, c.square),
    "canny": lambda c: cv2.Canny(
        c.image, c.low, c.high, apertureSize=c.aperture, L2gradient=c.l2_gradient
    ),
    "channel": lambda c: c.image[..., channel_of(c.color, c.encoding)],
    "channels": channels,
    "clahe": lambda c: cv2.createCLAHE(c.limit, (c.tiles, c.tiles)).apply(c.image),
    "close": morphology(cv2.MORPH_CLOSE),
    "color_range": color_range,
    "color_space": lambda c: cv2.cvtColor(c.image, SPACES[c.space]),
    "difference": lambda c: cv2.absdiff(c.image, c.second),
    "dilate": morphology(cv2.MORPH_DILATE),
    "equalize": lambda c: cv2.equalizeHist(c.image),
    "erode": morphology(cv2.MORPH_ERODE),
    "flip": lambda c: cv2.flip(c.image, {"vertical": 1, "horizontal": 0, "both": -1}[c.axis]),
    "gaussian": lambda c: cv2.GaussianBlur(c.image, c.square, c.sigma),
    "gradient": gradient,
    "gray": lambda c: c.image,
    "hit_or_miss": lambda c: cv2.morphologyEx(
        c.image, cv2.MORPH_HITMISS, kernel_of(c.rows).astype(np.int32)
    ),
    "invert": lambda c: cv2.bitwise_not(c.image),
    "kernel": lambda c: cv2.filter2D(c.image, -1, kernel_of(c.rows), delta=c.offset * c.gray_level),
    "laplacian": laplacian,
    "laplacian_pyramid": level_of,
    "mask": lambda c: c.second * (c.image[..., None] > 0),
    "median": lambda c: cv2.medianBlur(c.image, c.size),
    "morphological_gradient": morphology(cv2.MORPH_GRADIENT),
    "nl_means": lambda c: cv2.fastNlMeansDenoising(
        c.image, None, c.strength, c.patch_size, c.search_size
    ),
    "normalize": lambda c: cv2.normalize(
        c.image, None, c.low * c.gray_level, c.high * c.gray_level, cv2.NORM_MINMAX
    ),
    "open": morphology(cv2.MORPH_OPEN),
    "perspective": perspective,
    "polar": polar,
    "pyramid_blend": pyramid_blend,
    "pyramid_down": repeated(cv2.pyrDown),
    "pyramid_up": repeated(cv2.pyrUp),
    "resize": resized,
    "roi": roi,
    "rotate": lambda c: cv2.warpAffine(
        c.image, cv2.getRotationMatrix2D(c.middle, c.angle, c.scale), c.width_height
    ),
    "scharr": scharr,
    "sharpen": lambda c: cv2.addWeighted(
        c.image, 1 + c.amount, cv2.GaussianBlur(c.image, (0, 0), c.sigma), -c.amount, 0
    ),
    "sobel": sobel,
    "threshold": lambda c: cv2.threshold(
        c.image, c.value, c.max, KINDS[c.kind] + METHODS[c.method]
    )[1],
    "top_hat": morphology(cv2.MORPH_TOPHAT),
}


# Parameters of which the first must not be above the second.
ORDERED = {
    "color_range": [("low_2", "high_2"), ("low_3", "high_3")],
    "normalize": [("low", "high")],
}


def random_value(random, param):
    """A value within a parameter's limits, which are those of the messages."""
    kind, limits = type(param.initial), param.limits
    if kind is bool:
        return bool(random.integers(2))
    if kind is str:
        words = ", ".join(limits.rsplit(" or ", 1)).split(", ")
        return str(random.choice(words)) if limits else param.initial
    low, high = (float(end) for end in limits.split("from ")[1].split(" to "))
    if kind is float:
        return float(random.uniform(low, high))
    # Small numbers more often than large ones, which make most operations the same.
    value = int(low + (high - low) * random.random() ** (3 if high < 1000 else 12))
    return value + (value % 2 == 0) if "odd" in limits else value


def random_image(random, shape, encoding):
    kind = np.uint16 if encoding == "mono16" else np.uint8
    pixels = random.integers(0, np.iinfo(kind).max, (*shape, CHANNELS[encoding]), kind, True)
    if random.random() < 0.5:  # smooth, as photographs are
        pixels = cv2.GaussianBlur(pixels, (0, 0), 3.0).reshape(pixels.shape)
    return np.ascontiguousarray(pixels[..., 0] if CHANNELS[encoding] == 1 else pixels)


def random_case(random, operation):
    encoding = str(random.choice(operation.encodings))
    second = encoding if operation.second == "input" else operation.second or encoding
    shape = SIZES[random.integers(len(SIZES))]
    images = [random_image(random, shape, layout) for layout in (encoding, second)]
    values = {param.name: random_value(random, param) for param in operation.params}
    for pair in ORDERED.get(operation.name, ()):
        values.update(zip(pair, sorted(values[name] for name in pair)))
    return Case(*images, encoding, values), second


# What an operation refuses though OpenCV does not, or before it would: with these words.
REFUSED = {
    "canny": (lambda c: c.low > c.high, "high is .*, must be at least low"),
    "clahe": (
        lambda c: c.encoding == "mono16" and c.tiles > 16,
        "tiles is .*, must be at most 16 for mono16$",
    ),
    "color_range": (
        lambda c: c.low_1 > c.high_1 and c.space not in ("hsv", "hls"),
        "high_1 is .*, must be at least low_1",
    ),
    "roi": (lambda c: c.x >= c.width_height[0] or c.y >= c.width_height[1], "must be inside of"),
    "sobel": (
        lambda c: c.dx + c.dy == 0 or (c.size == 1 and c.dx == c.dy == 2),
        "one must be 1 or 2|must be at least 3",
    ),
}


@pytest.mark.parametrize("operation", rv.operations(), ids=lambda operation: operation.name)
def test_equals_opencv(operation):
    random = np.random.default_rng(list(operation.name.encode()))
    refused, words = REFUSED.get(operation.name, (lambda c: False, ""))
    compared = 0
    for _ in range(CASES):
        case, second_encoding = random_case(random, operation)
        before = case.image.copy()
        arguments = case.values
        if operation.second:
            arguments = {"second": case.second, "second_encoding": second_encoding, **arguments}
        apply = getattr(filters, operation.name)
        if refused(case):
            with pytest.raises(ValueError, match=f"^{operation.name}: .*({words})"):
                apply(case.image, encoding=case.encoding, **arguments)
            continue
        result = apply(case.image, encoding=case.encoding, **arguments)
        expected = REFERENCES[operation.name](case)
        np.testing.assert_array_equal(result, expected, str(case.values))
        np.testing.assert_array_equal(case.image, before)
        compared += 1
    assert compared >= CASES / 5


def test_every_operation_has_a_reference():
    assert sorted(REFERENCES) == [operation.name for operation in rv.operations()]


@pytest.mark.parametrize("operation", rv.operations(), ids=lambda operation: operation.name)
def test_bad_values_are_refused_by_name(operation):
    for param in operation.params:
        name = f"{operation.name}_{param.name}"
        for value in (object(), [1], -1e300, float("nan")):
            with pytest.raises((ValueError, TypeError)):
                rv.FilterChain([operation.name], {name: value})
        if param.limits:
            with pytest.raises(
                ValueError, match=f"^{name} is .*, must be {re.escape(param.limits)}"
            ):
                rv.FilterChain(
                    [operation.name], {name: type(param.initial)(OUTSIDE[type(param.initial)])}
                )
        wrong = 1 if isinstance(param.initial, str) else "much"
        with pytest.raises(ValueError, match=f"^{name} must be "):
            rv.FilterChain([operation.name], {name: wrong})


@pytest.mark.parametrize("space", ["hsv", "hls"])
def test_a_range_of_hues_goes_through_red(space):
    red, pink, blue = (0, 0, 220), (60, 0, 220), (220, 0, 0)
    image = np.uint8([[red, pink, blue]])
    values = {"low_1": 160, "high_1": 10, "low_2": 50, "low_3": 50}
    np.testing.assert_array_equal(filters.color_range(image, space, **values), [[255, 255, 0]])


def test_chain_does_one_operation_after_the_other():
    image = random_image(np.random.default_rng(1), (48, 64), "bgr8")
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    expected = cv2.Canny(cv2.GaussianBlur(gray, (7, 7), 0), 50, 120)
    values = {"gaussian_size": 7, "canny_high": 120.0}
    result = filters.chain(image, ["gray", "gaussian", "canny"], **values)
    np.testing.assert_array_equal(result, expected)
    twice = filters.chain(image, ["erode", "erode"], erode_size=5)
    np.testing.assert_array_equal(twice, cv2.erode(image, np.ones((5, 5)), iterations=2))
    np.testing.assert_array_equal(filters.chain(image, []), image)


def test_a_chain_is_used_for_one_image_after_the_other():
    """Of any size and encoding, and without a trace of the one before."""
    random = np.random.default_rng(2)
    chain = rv.FilterChain(["gaussian", "canny"])
    for shape, encoding in (
        ((48, 64), "bgr8"),
        ((48, 64), "rgb8"),
        ((9, 30), "mono8"),
        ((48, 64), "mono16"),
    ):
        image = random_image(random, shape, encoding)
        before = image.copy()
        expected = rv.FilterChain(["gaussian", "canny"]).apply(image, encoding)
        np.testing.assert_array_equal(chain.apply(image, encoding), expected)
        np.testing.assert_array_equal(image, before)


def test_other_encodings_are_converted_once():
    image = random_image(np.random.default_rng(3), (48, 64), "mono8")
    bgr = cv2.cvtColor(image, cv2.COLOR_BayerBG2BGR)  # rggb
    np.testing.assert_array_equal(
        filters.gaussian(image, encoding="bayer_rggb8"), cv2.GaussianBlur(bgr, (5, 5), 0)
    )
    wide = random_image(np.random.default_rng(3), (48, 64), "mono16")
    np.testing.assert_array_equal(
        filters.median(wide, encoding="mono16"),
        cv2.medianBlur(cv2.convertScaleAbs(wide, alpha=255 / 65535), 5),
    )


@pytest.mark.parametrize(
    "names, values, text",
    [
        (["blur"], {}, "chain: 'blur' is no operation, must be one of adaptive_threshold, add, "),
        (["box"] * 33, {}, "chain has 33 operations, must have at most 32"),
        (["box"], {"box_width": 3}, "'box_width' is no operation's parameter"),
        (["box"], {"gaussian_size": 4}, "gaussian_size is 4, must be odd and from 1 to 255"),
        (
            ["normalize"],
            {"normalize_low": 200.0, "normalize_high": 50.0},
            "normalize: high is 50, ",
        ),
        (
            ["color_range"],
            {"color_range_low_2": 200, "color_range_high_2": 50},
            "color_range: high_2 ",
        ),
        (
            ["color_range"],
            {"color_range_low_3": 200, "color_range_high_3": 50},
            "color_range: high_3 ",
        ),
        (["kernel"], {"kernel_rows": "1 2; 3"}, "kernel: rows must have the same number"),
        (["kernel"], {"kernel_rows": "1 x"}, "kernel: 'x' in rows is no number"),
        (["kernel"], {"kernel_rows": ""}, "kernel: rows must be 1 to 31 rows"),
        (["kernel"], {"kernel_rows": "1e999"}, "kernel: "),
        (["hit_or_miss"], {"hit_or_miss_rows": "2"}, "hit_or_miss: rows must have the numbers"),
    ],
)
def test_chains_that_cannot_be_are_refused(names, values, text):
    with pytest.raises(ValueError, match="^" + re.escape(text)):
        rv.FilterChain(names, values)


def test_images_that_cannot_be_are_refused():
    image = np.zeros((480, 640, 3), np.uint8)
    with pytest.raises(ValueError, match=r"^blend: the other image is 640x479, must be 640x480"):
        filters.blend(image, second=image[1:])
    with pytest.raises(ValueError, match=r"^resize: the result would be 20480x20480, must have"):
        filters.resize(np.zeros((2560, 2560), np.uint8), 8.0, encoding="mono8")
    with pytest.raises(ValueError, match="mono8"):
        filters.box(image, encoding="mono8")


@pytest.mark.parametrize(
    "operation, values, text",
    [
        (
            "dilate",
            {"shape": "ellipse", "size": 99, "iterations": 20},
            "size, iterations are 99, 20",
        ),
        ("open", {"size": 99, "iterations": 20}, "size, iterations are 99, 20"),
        ("nl_means", {"search_size": 41}, "patch_size, search_size are 7, 41"),
        ("bilateral", {"diameter": 31}, "diameter is 31"),
    ],
)
def test_what_would_take_many_seconds_is_refused(operation, values, text):
    image = np.zeros((2160, 3840, 3), np.uint8)
    limit = r"must be less, or the image of 3840x2160 have at most \d+ pixels"
    apply = getattr(filters, operation)
    with pytest.raises(ValueError, match=f"^{operation}: {text}, {limit}$"):
        apply(image, **values)
    assert apply(image[:32, :48], **values).shape == (32, 48, 3)


@pytest.mark.parametrize("encoding", ["bgra8", "rgba8"])
def test_an_opacity_is_left_out_where_it_would_mean_nothing(encoding):
    """As the least and the largest value of a normalized image, or with its derivatives."""
    image = random_image(np.random.default_rng(3), (48, 64), encoding)
    image[..., :3] //= 4
    image[..., 3] = 255
    colors = cv2.cvtColor(image, cv2.COLOR_RGBA2BGR) if encoding == "rgba8" else image[..., :3]
    for name in WITHOUT_OPACITY:
        apply = getattr(filters, name)
        expected = apply(np.ascontiguousarray(colors))
        np.testing.assert_array_equal(apply(image, encoding=encoding), expected, name)
    assert filters.normalize(image, encoding=encoding).max() == 255


def test_gray_levels_are_those_of_white_with_16_bits_too():
    ramp = np.linspace(1000, 60000, 64).astype(np.uint16)[None]
    stretched = filters.normalize(ramp, encoding="mono16")
    assert (stretched.min(), stretched.max()) == (0, 65535)
    level = np.full((1, 9), 20 * 257, np.uint16)
    for result in (
        filters.add(level, 50.0, encoding="mono16"),
        filters.kernel(level, "1", 50.0, encoding="mono16"),
    ):
        assert (result == 70 * 257).all()


def test_files_that_follow_from_the_operations_are_up_to_date():
    root = pathlib.Path(__file__).resolve().parents[2]
    tool = SourceFileLoader("operations_tool", str(root / "tools/operations")).load_module()
    for path, text in tool.texts(rv.operations()).items():
        assert path.read_text() == text, f"{path}: run tools/operations"


def test_functions_say_what_they_take():
    assert (
        str(inspect.signature(filters.gaussian)) == "(image, size=5, sigma=0.0, *, encoding='bgr8')"
    )
    assert "second" in inspect.signature(filters.blend).parameters
    assert "side of the square (px; odd and from 1 to 255)" in filters.gaussian.__doc__
    assert "cv::GaussianBlur" in filters.gaussian.__doc__
