"""The node code_reader: what it publishes about the codes in its frames, and how often."""

import numpy as np
import pytest
import support
from frames import Camera, message
from sensor_msgs.msg import Image

from robot_vision import CodeReader, keeps_bytes
from robot_vision.markers.marker import qr_modules
from robot_vision.msg import DetectionArray

HELLO = b"Hello World!\n"
GREETING = "Grüße an 世界".encode()
BINARY = bytes([0, 255, 128, 10])


def place(image, data, x, y, module=4):
    """Puts a QR code without its quiet zone at (x, y)."""
    code = np.kron(~qr_modules(data), np.full((module, module), 255, np.uint8))
    image[y : y + len(code), x : x + len(code)] = code
    return len(code)


def with_codes(*data):
    """A gray image of codes side by side."""
    image = np.full((240, 640), 255, np.uint8)
    for number, one in enumerate(data):
        place(image, one, 40 + 200 * number, 60)
    return image


class Reader:
    """A camera at 10 Hz by its stamps, and what the node publishes about its frames.

    Every frame is searched whole, unless the arguments say something else.
    """

    def __init__(self, start, *arguments):
        self.source = Camera(10.0)
        arguments = (f"image:={self.source.topic}", "_max_search_period:=0", *arguments)
        self.process = start("code_reader.py", "__name:=reader", *arguments)
        self.codes = support.subscribed("/reader/codes", DetectionArray)
        self.overlays = support.subscribed("/reader/processed_image", Image)
        self.source.wait_for()

    def show(self, image, encoding="mono8", **options):
        """Shows an image and returns its overlay."""
        return self.overlays.of(self.source.show(image, encoding, **options).stamp)

    def read(self, *image, **options):
        """Shows an image and returns its codes and its overlay."""
        overlay = self.show(*image, **options)
        return self.codes.of(overlay.header.stamp), overlay


def test_all_fields_of_a_code(start):
    reader = Reader(start)
    image = np.full((240, 320), 255, np.uint8)
    side = place(image, HELLO, 100, 50)
    codes, overlay = reader.read(image)
    assert codes.header.frame_id == overlay.header.frame_id == "eye"
    assert (codes.width, codes.height) == (320, 240)
    (code,) = codes.detections
    assert (code.label, code.code_type, code.code_data) == (HELLO.decode(), "qr", HELLO)
    assert (code.id, code.score, code.has_velocity, code.predicted) == (-1, 1.0, False, False)
    outline = [(p.x, p.y) for p in code.outline]
    right, bottom = 100 + side, 50 + side
    corners = [(100, 50), (right, 50), (right, bottom), (100, bottom)]
    assert np.array(outline) == pytest.approx(np.array(corners) - 0.5, abs=2.0)
    assert (code.center.x, code.center.y) == pytest.approx(np.mean(outline, axis=0))
    assert code.area == pytest.approx(side**2, rel=0.05)
    box = code.box
    assert (box.x_offset, box.y_offset) == tuple(np.floor(np.min(outline, axis=0) + 0.5))
    assert (box.x_offset + box.width - 1, box.y_offset + box.height - 1) == tuple(
        np.ceil(np.max(outline, axis=0) - 0.5)
    )
    assert (overlay.encoding, overlay.width, overlay.height) == ("bgr8", 320, 240)
    pixels = np.frombuffer(overlay.data, np.uint8).reshape(240, 320, 3)
    green = (pixels == (0, 255, 0)).all(axis=2)
    for x, y in outline:
        assert green[round(y) - 1 : round(y) + 2, round(x) - 1 : round(x) + 2].any()
    drawn = (pixels != image[:, :, None]).any(axis=2)
    assert drawn[30:45, 100:160].any()  # the label
    assert not drawn[60:120, 110:160].any()  # inside of the code


@pytest.mark.skipif(not keeps_bytes(), reason="zbar is older than 0.23.1")
def test_any_text_and_any_bytes_are_published(start):
    codes, _ = Reader(start).read(with_codes(GREETING, BINARY))
    assert {code.code_data: code.label for code in codes.detections} == {
        GREETING: GREETING.decode(),
        BINARY: "\x00\ufffd\ufffd\n",
    }


def test_images_of_every_encoding_are_read(start):
    reader = Reader(start, "_repeat_period:=0")
    gray = with_codes(b"kinds")
    for image, encoding in [
        (np.dstack([gray] * 3), "bgr8"),
        (gray.astype(np.uint16) * 257, "mono16"),
        (gray, "bayer_rggb8"),
    ]:
        codes, _ = reader.read(image, encoding, padding=6)
        assert [code.code_data for code in codes.detections] == [b"kinds"], encoding


def test_code_is_published_again_after_the_repeat_period(start):
    reader = Reader(start, "_repeat_period:=0.45")
    shown = [(b"a",), (b"a",), (b"a", b"b"), (), (b"b",), (b"a", b"b"), (b"a", b"b"), (b"b",)]
    expected = [["a"], None, ["b"], None, None, ["a"], None, ["b"]]
    stamps = []
    for data, labels in zip(shown, expected):
        stamps.append(reader.show(with_codes(*data)).header.stamp)
        if labels:
            reader.codes.of(stamps[-1])  # or the next one would take its place
    last, _ = reader.read(with_codes(b"end"))  # all messages before this one have arrived
    told = {
        one.header.stamp: [code.label for code in one.detections] for one in reader.codes.received
    }
    assert [told.get(stamp) for stamp in stamps] == expected
    assert [code.label for code in last.detections] == ["end"]


def test_every_frame_has_a_message_without_a_repeat_period(start):
    reader = Reader(start)
    assert support.reconfigured("/reader")["repeat_period"] == 1.0
    support.reconfigured("/reader", repeat_period=0.0)
    for data in [(b"a", b"b"), (b"a", b"b"), (), (b"b",)]:
        codes, _ = reader.read(with_codes(*data))
        assert [code.label for code in codes.detections] == [one.decode() for one in data]


def test_known_codes_are_followed_and_the_search_period_changes_live(start):
    reader = Reader(start, "_repeat_period:=0", "_max_search_period:=60")
    assert reader.read(with_codes(b"a"))[0].detections  # the first frame is searched whole
    both = with_codes(b"a", b"b")
    for _ in range(3):
        assert [code.label for code in reader.read(both)[0].detections] == ["a"]
    assert not reader.read(with_codes())[0].detections
    assert support.reconfigured("/reader", max_search_period=0.0)["max_search_period"] == 0.0
    assert len(reader.read(both)[0].detections) == 2


def test_another_repeat_period_does_not_begin_anew(start):
    reader = Reader(start, "_repeat_period:=0", "_max_search_period:=60")
    assert reader.read(with_codes(b"a"))[0].detections
    support.reconfigured("/reader", repeat_period=0.01)
    codes, _ = reader.read(with_codes(b"a", b"b"))  # of which a first frame would have both
    assert [code.label for code in codes.detections] == ["a"]


def test_all_is_news_after_a_time_without_subscribers(start):
    reader = Reader(start, "_repeat_period:=3600")
    assert reader.read(with_codes(b"a"))[0].detections
    reader.codes.close()
    reader.overlays.close()
    reader.source.wait_for(0)
    reader.codes = support.subscribed("/reader/codes", DetectionArray)
    reader.overlays = support.subscribed("/reader/processed_image", Image)
    reader.source.wait_for()
    codes, _ = reader.read(with_codes(b"a"))
    assert [code.label for code in codes.detections] == ["a"]


def test_symbologies_are_changed_live(start):
    reader = Reader(start, "_repeat_period:=0")
    assert reader.read(with_codes(b"a"))[0].detections
    support.reconfigured("/reader", symbologies="ean13, code128")
    assert not reader.read(with_codes(b"a"))[0].detections
    config = support.reconfigured("/reader", symbologies="ean13, aztec")
    assert config["symbologies"] == "ean13, code128"
    reader.process.wait_for_output(
        "refused, the parameters stay as they are: symbologies has 'aztec'"
    )
    support.reconfigured("/reader", symbologies="qr", enlarge=2, spacing=2)
    assert reader.read(with_codes(b"a"))[0].detections


def test_bad_frame_is_refused_and_the_next_is_read(start):
    reader = Reader(start, "_repeat_period:=0")
    bad = message(with_codes(b"a"), "mono8")
    bad.data = bad.data[:1000]
    reader.source.send(bad)
    reader.process.wait_for_output("(mono8, 640x240): data has 1000 bytes")
    assert reader.read(with_codes(b"a"))[0].detections


def test_code_of_the_scene_is_read(start):
    start("camera_node", "__name:=camera", "_source:=synthetic")
    whole = "_max_search_period:=0"
    start("code_reader.py", "__name:=reader", "image:=/camera/image_raw", whole)
    images = support.Messages("/camera/image_raw", Image)
    codes = support.Messages("/reader/codes", DetectionArray)
    image, found = support.same_frame(images, codes)
    (code,) = found.detections
    assert (code.label, code.code_type) == ("robot_vision", "qr")
    pixels = np.frombuffer(image.data, np.uint8).reshape(image.height, image.width, 3)
    (expected,) = CodeReader().read(pixels)
    assert np.array([(p.x, p.y) for p in code.outline]) == pytest.approx(expected.polygon, abs=1e-4)


def test_bad_value_at_start_is_fatal(start):
    text = "symbologies has 'aztec', must be all, or some with commas: qr, ean13, "
    support.assert_fatal_at_start(start, "code_reader.py", "symbologies", "aztec", text)
