"""Invalid frames are refused and counted, and the next valid one is processed."""

import io
import struct

import cv2
import numpy as np
import pytest
import rospy
import support
from sensor_msgs.msg import CompressedImage, Image

WIDTH, HEIGHT = 16, 8
BYTES_PER_PIXEL = {
    "bgr8": 3,
    "rgb8": 3,
    "bgra8": 4,
    "rgba8": 4,
    "mono8": 1,
    "mono16": 2,
    "yuv422": 2,
    "yuv422_yuy2": 2,
    "bayer_rggb8": 1,
    "bayer_bggr8": 1,
    "bayer_gbrg8": 1,
    "bayer_grbg8": 1,
    "bayer_rggb16": 2,
    "bayer_bggr16": 2,
    "bayer_gbrg16": 2,
    "bayer_grbg16": 2,
}


def good(encoding):
    """A valid message."""
    message = Image(encoding=encoding, width=WIDTH, height=HEIGHT)
    message.step = WIDTH * BYTES_PER_PIXEL[encoding]
    message.data = bytes(np.arange(HEIGHT * message.step, dtype=np.uint32).astype(np.uint8))
    message.header.frame_id = "good_" + encoding
    return message


def changed(of, **fields):
    """A valid message with some fields changed."""
    message = good(of)
    for name, value in fields.items():
        setattr(message, name, value)
    message.header.frame_id = "bad"
    return message


def bad(encoding):
    """(error, message) for everything that can be wrong with a frame of this encoding."""
    step = good(encoding).step
    data = good(encoding).data
    # step * height is the size of data only modulo 2^32
    wrapping = changed(encoding, height=2**31 + HEIGHT, step=2 * step, data=data * 2)
    return [
        ("empty data", changed(encoding, data=b"")),
        ("step too small", changed(encoding, step=step - 1, data=data[: HEIGHT * (step - 1)])),
        ("step of zero", changed(encoding, step=0, data=b"")),
        ("data too short", changed(encoding, data=data[:-1])),
        ("data too long", changed(encoding, data=data + b"\0")),
        ("no width", changed(encoding, width=0)),
        ("no height", changed(encoding, height=0)),
        ("nothing at all", changed(encoding, width=0, height=0, step=0, data=b"")),
        ("huge width", changed(encoding, width=2**32 - 1)),
        ("huge height", changed(encoding, height=2**32 - 1)),
        ("huge size", changed(encoding, width=2**31, height=2**31, step=2**31)),
        ("size that wraps to data's", wrapping),
        ("unknown encoding", changed(encoding, encoding="rgb565")),
        ("no encoding", changed(encoding, encoding="")),
        ("compressed encoding", changed(encoding, encoding="jpeg")),
        ("wrong endianness flag", changed(encoding, is_bigendian=2)),
    ]


@pytest.mark.parametrize("node", ["brightness_node", "edge_detector_node"])
def test_bad_frames_are_refused_and_counted(start, diagnostics, node):
    process = start(node, "__name:=filter", "image:=/frames", "_diagnostic_period:=0.02")
    publisher = rospy.Publisher("/frames", Image, queue_size=10, tcp_nodelay=True)
    results = support.Messages("/filter/processed_image", Image)
    support.wait_for(lambda: publisher.get_num_connections() > 0, "the node's subscription")

    refused = 0
    for accepted, encoding in enumerate(BYTES_PER_PIXEL, 1):
        for what, message in bad(encoding):
            publisher.publish(message)
            refused += 1
            support.wait_for(
                lambda: int(diagnostics.value("filter", "frames refused")) == refused,  # noqa: B023
                f"refusal of {encoding} with {what}",
            )
        publisher.publish(good(encoding))
        result = results.wait(accepted)[-1]
        assert result.header.frame_id == "good_" + encoding
        assert (result.width, result.height) == (WIDTH, HEIGHT)

    assert len(results.received) == len(BYTES_PER_PIXEL)
    assert process.running()
    # The first error is logged at once with topic, encoding, size and reason.
    expected = "refused a frame on /frames (bgr8, 16x8): data has 0 bytes, step * height is 384"
    assert expected in process.output()
    results.close()
    publisher.unregister()


class Raw(Image):
    """Raw bytes that are sent as a message."""

    def __init__(self, kind, data):
        super().__init__()
        self._type, self._md5sum, self._full_text = kind._type, kind._md5sum, kind._full_text
        self._bytes = data

    def serialize(self, buff):
        buff.write(self._bytes)


@pytest.mark.parametrize(("transport", "kind"), [("raw", Image), ("compressed", CompressedImage)])
def test_no_memory_is_taken_for_data_that_does_not_come(start, diagnostics, transport, kind):
    """A message of 46 bytes claims 2 GB of data; a PNG of 200 kB has 64 million pixels."""
    topic = "/frames" if transport == "raw" else "/frames/" + transport
    process = start(
        *("edge_detector_node", "__name:=filter", "image:=/frames", "_diagnostic_period:=0.02"),
        "_image_transport:=" + transport,
    )
    publisher = rospy.Publisher(topic, kind, queue_size=10, tcp_nodelay=True)
    results = support.Messages("/filter/processed_image", Image)
    support.wait_for(lambda: publisher.get_num_connections() > 0, "the node's subscription")
    usual = good("bgr8")
    if kind is CompressedImage:
        data = cv2.imencode(".png", np.zeros((HEIGHT, WIDTH, 3), np.uint8))[1].tobytes()
        usual = CompressedImage(format="bgr8; png compressed bgr8", data=data)
        huge = cv2.imencode(".png", np.zeros((8192, 8191), np.uint8))[1].tobytes()
    else:
        huge = b""
    publisher.publish(usual)
    results.wait()
    before = memory_of(process)
    buffer = io.BytesIO()
    kind().serialize(buffer)
    publisher.publish(Raw(kind, buffer.getvalue()[:-4] + struct.pack("<I", 0x80000000)))
    if huge:
        publisher.publish(CompressedImage(format="mono8; png compressed ", data=huge))
        results.wait(2)
    publisher.publish(usual)
    results.wait(2 + bool(huge))
    support.wait_for(lambda: memory_of(process)[0] - before[0] < 1 << 26, "the memory back")
    if not huge:
        assert memory_of(process)[1] - before[1] < 1 << 26
    results.close()
    publisher.unregister()


def memory_of(process):
    """The present and the peak memory of a process in bytes."""
    with open(f"/proc/{process.pid}/status") as file:
        fields = dict(line.split(":", 1) for line in file)
    return tuple(int(fields[name].split()[0]) << 10 for name in ("VmRSS", "VmHWM"))


def test_an_encoding_cannot_control_a_terminal(start, diagnostics):
    process = start("edge_detector_node", "__name:=filter", "image:=/frames")
    publisher = rospy.Publisher("/frames", Image, queue_size=10, tcp_nodelay=True)
    results = support.Messages("/filter/processed_image", Image)
    support.wait_for(lambda: publisher.get_num_connections() > 0, "the node's subscription")
    publisher.publish(changed("bgr8", encoding="\x1b[2J\n" + 5000 * "x"))
    process.wait_for_output(r"refused a frame on /frames (\x1b[2J\x0axxx")
    assert "\x1b[2J" not in process.output() and 150 * "x" not in process.output()
    support.wait_for(lambda: "x1b" in diagnostics.value("filter", "last error"), "the diagnostics")
    error = diagnostics.value("filter", "last error")
    assert error.isprintable() and len(error) < 700, error
    results.close()
    publisher.unregister()


def test_other_byte_order_is_honoured(start):
    start("brightness_node", "__name:=filter", "image:=/frames", "_offset:=0")
    publisher = rospy.Publisher("/frames", Image, queue_size=10)
    results = support.Messages("/filter/processed_image", Image)
    support.wait_for(lambda: publisher.get_num_connections() > 0, "the node's subscription")
    levels = np.arange(WIDTH * HEIGHT, dtype=np.uint16) * 500
    message = changed("mono16", is_bigendian=1, data=levels.astype(">u2").tobytes())
    publisher.publish(message)
    result = results.wait()[0]
    assert result.encoding == "mono16"
    order = ">u2" if result.is_bigendian else "<u2"
    assert np.array_equal(np.frombuffer(result.data, order), levels)
    results.close()
    publisher.unregister()
