"""QR codes and bar codes: random contents are read back at any place and angle."""

import ctypes

import bar_codes
import cv2
import numpy as np
import pytest
import qrcode.util
import skimage.data

import robot_vision as rv
from robot_vision.common.plain_text import to_ascii
from robot_vision.common.repeats import Repeats
from robot_vision.markers.marker import qr_modules

QUIET = 4  # modules
needs_bytes = pytest.mark.skipif(not rv.keeps_bytes(), reason="zbar is older than 0.23.1")


def reader(**values):
    params = rv.CodeReaderParams()
    for name, value in values.items():
        setattr(params, name, value)
    return rv.CodeReader(params)


def found(codes):
    return [(code.type, code.data) for code in codes]


def qr_image(data, module, level="M"):
    """A QR code with its quiet zone; a module has `module` px."""
    white = np.pad(~qr_modules(data, level), QUIET, constant_values=True)
    return np.kron(white, np.full((module, module), 255, np.uint8))


def payload(rng, kind, length):
    """Random content of a kind, of about `length` bytes."""
    if kind == "bytes":
        return rng.integers(0, 256, length, np.uint8).tobytes()
    if kind == "digits":
        return "".join(map(str, rng.integers(0, 10, length))).encode()
    if kind == "capitals":
        return "".join(rng.choice(list("AZ0 $%*+-./:"), length)).encode()
    letters = list("aZ 09/?äßéЖ中文日本語😀\x00\n")
    return "".join(rng.choice(letters, max(length // 2, 1))).encode()


def test_bytes_are_kept_by_every_zbar_but_old_ones():
    numbers = [ctypes.c_uint() for _ in range(3)]
    ctypes.CDLL("libzbar.so.0").zbar_version(*map(ctypes.byref, numbers))
    version = tuple(number.value for number in numbers)
    assert rv.keeps_bytes() == (version >= (0, 23, 1)), version


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param("bytes", marks=needs_bytes),
        pytest.param("text", marks=needs_bytes),
        "digits",
        "capitals",
    ],
)
def test_every_qr_code_is_read_back(kind):
    rng = np.random.default_rng(len(kind))
    qr = reader()
    lengths = [*range(1, 25), *(2 ** rng.uniform(4.6, 9, 25)).astype(int)]
    for length in lengths:
        data = payload(rng, kind, length)
        level = "LMQH"[rng.integers(4)]
        image = qr_image(data, int(rng.integers(2, 6)), level)
        assert found(qr.read(image, "mono8")) == [("qr", data)], (data, level, image.shape)


@needs_bytes
@pytest.mark.parametrize("level, most", [("L", 2953), ("M", 2331), ("Q", 1663), ("H", 1273)])
def test_the_largest_qr_codes_are_read_back(level, most):
    data = payload(np.random.default_rng(most), "bytes", most)  # in L, M and Q every byte there is
    assert found(reader().read(qr_image(data, 3, level), "mono8")) == [("qr", data)]
    with pytest.raises(ValueError, match=f"^{most + 1} bytes fit no QR code of level {level}$"):
        qr_modules(data + b"x", level)


def seen(image, turn, module, tilt, rng, size=(640, 480)):
    """The code as a camera sees it, and the corners of its modules, px.

    A homography of a higher resolution is drawn, then contrast and noise are added.
    """
    modules = image.shape[0]
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / 2.0
    turned = [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    corners = square * modules * module * rng.uniform(1 - tilt, 1, (4, 2)) @ turned
    corners += np.array(size) / 2.0 + rng.uniform(-20, 20, 2)
    inside = (square + 0.5) * modules
    fine, finer = 4 if module < 4.0 else 2, 8  # large modules are smooth with fewer points
    large = np.kron(image, np.ones((finer, finer), np.uint8))
    drawn = np.full(size[::-1], 255, np.uint8)
    left, top = np.maximum(corners.min(axis=0) - 1, 0).astype(int)
    right, bottom = np.minimum(corners.max(axis=0) + 2, size).astype(int)
    to_fine = homography(inside * finer - 0.5, (corners - (left, top) + 0.5) * fine - 0.5)
    part_size = right - left, bottom - top
    part = cv2.warpPerspective(large, to_fine, np.multiply(part_size, fine), borderValue=255)
    drawn[top:bottom, left:right] = cv2.resize(part, part_size, interpolation=cv2.INTER_AREA)
    drawn = np.clip(drawn * 0.7 + 30 + rng.normal(0, 3, drawn.shape), 0, 255).astype(np.uint8)
    without_quiet = QUIET + (square + 0.5) * (modules - 2 * QUIET)
    places = cv2.perspectiveTransform(without_quiet[None], homography(inside, corners))
    return drawn, places[0]


def homography(there, here):
    return cv2.getPerspectiveTransform(there.astype(np.float32), here.astype(np.float32))


def test_qr_codes_turned_and_tilted_are_read_and_located():
    rng = np.random.default_rng(3)
    qr = reader()
    errors, missed = [], 0
    for _ in range(120):
        data = payload(rng, "capitals", int(rng.integers(1, 60)))
        modules = qr_image(data, 1)
        module = rng.uniform(3.0, 400 / len(modules))
        image, corners = seen(modules, rng.uniform(0, 2 * np.pi), module, 0.15, rng)
        codes = qr.read(image, "mono8")
        if not codes:
            missed += 1
            continue
        assert found(codes) == [("qr", data)]
        errors.append(np.abs(codes[0].polygon - corners).max() / module)
    assert missed <= 4, missed
    assert np.median(errors) < 0.25 and max(errors) < 0.8, np.percentile(errors, [50, 90, 100])


def test_qr_codes_are_read_blurred():
    rng = np.random.default_rng(4)
    for sigma in (0.5, 1.0, 1.5):
        image = cv2.GaussianBlur(qr_image(b"blurred", 4), (0, 0), sigma)
        noisy = np.clip(image + rng.normal(0, 5, image.shape), 0, 255).astype(np.uint8)
        assert found(reader().read(noisy, "mono8")) == [("qr", b"blurred")], sigma


def test_enlarged_small_codes_are_read():
    rng = np.random.default_rng(5)
    plainly, enlarged = reader(), reader(enlarge=2)
    as_it_is, larger, errors = 0, 0, []
    for _ in range(40):
        data = payload(rng, "capitals", int(rng.integers(1, 60)))
        image, corners = seen(qr_image(data, 1), rng.uniform(0, 2 * np.pi), 2.3, 0.05, rng)
        as_it_is += found(plainly.read(image, "mono8")) == [("qr", data)]
        codes = enlarged.read(image, "mono8")
        if found(codes) == [("qr", data)]:
            larger += 1
            errors.append(np.abs(codes[0].polygon - corners).max())
    assert larger >= 36 and larger > as_it_is + 10, (larger, as_it_is)
    assert np.median(errors) < 1.2, np.median(errors)


def test_a_damaged_qr_code_is_read_right_or_not_at_all():
    rng = np.random.default_rng(6)
    qr = reader()
    read = 0
    for _ in range(60):
        data = payload(rng, "capitals", 40)
        image = qr_image(data, 4, "H")
        side = int(rng.integers(8, 110))
        x, y = rng.integers(0, len(image) - side, 2)
        image[y : y + side, x : x + side] = rng.integers(0, 2) * 255
        codes = found(qr.read(image, "mono8"))
        assert codes in ([], [("qr", data)])
        read += len(codes)
    assert 20 < read < 60, read  # some codes were damaged too much


BAR_CODES = {
    "ean13": lambda digits: bar_codes.ean13("4" + digits[:11]),
    "ean8": lambda digits: bar_codes.ean8(digits[:7]),
    "upca": lambda digits: bar_codes.upca(digits[:11]),
    "upce": lambda digits: bar_codes.upce(digits[:5] + "1"),
    "code128": lambda digits: bar_codes.code128("Ab-" + digits[:9]),
    "code93": lambda digits: bar_codes.code93("FACE-" + digits[:7]),
    "code39": lambda digits: bar_codes.code39("FACE-" + digits[:5]),
    "i25": lambda digits: bar_codes.i25(digits[:12]),
    "codabar": lambda digits: bar_codes.codabar(digits[:9]),
}


@pytest.mark.parametrize("kind", BAR_CODES)
def test_every_bar_code_is_read_back(kind):
    rng = np.random.default_rng(7)
    for reads in (reader(), reader(symbologies=kind)):
        for turn in range(4):
            text, widths = BAR_CODES[kind](payload(rng, "digits", 12).decode())
            bars = bar_codes.image(widths)
            height, width = bars.shape
            top, left = 40, 60
            image = np.full((480, 640), 255, np.uint8)
            image[top : top + height, left : left + width] = bars
            image = np.rot90(image, turn)
            codes = reads.read(image, "mono8")
            assert found(codes) == [(kind, text.encode())]
            # The polygon is around the bars, which are read along lines from end to end.
            x, y, wide, high = cv2.boundingRect((image == 0).astype(np.uint8))
            low, above = codes[0].polygon.min(axis=0), codes[0].polygon.max(axis=0)
            if turn % 2:
                low, above, x, y, wide, high = low[::-1], above[::-1], y, x, high, wide
            assert low == pytest.approx((x, y), abs=12) and above[0] - low[0] > 0.9 * wide
            assert above == pytest.approx((x + wide, y + high), abs=12)
            assert 0.5 < codes[0].score < 1.0


@pytest.mark.parametrize("kind", ["code128", "code93", "code39", "i25"])
def test_one_line_is_no_bar_code(kind):
    _, widths = BAR_CODES[kind]("123456789012")
    bars = bar_codes.image(widths)
    middle = len(bars) // 2
    for lines, expected in [(1, 0), (2, 1), (3, 1)]:
        image = np.full((60, bars.shape[1]), 255, np.uint8)
        image[20 : 20 + lines] = bars[middle]
        assert len(reader().read(image, "mono8")) == expected, lines


def test_codes_come_from_top_to_bottom():
    image = np.full((480, 640), 255, np.uint8)
    places = {b"second": (150, 300), b"first": (20, 40), b"third": (300, 10)}
    for data, (y, x) in places.items():
        code = qr_image(data, 4)
        image[y : y + len(code), x : x + len(code)] = code
    codes = reader().read(image, "mono8")
    assert found(codes) == [("qr", b"first"), ("qr", b"second"), ("qr", b"third")]
    assert all(code.score == 1.0 for code in codes)


def test_only_the_symbologies_wanted_are_read():
    image = np.full((300, 400), 255, np.uint8)
    bars = bar_codes.image(bar_codes.ean13("400638133393")[1])
    code = qr_image(b"hello", 4)
    image[: bars.shape[0], : bars.shape[1]] = bars
    image[-len(code) :, -len(code) :] = code
    both = [("ean13", b"4006381333931"), ("qr", b"hello")]
    for wanted, expected in [
        ("all", both),
        (" qr , ean13 ", both),
        ("ean13,code128", both[:1]),
        ("qr", both[1:]),
        ("i25", []),
    ]:
        assert found(reader(symbologies=wanted).read(image, "mono8")) == expected, wanted


def with_header(monkeypatch, data, *header):
    """A QR code of bytes after a header of (value, bits)."""

    class Buffer(qrcode.util.BitBuffer):
        def __init__(self):
            super().__init__()
            for value, bits in header:
                self.put(value, bits)

    with monkeypatch.context() as patched:
        patched.setattr(qrcode.util, "BitBuffer", Buffer)
        code = qrcode.QRCode(version=4, border=QUIET)
        code.add_data(qrcode.util.QRData(data, mode=qrcode.util.MODE_8BIT_BYTE))
        code.make(fit=False)
    return np.kron(~np.array(code.get_matrix(), bool), np.full((4, 4), 255, np.uint8))


def test_parts_of_a_content_are_one_code_if_all_are_there(monkeypatch):
    parts = [
        with_header(monkeypatch, text, (3, 4), (number, 4), (1, 4), (7, 8))
        for number, text in enumerate((b"hello ", b"world"))
    ]
    for order in (parts, parts[::-1]):
        assert found(reader().read(np.hstack(order), "mono8")) == [("qr", b"hello world")]
    for part in parts:
        assert not reader().read(part, "mono8")
        assert not reader().read(np.hstack([part, part]), "mono8")


@needs_bytes
@pytest.mark.parametrize(
    "data, number, expected",
    [
        ("Ä€".encode(), 26, ["Ä€".encode()]),
        (b"\xc4", 3, ["Ä".encode()]),  # Latin-1
        (b"\xff\x00", 100, [b"\xff\x00"]),  # not known
        (b"\xff\x00", 26, []),  # no UTF-8
    ],
)
def test_a_named_character_set_becomes_utf8(monkeypatch, data, number, expected):
    image = with_header(monkeypatch, data, (7, 4), (number, 8))
    assert [code.data for code in reader().read(image, "mono8")] == expected


@pytest.mark.parametrize("kind", BAR_CODES)
@pytest.mark.parametrize("spacing, enlarge", [(1, 1), (3, 1), (2, 2)])
def test_bar_codes_are_followed(kind, spacing, enlarge):
    _, widths = BAR_CODES[kind]("123456789012")
    bars = bar_codes.image(widths)
    height, width = bars.shape
    reads = reader(spacing=spacing, enlarge=enlarge, max_search_period=60.0)
    for frame in range(8):
        top, left = 40 + 9 * frame, 20 + 12 * frame
        image = np.full((480, 640), 255, np.uint8)
        image[top : top + height, left : left + width] = bars
        (code,) = reads.update(frame / 30, image, "mono8")
        (expected,) = reads.read(image, "mono8")
        assert found([code]) == found([expected])
        low, above = code.polygon.min(axis=0), code.polygon.max(axis=0)
        assert low == pytest.approx(expected.polygon.min(axis=0), abs=3.0)
        assert above == pytest.approx(expected.polygon.max(axis=0), abs=3.0)


def test_qr_codes_turned_and_tilted_are_followed():
    """Searching around the last place reads most codes that searching the whole image reads."""
    rng = np.random.default_rng(9)
    whole = followed = 0
    for _ in range(12):
        modules = qr_image(payload(rng, "capitals", int(rng.integers(1, 60))), 1)
        module = rng.uniform(3.0, 300 / len(modules))
        turn = rng.uniform(0, 2 * np.pi)
        qr = reader(max_search_period=60.0)
        for frame in range(5):
            image, _ = seen(modules, turn + 0.02 * frame, module, 0.1, rng)
            codes = qr.update(frame / 30, image, "mono8")
            expected = qr.read(image, "mono8")
            if frame and expected:
                whole += 1
                followed += found(codes) == found(expected)
    assert whole >= 40 and followed >= 0.95 * whole, (followed, whole)


def test_nothing_is_read_in_images_without_codes():
    rng = np.random.default_rng(8)
    images = [skimage.data.astronaut(), skimage.data.coffee(), skimage.data.chelsea()]
    grays = [cv2.cvtColor(image, cv2.COLOR_RGB2GRAY) for image in images]
    grays += [skimage.data.text(), skimage.data.page(), skimage.data.brick(), skimage.data.grass()]
    every = reader()
    for _ in range(25):
        for gray in grays:
            height, width = (np.array(gray.shape) * rng.uniform(0.4, 1.0)).astype(int)
            y, x = rng.integers(0, np.array(gray.shape) - (height, width) + 1)
            part = cv2.resize(gray[y : y + height, x : x + width], (320, 240))
            assert not every.read(part, "mono8"), found(every.read(part, "mono8"))
        noise = rng.integers(0, 256, (240, 320), np.uint8)
        assert not every.read(cv2.blur(noise, (1, int(rng.integers(1, 40)))), "mono8")


def test_images_of_every_encoding_are_read():
    gray = qr_image(b"kinds", 4)
    gray = gray[:, : len(gray) // 2 * 2]
    bgr = cv2.cvtColor(gray, cv2.COLOR_GRAY2BGR)
    yuv = np.dstack([np.full_like(gray, 128), gray])
    padded = np.zeros((len(gray), gray.shape[1] + 7), np.uint8)[:, :-7]
    padded[:] = gray
    for image, encoding in [
        (gray, "mono8"),
        (bgr, "bgr8"),
        (gray.astype(np.uint16) * 257, "mono16"),
        (yuv, "yuv422"),
        (padded, "mono8"),
        (gray[::-1, ::-1], "mono8"),
        (np.asfortranarray(gray), "mono8"),
    ]:
        for enlarge in (1, 2):
            before = image.copy()
            image.flags.writeable = False
            codes = reader(enlarge=enlarge).read(image, encoding)
            assert found(codes) == [("qr", b"kinds")], (encoding, image.strides)
            assert np.array_equal(image, before)


def test_images_that_are_too_small_have_no_codes():
    for shape in [(1, 1), (1, 300), (300, 1), (2, 2)]:
        for enlarge in (1, 4):
            assert (
                reader(enlarge=enlarge, spacing=16).read(np.zeros(shape, np.uint8), "mono8") == []
            )


def test_invalid_images_are_refused():
    with pytest.raises(ValueError, match="bgr8"):
        reader().read(np.zeros((40, 40), np.uint8))
    with pytest.raises(ValueError, match="1 to 4 channels"):
        reader().read(np.zeros((40, 40, 0), np.uint8))


def test_a_search_of_many_seconds_is_refused():
    text = "enlarge is 4, must be less, or the image of 4000x2000 have at most 6250000 pixels"
    for read in (lambda r, i: r.read(i, "mono8"), lambda r, i: r.update(0.0, i, "mono8")):
        with pytest.raises(ValueError, match=text):
            read(reader(enlarge=4), np.zeros((2000, 4000), np.uint8))


@pytest.mark.parametrize(
    "name, value, text",
    [
        (
            "symbologies",
            "aztec",
            "symbologies has 'aztec', must be all, or some with commas: qr, ean13, ean8, upca, "
            "upce, code128, code93, code39, i25, codabar$",
        ),
        ("symbologies", "qr,,ean8", "symbologies has '', must be all, or some with commas: qr, "),
        ("symbologies", "", "symbologies has '', must be all, or some with commas: qr, ean13, "),
        ("spacing", 0, "spacing is 0, must be from 1 to 16"),
    ],
)
def test_parameters_out_of_range_are_refused(name, value, text):
    with pytest.raises(ValueError, match="^" + text):
        reader(**{name: value})


def test_code_of_the_scene_is_read_at_its_place():
    scene = rv.Scene()
    every = reader()
    for frame in range(0, 600, 60):
        (code,) = every.read(scene.render(frame))
        assert found([code]) == [("qr", b"robot_vision")]
        truth = next(o.outline for o in scene.truth(frame).objects if o.name == "qr_code")
        # The scene's outline begins at the bottom left, and is counter-clockwise.
        assert code.polygon == pytest.approx(np.array(truth)[::-1], abs=3.0), frame


def test_repeats_are_distinguished_from_news():
    repeats = Repeats(1.0)
    assert repeats.news(["a", "a"], 5.0) == {"a"}
    assert repeats.news(["a", "b"], 5.5) == {"b"}
    assert repeats.news(["a", "b"], 6.0) == {"a"}
    assert repeats.news(["b"], 6.5) == {"b"}
    assert repeats.news(["a", "b"], 1.0) == {"a", "b"}  # time has gone back
    repeats.period = 0.0
    assert repeats.news(["a"], 1.0) == {"a"} == repeats.news(["a"], 1.0)


@pytest.mark.parametrize(
    "text, expected",
    [
        ("", ""),
        ("plain ~", "plain ~"),
        ("Zoë 中\n", "Zoe ??"),
        ("x" * 20, "x" * 20),
        ("x" * 21, "x" * 17 + "..."),
        ("ǆ" * 20, "dzdzdzdzdzdzdzdzd..."),
    ],
)
def test_labels_are_made_of_letters_that_can_be_drawn(text, expected):
    assert to_ascii(text, 20) == expected
