"""Invalid frames are refused and counted, and the next valid one is processed."""

import io
import re
import struct

import cv2
import numpy as np
import pytest
import support
from frames import ENCODINGS, UNKNOWN, Source, damaged, message, noise
from sensor_msgs.msg import CompressedImage, Image

WIDTH, HEIGHT = 16, 8
NODES = ("brightness", "edge_detector", "filter", "dense_flow", "spectrum", "segmenter")
FILTERED = [name for name in ENCODINGS if not re.search("C|(rgb|bgr)a?16", name)]


def good(encoding):
    """A valid message."""
    image = message(noise(encoding, HEIGHT, WIDTH), encoding)
    image.header.frame_id = "good_" + encoding
    return image


def run(start, node, *arguments, topic="/frames", kind=Image):
    """A node that has subscribed to /frames: its process, the topic's source, and its results."""
    process = start(node, "__name:=filter", "image:=/frames", *arguments)
    source, results = Source(topic, kind), support.Messages("/filter/processed_image", Image)
    source.wait_for()
    return process, source, results


@pytest.mark.parametrize("node", NODES)
def test_bad_frames_are_refused_and_counted(start, diagnostics, node):
    """All do it by the same code: of the first two in all encodings, of the others in a few."""
    process, source, results = run(start, node + "_node", "_diagnostic_period:=0.02")
    encodings = FILTERED if node in NODES[:2] else ["bgr8", "mono16", "yuv422"]
    if node == "dense_flow":
        source.send(good("bgr8"))  # the first frame has no flow
        support.wait_for(
            lambda: diagnostics.value("filter", "frames published") == "1", "the first frame"
        )
    refused = 0
    for accepted, encoding in enumerate(encodings, 1):
        for fields, bad in damaged(good(encoding), UNKNOWN[:3]):
            source.send(bad)
            refused += 1
            support.wait_for(
                lambda: int(diagnostics.value("filter", "frames refused")) == refused,  # noqa: B023
                f"refusal of {encoding} with {fields}",
            )
        source.send(good(encoding))
        result = results.wait(accepted)[-1]
        assert result.header.frame_id == "good_" + encoding
        assert (result.width, result.height) == (WIDTH, HEIGHT)

    assert len(results.received) == len(encodings)
    assert process.running()
    # The first error is logged at once with topic, encoding, size and reason.
    expected = "refused a frame on /frames (bgr8, 16x8): data has 0 bytes, step * height is 384"
    assert expected in process.output()


class Raw(Image):
    """Raw bytes that are sent as a message."""

    def __init__(self, kind, data):
        super().__init__()
        self._type, self._md5sum, self._full_text = kind._type, kind._md5sum, kind._full_text
        self._bytes = data

    def serialize(self, buff):
        buff.write(self._bytes)


@pytest.mark.parametrize(("transport", "kind"), [("raw", Image), ("compressed", CompressedImage)])
def test_no_memory_is_taken_for_data_that_does_not_come(start, transport, kind):
    """A message of 46 bytes claims 2 GB of data; a PNG of 200 kB has 64 million pixels."""
    topic = "/frames" if transport == "raw" else "/frames/" + transport
    arguments = ["edge_detector_node", "_image_transport:=" + transport]
    process, source, results = run(start, *arguments, topic=topic, kind=kind)
    usual = good("bgr8")
    if kind is CompressedImage:
        data = cv2.imencode(".png", np.zeros((HEIGHT, WIDTH, 3), np.uint8))[1].tobytes()
        usual = CompressedImage(format="bgr8; png compressed bgr8", data=data)
        huge = cv2.imencode(".png", np.zeros((8192, 8191), np.uint8))[1].tobytes()
    else:
        huge = b""
    source.send(usual)
    results.wait()
    before = memory_of(process)
    buffer = io.BytesIO()
    kind().serialize(buffer)
    source.send(Raw(kind, buffer.getvalue()[:-4] + struct.pack("<I", 0x80000000)))
    if huge:
        source.send(CompressedImage(format="mono8; png compressed ", data=huge))
        results.wait(2)
    source.send(usual)
    results.wait(2 + bool(huge))
    support.wait_for(lambda: memory_of(process)[0] - before[0] < 1 << 26, "the memory back")
    if not huge:
        assert memory_of(process)[1] - before[1] < 1 << 26


def memory_of(process):
    """The present and the peak memory of a process in bytes."""
    with open(f"/proc/{process.pid}/status") as file:
        fields = dict(line.split(":", 1) for line in file)
    return tuple(int(fields[name].split()[0]) << 10 for name in ("VmRSS", "VmHWM"))


def test_an_encoding_cannot_control_a_terminal(start, diagnostics):
    process, source, _ = run(start, "edge_detector_node")
    image = good("bgr8")
    image.encoding = "\x1b[2J\n" + 5000 * "x"
    source.send(image)
    process.wait_for_output(r"refused a frame on /frames (\x1b[2J\x0axxx")
    assert "\x1b[2J" not in process.output() and 150 * "x" not in process.output()
    support.wait_for(lambda: "x1b" in diagnostics.value("filter", "last error"), "the diagnostics")
    error = diagnostics.value("filter", "last error")
    assert error.isprintable() and len(error) < 700, error


def test_other_byte_order_is_honoured(start):
    _, source, results = run(start, "brightness_node", "_offset:=0")
    levels = np.arange(WIDTH * HEIGHT, dtype=np.uint16).reshape(HEIGHT, WIDTH) * 500
    source.send(message(levels, "mono16", order=">"))
    result = results.wait()[0]
    assert result.encoding == "mono16"
    order = ">u2" if result.is_bigendian else "<u2"
    assert np.array_equal(np.frombuffer(result.data, order), levels.ravel())
