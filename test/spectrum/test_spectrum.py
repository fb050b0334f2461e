"""Spectra and filtered frequencies, against NumPy's transform and the filters' formulas."""

import cv2
import numpy as np
import pytest

import robot_vision as rv

SHAPES = [(48, 64), (33, 47), (1, 64), (64, 1), (1, 1), (2, 2), (31, 2)]
GREEN = (0, 255, 0)


def params(**values):
    made = rv.SpectrumParams()
    for name, value in values.items():
        setattr(made, name, value)
    return made


def noise(shape):
    return np.random.default_rng(4).integers(0, 256, shape, np.uint8)


def wave(periods_x, periods_y, amplitude=100.0, height=96, width=128):
    """A sinusoid of this many periods in each direction, without 8-bit steps."""
    y, x = np.mgrid[:height, :width]
    phase = 2 * np.pi * (periods_x * x / width + periods_y * y / height)
    return amplitude * np.cos(phase)


def image_of(values):
    return np.rint(128 + values).astype(np.uint8)


def hann(length):
    return np.hanning(length) if length > 2 else np.ones(length)


@pytest.mark.parametrize("window", ["hann", "none"])
@pytest.mark.parametrize("optimal_size", [False, True])
@pytest.mark.parametrize("shape", SHAPES)
def test_magnitude_equals_numpy(shape, optimal_size, window):
    image = noise(shape)
    before = image.copy()
    magnitude = rv.spectrum_magnitude(
        image, "mono8", params(window=window, optimal_size=optimal_size)
    )
    faded = image * np.outer(*map(hann, shape)) if window == "hann" else image
    size = tuple(map(cv2.getOptimalDFTSize, shape)) if optimal_size else shape
    expected = np.abs(np.fft.fftshift(np.fft.fft2(faded, size)))
    assert (magnitude.dtype, magnitude.shape) == (np.float32, size)
    assert np.abs(np.expm1(magnitude) - expected).max() <= 1e-5 * (1 + expected.max())
    assert np.array_equal(image, before)


def test_the_fast_size_is_larger_than_33x47():
    assert rv.spectrum_magnitude(noise((33, 47)), "mono8").shape == (36, 48)


@pytest.mark.parametrize("x, y", [(5, 0), (0, 7), (9, 4), (-12, 20)])
def test_a_wave_is_two_points_at_its_frequency(x, y):
    image = image_of(wave(x, y))
    magnitude = rv.spectrum_magnitude(image, "mono8", params(window="none"))
    rows, columns = magnitude.shape
    middle = np.array([rows // 2, columns // 2])
    brightest = np.argsort(magnitude, axis=None)[-3:]
    places = {tuple(np.unravel_index(i, magnitude.shape) - middle) for i in brightest}
    assert places == {(0, 0), (y, x), (-y, -x)}
    expected = np.log1p(100.0 * rows * columns / 2)  # of the amplitude half goes to each
    assert magnitude[middle[0] + y, middle[1] + x] == pytest.approx(expected, rel=1e-3)


def test_the_window_removes_the_cross_of_the_borders():
    ramp = np.tile(np.arange(128, dtype=np.uint8), (96, 1))
    far = [
        rv.spectrum_magnitude(ramp, "mono8", params(window=window))[48, 100:].max()
        for window in ("none", "hann")
    ]
    assert far[1] < far[0] - 4.0  # e^4


def test_spectrum_image_is_of_full_range():
    shown = rv.spectrum_image(rv.spectrum_magnitude(noise((48, 64)), "mono8"))
    assert (shown.dtype, shown.max()) == (np.uint8, 255)
    assert rv.spectrum_image(np.float32([[0, 1], [2, 4]])).tolist() == [[0, 64], [128, 255]]
    assert not rv.spectrum_image(np.zeros((3, 4), np.float32)).any()


def formula(r, values):
    """The factor of a frequency, as share of Nyquist's, as textbooks have it."""
    radius, width, order = values.radius, values.width, values.order
    if values.filter == "band_pass":
        if values.shape == "ideal":
            return float(radius - width / 2 <= r <= radius + width / 2)
        if values.shape == "gaussian":
            return np.exp(-(((r * r - radius * radius) / (r * width)) ** 2))
        return 1 - 1 / (1 + (r * width / (r * r - radius * radius)) ** (2 * order))
    low = {
        "ideal": float(r <= radius),
        "gaussian": np.exp(-(r * r) / (2 * radius * radius)),
        "butterworth": 1 / (1 + (r / radius) ** (2 * order)),
    }[values.shape]
    return low if values.filter == "low_pass" else 1 - low


@pytest.mark.parametrize("shape", ["ideal", "gaussian", "butterworth"])
@pytest.mark.parametrize("name", ["low_pass", "high_pass", "band_pass"])
def test_waves_pass_as_the_formulas_say(name, shape):
    slow, fast = (4, 3), (40, -24)
    image = image_of(wave(*slow, 60.0) + wave(*fast, 50.0))
    for radius, width, order in ((0.25, 0.2, 2), (0.25, 0.2, 5), (0.5, 0.4, 2), (0.8, 0.1, 2)):
        values = params(filter=name, shape=shape, radius=radius, width=width, order=order)
        filtered = rv.filter_frequencies(image, "mono8", values)
        for periods, amplitude in ((slow, 60.0), (fast, 50.0)):
            basis = wave(*periods, 1.0)
            found = (filtered * basis).sum() / (basis * basis).sum()
            r = np.hypot(2 * periods[0] / 128, 2 * periods[1] / 96)
            assert found == pytest.approx(amplitude * formula(r, values), abs=0.1), (radius, r)
        mean = image.mean() if name == "low_pass" else 0.0
        assert filtered.mean() == pytest.approx(mean, abs=1e-3)


@pytest.mark.parametrize("optimal_size", [False, True])
@pytest.mark.parametrize("shape", ["ideal", "gaussian", "butterworth"])
def test_low_and_high_frequencies_are_the_image(shape, optimal_size):
    for size in SHAPES:
        image = noise(size)
        low, high = (
            rv.filter_frequencies(
                image,
                "mono8",
                params(filter=name, shape=shape, radius=0.4, optimal_size=optimal_size),
            )
            for name in ("low_pass", "high_pass")
        )
        assert (low.dtype, low.shape) == (np.float32, size)
        assert np.abs(low + high - image).max() < 1e-3


@pytest.mark.parametrize("name", ["low_pass", "high_pass", "band_pass"])
def test_filtering_is_multiplication_by_the_mask(name):
    values = params(filter=name, radius=0.3, shape="butterworth", optimal_size=False)
    for size in SHAPES:
        image = noise(size)
        mask = rv.frequency_mask(size, values)
        assert (mask.dtype, mask.shape) == (np.float32, size)
        expected = np.fft.ifft2(np.fft.fft2(image) * np.fft.ifftshift(mask)).real
        filtered = rv.filter_frequencies(image, "mono8", values)
        assert np.abs(filtered - expected).max() < 1e-3


@pytest.mark.parametrize("name", ["high_pass", "band_pass"])
def test_the_mean_is_that_of_the_image_filled_up(name):
    image = np.zeros((257, 257), np.uint8)
    image[:, -1] = 255
    own = rv.filter_frequencies(image, "mono8", params(filter=name, optimal_size=False))
    assert own.mean() == pytest.approx(0.0, abs=1e-3)
    values = params(filter=name)
    full = np.pad(image, (0, 13), mode="edge")  # 270 = 2 * 3^3 * 5
    mask = np.fft.ifftshift(rv.frequency_mask(full.shape, values))
    expected = np.fft.ifft2(np.fft.fft2(full) * mask).real
    assert expected.mean() == pytest.approx(0.0, abs=1e-3)
    filtered = rv.filter_frequencies(image, "mono8", values)
    assert np.abs(filtered - expected[:257, :257]).max() < 1e-3


def test_the_mask_is_centred_and_round_in_frequency():
    mask = rv.frequency_mask((60, 80), params(filter="low_pass", shape="ideal", radius=0.5))
    assert mask[30, 40] == 1.0
    row, column = np.flatnonzero(mask[30]), np.flatnonzero(mask[:, 40])
    assert (row[0], row[-1]) == (20, 60) and (column[0], column[-1]) == (15, 45)
    assert (rv.frequency_mask((5, 7), params()) == 1.0).all()


def test_without_a_filter_the_image_stays():
    image = noise((30, 40, 3))
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    assert np.array_equal(rv.filter_frequencies(image), gray)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_encodings_and_padded_rows(kind):
    image = noise((40, 60)).astype(kind) * (1 if kind is np.uint8 else 257)
    encoding = "mono8" if kind is np.uint8 else "mono16"
    plain = noise((40, 60))
    view = np.hstack([image, image])[:, :60]
    values = params(filter="low_pass")
    for function in (rv.spectrum_magnitude, rv.filter_frequencies):
        assert np.array_equal(function(view, encoding, values), function(plain, "mono8", values)), (
            function
        )


def test_the_borders_of_the_filter_are_drawn():
    def drawn(**values):
        image = np.zeros((60, 81, 3), np.uint8)
        rv.draw_passband(image, params(**values))
        assert not image[..., (0, 2)].any()
        return image[30, 40:, 1]  # from the middle to the right

    def brightest(line):
        return np.flatnonzero(line > 128).tolist()

    assert not drawn(filter="none").any()
    for name in ("low_pass", "high_pass"):
        assert 20 in brightest(drawn(filter=name, radius=0.5))
        assert not drawn(filter=name, radius=0.5)[:19].any()
    line = drawn(filter="band_pass", radius=0.5, width=0.4)
    assert {12, 28} <= set(brightest(line)) and not line[14:27].any()
    line = drawn(filter="band_pass", radius=0.1, width=0.4)
    assert not line[:11].any()  # the lower border is below 0


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("window", "hamming", "window is hamming, must be hann or none"),
        ("filter", "notch", "filter is notch, must be none, low_pass, high_pass or band_pass"),
        ("shape", "box", "shape is box, must be ideal, gaussian or butterworth"),
        ("radius", 0.0, "radius is 0, must be above 0 and at most 1.5"),
        ("order", 11, "order is 11, must be from 1 to 10"),
        ("min_response", -0.1, "min_response is -0.1, must be from 0 to 1"),
    ],
)
def test_parameters_are_refused(name, value, text):
    image, wrong = noise((8, 8)), params(**{name: value})
    for call in (
        lambda: rv.spectrum_magnitude(image, "mono8", wrong),
        lambda: rv.filter_frequencies(image, "mono8", wrong),
        lambda: rv.frequency_mask((8, 8), wrong),
        lambda: rv.draw_passband(np.zeros((8, 8, 3), np.uint8), wrong),
        lambda: rv.PhaseCorrelator(wrong),
    ):
        with pytest.raises(ValueError, match=text):
            call()


def test_what_is_no_image_is_refused():
    for function in (rv.spectrum_magnitude, rv.filter_frequencies):
        with pytest.raises(ValueError, match="mono8 image of 8x8: expected pixels of 1 x 8 bits"):
            function(noise((8, 8, 3)), "mono8")
    with pytest.raises(ValueError, match="the size of the mask is 0x8, must be 1x1 or larger"):
        rv.frequency_mask((8, 0), params())
    with pytest.raises(ValueError, match=r"expected a \(rows, columns\) array"):
        rv.spectrum_image(np.zeros((2, 2, 2), np.float32))
