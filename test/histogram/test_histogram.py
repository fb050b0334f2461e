"""Histograms against NumPy's and OpenCV's, and the heights of the curves that are drawn of them."""

import cv2
import numpy as np
import pytest
import skimage.data

import robot_vision as rv

PHOTOGRAPH = cv2.resize(cv2.cvtColor(skimage.data.coffee(), cv2.COLOR_RGB2BGR), (151, 97))
NOISE = np.random.default_rng(1).integers(0, 256, (60, 80, 3), np.uint8)
SPACES = {  # conversion from BGR, names of the channels
    "bgr": (None, ["blue", "green", "red"]),
    "hsv": (cv2.COLOR_BGR2HSV, ["hue", "saturation", "value"]),
    "lab": (cv2.COLOR_BGR2Lab, ["lightness", "a", "b"]),
    "ycrcb": (cv2.COLOR_BGR2YCrCb, ["luma", "cr", "cb"]),
}
BLUE, GREEN = (200, 60, 20), (60, 180, 40)


def filled(params, values):
    for name, value in values.items():
        setattr(params, name, value)
    return params


def channels(**values):
    return filled(rv.HistogramParams(), values)


def colors(**values):
    return filled(rv.HueSaturationParams(), values)


def plots(**values):
    return filled(rv.HistogramPlotParams(), values)


@pytest.mark.parametrize("bins", [1, 2, 7, 64, 180, 256, 1000])
@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("image", [PHOTOGRAPH, NOISE], ids=["photograph", "noise"])
def test_each_channel_is_counted_as_numpy_and_opencv_do(image, space, bins):
    conversion, names = SPACES[space]
    pixels = image if conversion is None else cv2.cvtColor(image, conversion)
    found = rv.compute_histogram(image, "bgr8", channels(space=space, bins=bins))
    assert [channel.name for channel in found] == names
    for number, channel in enumerate(found):
        high = 180 if channel.name == "hue" else 256
        assert (channel.low, channel.high) == (0, high)
        expected = cv2.calcHist([pixels], [number], None, [bins], [0, high])[:, 0]
        assert np.array_equal(channel.counts, expected)
        if high % bins == 0:  # else limits of bins are between numbers, and are rounded
            counts, _ = np.histogram(pixels[:, :, number], bins, (0, high))
            assert np.array_equal(channel.counts, counts)
        assert channel.counts.sum() == image.shape[0] * image.shape[1]


@pytest.mark.parametrize("bins", [1, 64, 256, 1024])
def test_gray_has_all_of_its_bits(bins):
    wide = np.random.default_rng(2).integers(0, 65536, (50, 70), np.uint16)
    for image, encoding, high in (
        (wide, "mono16", 65536),
        (wide >> 6, "mono10", 1024),
        (NOISE[:, :, 0], "mono8", 256),
    ):
        (found,) = rv.compute_histogram(image, encoding, channels(space="gray", bins=bins))
        assert (found.name, found.low, found.high) == ("gray", 0, high)
        expected = cv2.calcHist([np.ascontiguousarray(image)], [0], None, [bins], [0, high])
        assert np.array_equal(found.counts, expected[:, 0])
        if bins <= high:
            assert np.array_equal(found.counts, np.histogram(image, bins, (0, high))[0])
    gray = cv2.cvtColor(PHOTOGRAPH, cv2.COLOR_BGR2GRAY)
    (found,) = rv.compute_histogram(PHOTOGRAPH, "bgr8", channels(space="gray", bins=256))
    assert np.array_equal(found.counts, np.bincount(gray.ravel(), minlength=256))


def test_other_encodings_are_those_of_bgr():
    expected = rv.compute_histogram(NOISE, "bgr8", channels(space="lab"))
    for image, encoding in (
        (NOISE[:, :, ::-1], "rgb8"),
        (np.dstack([NOISE, NOISE[:, :, 0]]), "bgra8"),
        (np.dstack([NOISE, NOISE])[:, :, :3], "bgr8"),
    ):
        before = image.copy()
        found = rv.compute_histogram(image, encoding, channels(space="lab"))
        assert len(found) == len(expected) == 3
        for one, other in zip(found, expected):
            assert np.array_equal(one.counts, other.counts)
        assert np.array_equal(image, before)


@pytest.mark.parametrize(
    "region, part",
    [
        ((10, 20, 30, 25), (10, 20, 30, 25)),
        ((0, 0, 0, 0), (0, 0, 80, 60)),
        ((10, 20, 0, 0), (10, 20, 70, 40)),
        ((0, 20, 5, 0), (0, 20, 5, 40)),
        ((79, 59, 1, 1), (79, 59, 1, 1)),
    ],
)
def test_a_region_and_a_mask_are_counted_alone(region, part):
    assert rv.part_of((80, 60), region) == part
    x, y, width, height = part
    inside = NOISE[y : y + height, x : x + width]
    found = rv.compute_histogram(NOISE, "bgr8", channels(), region)
    assert len(found) == 3
    for channel, values in zip(found, np.moveaxis(inside, 2, 0)):
        assert np.array_equal(channel.counts, np.histogram(values, 64, (0, 256))[0])
    mask = np.zeros(NOISE.shape[:2], np.uint8)
    mask[::3, ::2] = 7  # whatever is not 0
    there = mask[y : y + height, x : x + width] > 0
    found = rv.compute_histogram(NOISE, "bgr8", channels(), region, mask)
    assert len(found) == 3
    for channel, values in zip(found, np.moveaxis(inside, 2, 0)):
        assert np.array_equal(channel.counts, np.histogram(values[there], 64, (0, 256))[0])
    counts = rv.hue_saturation_histogram(NOISE, "bgr8", colors(), region)
    assert np.array_equal(counts, rv.hue_saturation_histogram(inside))


@pytest.mark.parametrize(
    "region, text",
    [
        ((70, 10, 20, 5), r"region of 20x5 px at \(70, 10\) is not inside the image of 80x60"),
        ((80, 0, 0, 0), r"region of 1x60 px at \(80, 0\) is not inside the image of 80x60"),
        ((-1, 0, 5, 5), r"region of 5x5 px at \(-1, 0\) is not inside"),
        ((0, 0, -5, 5), r"region of -5x5 px at \(0, 0\) is not inside"),
        ((2**31 - 1, 0, 2**31 - 1, 1), "is not inside"),
        ((-(2**31), 0, 0, 0), "is not inside"),
    ],
)
def test_a_region_outside_of_the_image_is_refused(region, text):
    with pytest.raises(ValueError, match=text):
        rv.part_of((80, 60), region)
    for count in (rv.compute_histogram, rv.hue_saturation_histogram):
        with pytest.raises(ValueError, match=text):
            count(NOISE, region=region)


def test_what_is_no_image_of_its_encoding_and_no_mask_of_it_is_refused():
    with pytest.raises(ValueError, match="mono8"):
        rv.compute_histogram(NOISE, "mono8", channels(space="gray"))
    with pytest.raises(ValueError, match="mono16"):
        rv.compute_histogram(NOISE, "mono16", channels(space="gray"))
    with pytest.raises(ValueError, match="the mask's size is 79x60, must be the image's, 80x60"):
        rv.compute_histogram(NOISE, mask=np.zeros((60, 79), np.uint8))
    with pytest.raises(ValueError, match="mono8"):
        rv.compute_histogram(NOISE, mask=NOISE)


@pytest.mark.parametrize(
    "params, text",
    [
        (channels(space="cmyk"), "space is cmyk, must be gray, bgr, hsv, lab or ycrcb"),
        (channels(bins=0), "bins is 0, must be from 1 to 1024"),
        (colors(hue_bins=181), "hue_bins is 181, must be from 1 to 180"),
        (colors(saturation_bins=0), "saturation_bins is 0, must be from 1 to 256"),
        (colors(min_value=-1), "min_value is -1, must be from 0 to 255"),
        (colors(disc=4), "disc is 4, must be odd and from 1 to 31"),
        (colors(comparison="eyes"), "comparison is eyes, must be correlation, chi_square, inter"),
        (plots(plot="below"), "plot is below, must be over or beside"),
        (plots(scale="root"), "scale is root, must be linear or log"),
    ],
)
def test_parameters_out_of_range_are_refused(params, text):
    with pytest.raises(ValueError, match=text):
        rv.validate(params)


def test_everything_in_one_bin():
    flat = np.full((20, 30, 3), 70, np.uint8)
    for channel in rv.compute_histogram(flat):
        assert channel.counts[70 // 4] == 600 and channel.counts.sum() == 600
    params = colors(hue_bins=1, saturation_bins=1, disc=1)
    counts = rv.hue_saturation_histogram(NOISE, "bgr8", params)
    assert counts.tolist() == [[4800.0]]
    assert (rv.back_project(NOISE, counts, "bgr8", params) == 255).all()
    for method, alike in (("correlation", 1.0), ("intersection", 1.0), ("chi_square", 0.0)):
        assert rv.compare_histograms(counts, 2.0 * counts, method) == alike


@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (50, 1), (33, 41)])
@pytest.mark.parametrize("level", [0, 255])
def test_images_of_any_size(shape, level):
    image = np.full((*shape, 3), level, np.uint8)
    for space in SPACES:
        found = rv.compute_histogram(image, "bgr8", channels(space=space))
        assert all(channel.counts.sum() == image.size // 3 for channel in found)
        for plot in ("over", "beside"):
            drawn = rv.plot_histogram(image, found, plots(plot=plot, scale="log"))
            assert drawn.shape == (shape[0], shape[1] * (1 + (plot == "beside")), 3)
    counts = rv.hue_saturation_histogram(image)
    assert rv.back_project(image, counts).shape == shape
    assert rv.draw_hue_saturation(counts).any()


def limits(params):
    hsv = cv2.cvtColor(PHOTOGRAPH, cv2.COLOR_BGR2HSV)
    return hsv, cv2.inRange(hsv, (0, params.min_saturation, params.min_value), (255, 255, 255))


TWO_DIMENSIONAL = [
    colors(),
    colors(hue_bins=16, saturation_bins=1),
    colors(hue_bins=180, saturation_bins=256, min_saturation=40, min_value=50),
]


@pytest.mark.parametrize("params", TWO_DIMENSIONAL)
def test_hue_and_saturation_are_counted_as_opencv_does(params):
    hsv, mask = limits(params)
    bins = [params.hue_bins, params.saturation_bins]
    expected = cv2.calcHist([hsv], [0, 1], mask, bins, [0, 180, 0, 256])
    found = rv.hue_saturation_histogram(PHOTOGRAPH, "bgr8", params)
    assert found.dtype == np.float32 and np.array_equal(found, expected)
    counts, _, _ = np.histogram2d(
        hsv[mask > 0][:, 0], hsv[mask > 0][:, 1], bins, [(0, 180), (0, 256)]
    )
    assert np.array_equal(found, counts)


@pytest.mark.parametrize("disc", [1, 5, 31])
@pytest.mark.parametrize("params", TWO_DIMENSIONAL)
def test_the_back_projection_is_opencv_s(params, disc):
    params.disc = disc
    hsv, mask = limits(params)
    histogram = rv.hue_saturation_histogram(PHOTOGRAPH, "bgr8", params, (20, 10, 40, 30))
    relative = histogram * (255.0 / histogram.max())
    expected = cv2.calcBackProject([hsv], [0, 1], relative, [0, 180, 0, 256], 1) & mask
    if disc > 1:
        kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (disc, disc))
        expected = cv2.filter2D(expected, -1, kernel)
    found = rv.back_project(PHOTOGRAPH, histogram, "bgr8", params)
    # A value next to a half may be rounded otherwise, and the disc adds up to 700 of them.
    assert np.abs(found.astype(int) - expected).max() <= (1 if disc == 1 else 3)
    assert np.abs(found.astype(int) - expected).mean() < 0.02


def test_a_histogram_of_other_bins_is_refused():
    counts = rv.hue_saturation_histogram(PHOTOGRAPH)
    with pytest.raises(ValueError, match=r"the histogram is 30x32 bins .* must be 16x32 bins"):
        rv.back_project(PHOTOGRAPH, counts, "bgr8", colors(hue_bins=16))
    with pytest.raises(ValueError, match="expected a histogram of 2 dimensions"):
        rv.back_project(PHOTOGRAPH, counts[0])
    with pytest.raises(ValueError, match="the first histogram is 0x0 bins, must be at least 1x1"):
        rv.compare_histograms(counts[:0, :0], counts[:0, :0])


METHODS = {
    "correlation": (cv2.HISTCMP_CORREL, 1.0),
    "chi_square": (cv2.HISTCMP_CHISQR, 0.0),
    "intersection": (cv2.HISTCMP_INTERSECT, 1.0),
    "bhattacharyya": (cv2.HISTCMP_BHATTACHARYYA, 0.0),
}


@pytest.mark.parametrize("method", METHODS)
def test_histograms_are_compared_as_opencv_does(method):
    number, alike = METHODS[method]
    a = rv.hue_saturation_histogram(PHOTOGRAPH)
    b = rv.hue_saturation_histogram(PHOTOGRAPH, region=(30, 20, 60, 40))
    expected = cv2.compareHist(a / a.sum(), b / b.sum(), number)
    assert rv.compare_histograms(a, b, method) == pytest.approx(expected, rel=1e-4)
    assert rv.compare_histograms(a, 3.0 * a, method) == pytest.approx(alike, abs=5e-3)
    nothing = {"correlation": 0.0, "chi_square": 1.0, "intersection": 0.0, "bhattacharyya": 1.0}
    empty = np.zeros_like(a)
    for pair in ((a, empty), (empty, a), (empty, empty)):
        assert rv.compare_histograms(*pair, method) == nothing[method]


def test_a_flat_histogram_has_no_correlation_but_with_another():
    flat, other = np.ones((1, 2)), np.float32([[10, 0]])
    for pair, expected in (((flat, other), 0), ((other, flat), 0), ((flat, 3 * flat), 1)):
        assert rv.compare_histograms(*pair, "correlation") == expected


def test_histograms_that_cannot_be_compared_are_refused():
    a, b = np.ones((3, 4)), np.ones((4, 3))
    with pytest.raises(ValueError, match="method is eyes, must be correlation, chi_square"):
        rv.compare_histograms(a, a, "eyes")
    with pytest.raises(ValueError, match=r"the second histogram is 4x3 bins .* as the first, of 3"):
        rv.compare_histograms(a, b)


def curve(drawn, area):
    """The height above the axis of a white curve at each column of a part of an image, px.

    The axis is the row where a bin is that has no pixels.
    """
    left, top, right, bottom = area
    white = (drawn[top:bottom, left:right].min(axis=2) >= 225).argmax(axis=0)
    return white.max() - white


LEVELS = (20, 100, 180)  # gray levels of 1/2, 1/3 and 1/6 of the image
STRIPES = np.repeat(np.uint8([20, 20, 20, 100, 100, 180]), 60 * 480).reshape(360, 480)


@pytest.mark.parametrize("plot", ["over", "beside"])
@pytest.mark.parametrize("scale", ["linear", "log"])
def test_the_curve_is_as_high_as_the_counts_are(plot, scale):
    counted = rv.compute_histogram(STRIPES, "mono8", channels(space="gray", bins=16))
    bgr = cv2.cvtColor(STRIPES, cv2.COLOR_GRAY2BGR)
    drawn = rv.plot_histogram(bgr, counted, plots(plot=plot, scale=scale))
    width, top = (480, 180) if plot == "over" else (960, 0)
    assert drawn.shape == (360, width, 3)
    assert np.array_equal(drawn[:180, :480], bgr[:180])
    inside = 48, 24, 480 - 16, 360 - top - 22  # without the room for the labels
    part = drawn[top:, width - 480 :]
    # The names of the channel and the labels are outside of the curves' own part.
    heights = curve(part, inside)
    assert heights.size == 416
    full = inside[3] - inside[1] - 1
    counts = {level: np.count_nonzero(level == STRIPES) for level in LEVELS}
    for level, count in counts.items():
        middle = (level // 16 + 0.5) * 16 / 256  # of its bin, as a share of the axis
        at = heights[int(middle * 415)]
        share = np.log1p(count) / np.log1p(86400) if scale == "log" else count / 86400
        assert at == pytest.approx(share * full, abs=2.5), level
    assert np.median(heights) == 0  # most bins are empty


def test_a_plot_over_the_image_leaves_it_to_be_seen():
    counted = rv.compute_histogram(PHOTOGRAPH)
    large = cv2.resize(PHOTOGRAPH, (640, 480))
    before = large.copy()
    drawn = rv.plot_histogram(large, counted)
    assert np.array_equal(large, before) and np.array_equal(drawn[:240], large[:240])
    shade = drawn[240:].astype(int) - large[240:] * 0.3
    assert (np.abs(shade) <= 1).mean() > 0.6
    for color in ((255, 120, 60), (80, 230, 80), (80, 80, 255)):
        assert ((drawn[240:] == color).all(axis=2)).sum() > 300
    beside = rv.plot_histogram(large, counted, plots(plot="beside"))
    assert np.array_equal(beside[:, :640], large)
    assert (beside[:, 640:] == 0).mean() > 0.9


def test_the_curve_of_the_hue_ends_where_hues_end():
    pixels = cv2.cvtColor(np.uint8([[[179, 255, 255]]]), cv2.COLOR_HSV2BGR)
    image = np.full((400, 600, 3), pixels[0, 0], np.uint8)
    counted = rv.compute_histogram(image, "bgr8", channels(space="hsv", bins=10))
    drawn = rv.plot_histogram(np.zeros_like(image), counted)
    columns = np.flatnonzero((drawn == (0, 220, 255)).all(axis=2)[224:370].any(axis=0))
    axis = 600 - 48 - 16 - 1
    assert columns.max() == pytest.approx(48 + 180 / 256 * axis, abs=2)


@pytest.mark.parametrize("scale", ["linear", "log"])
def test_each_hue_and_saturation_has_its_place_and_color(scale):
    counts = np.zeros((30, 32), np.float32)
    counts[20, 28] = 100.0  # hues 120 to 125, saturations 224 to 231
    counts[5, 10] = 50.0  # hues 30 to 35, saturations 80 to 87
    drawn = rv.draw_hue_saturation(counts, plots(scale=scale))
    assert drawn.shape == (256, 360, 3)
    there = np.zeros((256, 360), bool)
    there[24:32, 240:252] = True
    half = np.zeros_like(there)
    half[168:176, 60:72] = True
    assert not drawn[~(there | half)].any()
    share = np.log1p(50) / np.log1p(100) if scale == "log" else 0.5
    for place, hsv in ((there, (123, 228, 255)), (half, (33, 84, round(255 * share)))):
        color = cv2.cvtColor(np.uint8([[hsv]]), cv2.COLOR_HSV2BGR)[0, 0]
        assert np.abs(drawn[place].astype(int) - color).max() <= 2


def test_what_is_no_histogram_of_hues_is_refused():
    with pytest.raises(ValueError, match="expected a histogram of 2 dimensions"):
        rv.draw_hue_saturation(np.zeros(5))
    with pytest.raises(ValueError, match="bgr8"):
        rv.plot_histogram(np.zeros((5, 5), np.uint8), [])


def test_the_selection_s_colors_are_found():
    image = np.full((100, 100, 3), GREEN, np.uint8)
    image[40:70, 20:60] = BLUE
    counts = rv.hue_saturation_histogram(image, region=(25, 45, 10, 10))
    found = rv.back_project(image, counts, "bgr8", colors(disc=1))
    expected = np.zeros((100, 100), np.uint8)
    expected[40:70, 20:60] = 255
    assert np.array_equal(found, expected)
