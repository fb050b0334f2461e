"""Our image_transport plugins: what they write and read, run by image_transport's republish."""

import pathlib
import re
import shutil
import struct
import subprocess

import cv2
import depth_streams
import numpy as np
import pytest
import rospy
import support
from frames import Frames, Source, message, new_topic
from ros_programs import program_of
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header

from robot_vision.transport import ImagePublisher, ImageSubscriber

ROOT = pathlib.Path(__file__).resolve().parents[2]
REPUBLISH = program_of("image_transport", "republish")
if not pathlib.Path(REPUBLISH).exists():
    REPUBLISH = "/opt/ros/noetic/lib/image_transport/republish"

HEADER = Header(stamp=rospy.Time(12, 34), frame_id="eye")


def smooth(height=48, width=64):
    """A smooth color image, BGR."""
    y, x = np.mgrid[:height, :width]
    waves = [np.sin(0.11 * x + 0.04 * y), np.cos(0.07 * y), np.sin(0.05 * (x + y))]
    return np.stack([127.5 + 127 * wave for wave in waves], axis=2).astype(np.uint8)


def told(image):
    """The encoding or format of an image, and its header."""
    kind = image.format if isinstance(image, CompressedImage) else image.encoding
    return kind, image.header.stamp, image.header.frame_id


def array(image):
    """The pixels of an Image with 8 or 16 bits, or of 32FC1."""
    if image.encoding == "32FC1":
        return np.frombuffer(image.data, np.float32).reshape(image.height, image.width)
    dtype = np.uint16 if "16" in image.encoding else np.uint8
    return np.frombuffer(image.data, dtype).reshape(image.height, image.width, -1).squeeze()


@pytest.fixture
def republish(start):
    """republish(from, to) starts a republisher and gives its input and output topics."""

    def run(from_transport, to_transport, topic=None, **parameters):
        source, target = topic or new_topic(), new_topic()
        process = start(
            REPUBLISH,
            from_transport,
            f"in:={source}",
            to_transport,
            f"out:={target}",
            f"__name:=republish_{target.split('/')[1]}",
            *[f"_{name}:={value}" for name, value in parameters.items()],
        )
        return source, target, process

    return run


def stamped(image, secs=HEADER.stamp.secs):
    image.header = Header(stamp=rospy.Time(secs, HEADER.stamp.nsecs), frame_id=HEADER.frame_id)
    return image


def open_chain(publisher, image, *ends):
    """Sends the image until it arrives at all ends, because connections take time."""

    def arrived():
        publisher.send(stamped(image, 1))
        return all(messages.received for messages in ends)

    support.wait_for(arrived, "images at all ends")


def through(source, kind, sent, messages):
    """Sends a message and returns the one that arrives."""
    publisher = Source(source, kind)
    publisher.wait_for()
    support.wait_for(messages.connected, "the answer's publisher")
    publisher.send(sent)
    return messages.wait()[0]


def test_what_compressed_writes(republish):
    source, target, _ = republish("raw", "compressed")
    out = support.Messages(target + "/compressed", CompressedImage)
    bgr = smooth()
    came = through(source, Image, stamped(message(bgr[:, :, ::-1], "rgb8", padding=6)), out)
    assert told(came) == ("rgb8; jpeg compressed bgr8", HEADER.stamp, "eye")
    assert came.data == cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, 80])[1].tobytes()

    # Its settings have the usual names and can be changed while it runs.
    settings = target + "/compressed"
    assert support.reconfigured(settings)["jpeg_quality"] == 80
    support.reconfigured(settings, jpeg_quality=30, jpeg_progressive=True)
    publisher = Source(source)
    publisher.wait_for()
    publisher.send(message(bgr, "bgr8"))
    options = [cv2.IMWRITE_JPEG_QUALITY, 30, cv2.IMWRITE_JPEG_PROGRESSIVE, 1]
    assert out.wait(2)[1].data == cv2.imencode(".jpg", bgr, options)[1].tobytes()
    support.reconfigured(settings, format="png", png_level=1)
    publisher.send(message(bgr[:, :, 0].astype(np.uint16) * 257, "mono16"))
    came = out.wait(3)[2]
    assert came.format == "mono16; png compressed "
    pixels = cv2.imdecode(np.frombuffer(came.data, np.uint8), cv2.IMREAD_UNCHANGED)
    assert np.array_equal(pixels, bgr[:, :, 0].astype(np.uint16) * 257)
    assert support.reconfigured(settings, format="webp")["format"] == "png"


@pytest.mark.parametrize(
    "format, suffix, encoding, mode, expected",
    [
        ("rgb8; png compressed bgr8", ".png", "rgb8", None, lambda bgr: bgr[:, :, ::-1]),
        ("bgr8; jpeg compressed bgr8", ".jpg", "bgr8", "unchanged", lambda bgr: bgr),
        ("jpeg", ".jpg", "mono8", "gray", None),
    ],
)
def test_what_compressed_reads(republish, format, suffix, encoding, mode, expected):
    parameters = {} if mode is None else {"compressed/mode": mode}
    source, target, process = republish("compressed", "raw", **parameters)
    out = support.Messages(target, Image)
    file = cv2.imencode(suffix, smooth())[1]
    sent = CompressedImage(header=HEADER, format=format, data=file.tobytes())
    came = through(source + "/compressed", CompressedImage, sent, out)
    assert told(came) == (encoding, HEADER.stamp, "eye")
    if expected is None:
        assert np.array_equal(array(came), cv2.imdecode(file, cv2.IMREAD_GRAYSCALE))
    else:
        assert np.array_equal(array(came), expected(cv2.imdecode(file, cv2.IMREAD_COLOR)))

    # A damaged image is refused, and the next one arrives.
    publisher = Source(source + "/compressed", CompressedImage)
    publisher.wait_for()
    publisher.send(CompressedImage(format=format, data=file.tobytes()[:-20]))
    process.wait_for_output(f"refused a frame on {source}/compressed: ")
    publisher.send(sent)
    out.wait(2)


def test_python_reads_and_writes_every_transport():
    topic = new_topic()
    publisher = ImagePublisher(topic)
    received = {name: [] for name in ("raw", "compressed", "theora")}
    subscribers = [
        ImageSubscriber(topic, frames.append, transport=name) for name, frames in received.items()
    ]
    support.wait_for(lambda: publisher.get_num_connections() == 3, "three subscriptions")
    bgr = smooth()
    publisher.publish(bgr, "bgr8", HEADER)
    support.wait_for(lambda: all(received.values()), "a frame over each transport")
    frames = {name: came[0] for name, came in received.items()}
    file = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, 80])[1]
    assert np.array_equal(frames["raw"].image, bgr)
    assert np.array_equal(frames["compressed"].image, cv2.imdecode(file, cv2.IMREAD_COLOR))
    assert np.abs(frames["theora"].image.astype(float) - bgr).mean() < 8
    for frame in frames.values():
        assert told(frame) == ("bgr8", HEADER.stamp, "eye")
    for subscriber in subscribers:
        subscriber.unregister()
    publisher.unregister()


def test_the_parameter_image_transport_chooses_the_transport():
    rospy.set_param("~image_transport", "compressed")
    try:
        topic = new_topic()
        frames = Frames(topic, "mono8")
        publisher = Source(topic + "/compressed", CompressedImage)
        publisher.wait_for()
        file = cv2.imencode(".png", smooth())[1]
        publisher.send(CompressedImage(format="png", data=file.tobytes()))
        expected = cv2.cvtColor(smooth(), cv2.COLOR_BGR2GRAY)
        assert np.array_equal(frames.wait()[0].image, expected)
    finally:
        rospy.delete_param("~image_transport")


@pytest.mark.parametrize("node", ["brightness_node", "motion_detector.py"])
def test_nodes_read_the_remapped_topic(start, node):
    topic = new_topic()
    start(node, f"image:={topic}", "_image_transport:=compressed", "__name:=reader")
    out = support.Messages("/reader/processed_image", Image)
    publisher = Source(topic + "/compressed", CompressedImage)
    publisher.wait_for()
    file = cv2.imencode(".jpg", smooth())[1].tobytes()

    def seen():
        publisher.send(CompressedImage(header=HEADER, format="jpeg", data=file))
        return out.received

    assert support.wait_for(seen, "an image")[0].header.stamp == HEADER.stamp


def test_depth_goes_there_and_back(republish):
    source, middle, _ = republish("raw", "compressedDepth")
    _, target, _ = republish("compressedDepth", "raw", middle)
    wire = support.Messages(middle + "/compressedDepth", CompressedImage)
    out = support.Messages(target, Image)
    publisher = Source(source)
    millimetres = np.arange(48 * 64, dtype=np.uint16).reshape(48, 64) * 5
    open_chain(publisher, message(millimetres, "16UC1"), wire, out)

    publisher.send(stamped(message(millimetres, "16UC1")))
    came, back = wire.of(HEADER.stamp), out.of(HEADER.stamp)
    assert came.format == "16UC1; compressedDepth png"
    assert struct.unpack("<i", came.data[:4]) == (0,)
    png = cv2.imdecode(np.frombuffer(came.data[12:], np.uint8), cv2.IMREAD_UNCHANGED)
    within = np.where(millimetres > 10000, 0, millimetres)
    assert np.array_equal(png, within)
    assert np.array_equal(array(back), within)
    assert told(back) == ("16UC1", HEADER.stamp, "eye")

    metres = np.linspace(0.2, 12.0, 48 * 64, dtype=np.float32).reshape(48, 64)
    metres[0, 0] = np.nan
    publisher.send(stamped(message(metres, "32FC1"), 13))
    came, back = wire.of(rospy.Time(13, 34)), out.of(rospy.Time(13, 34))
    assert came.format == "32FC1; compressedDepth png"
    assert struct.unpack("<iff", came.data[:12]) == (0, 10100.0, -1009.0)
    decoded = array(back)
    seen = metres < 10.0
    assert np.array_equal(np.isnan(decoded), ~seen)
    assert np.all(np.abs(decoded[seen] - metres[seen]) <= metres[seen] ** 2 / 10100 * 1.01 + 1e-6)


def test_depth_goes_there_and_back_by_the_other_codec(republish):
    source, middle, _ = republish("raw", "compressedDepth")
    _, target, _ = republish("compressedDepth", "raw", middle)
    wire = support.Messages(middle + "/compressedDepth", CompressedImage)
    out = support.Messages(target, Image)
    publisher = Source(source)
    depth = (np.arange(48 * 64, dtype=np.uint16).reshape(48, 64) * 5) % 9000
    open_chain(publisher, message(depth, "16UC1"), wire, out)
    support.reconfigured(middle + "/compressedDepth", format="rvl")

    publisher.send(stamped(message(depth, "16UC1")))
    came, back = wire.of(HEADER.stamp), out.of(HEADER.stamp)
    assert came.format == "16UC1; compressedDepth rvl"
    assert came.data[12:] == depth_streams.compressed(depth, "rvl").data[12:]
    assert np.array_equal(array(back), depth)

    metres = np.where(depth > 0, depth / 1000.0, np.nan).astype(np.float32)
    publisher.send(stamped(message(metres, "32FC1"), 13))
    came, back = wire.of(rospy.Time(13, 34)), array(out.of(rospy.Time(13, 34)))
    assert came.format == "32FC1; compressedDepth rvl"
    seen = metres > 0.16  # what is nearer has no code
    assert np.isnan(back[np.isnan(metres)]).all()
    assert np.all(np.abs(back - metres)[seen] <= metres[seen] ** 2 / 10100 * 1.01 + 1e-6)


def test_recording_all_topics_of_a_color_camera_logs_no_errors(republish):
    """In usb_cam#55, compressedDepth logged an error for each color frame."""
    source, target, process = republish("raw", "compressedDepth")
    out = support.Messages(target + "/compressedDepth", CompressedImage)
    publisher = Source(source)
    stays_empty = f"{target}/compressedDepth stays empty: bgr8 images hold no depths"

    def is_told():
        publisher.send(message(smooth(), "bgr8"))
        return stays_empty in process.output()

    support.wait_for(is_told, stays_empty)
    is_told()
    open_chain(publisher, message(np.ones((4, 4), np.uint16), "16UC1"), out)
    assert {sent.format for sent in out.received} == {"16UC1; compressedDepth png"}
    assert process.output().count(stays_empty) == 1
    assert "ERROR" not in process.output() and "WARN" not in process.output()


@pytest.mark.parametrize("transport", ["theora", "compressed"])
def test_recording_all_topics_of_depths_logs_no_errors(republish, transport):
    source, target, process = republish("raw", transport)
    _, back, _ = republish(transport, "raw", target)
    out = support.Messages(back, Image)
    publisher = Source(source)
    stays_empty = f"{target}/{transport} stays empty: 32FC1 images hold depths"

    def is_told():
        publisher.send(message(np.ones((48, 64), np.float32), "32FC1"))
        return stays_empty in process.output()

    support.wait_for(is_told, stays_empty)
    open_chain(publisher, message(smooth(), "bgr8"), out)
    assert process.output().count(stays_empty) == 1
    assert "ERROR" not in process.output() and "WARN" not in process.output()


def test_theora_reaches_late_subscribers(republish):
    source, middle, _ = republish("raw", "theora")
    _, early, _ = republish("theora", "raw", middle)
    first = support.Messages(early, Image)
    publisher = Source(source)
    open_chain(publisher, message(smooth(), "bgr8"), first)

    def show(number):
        """Sends an image and returns it when the early subscriber has received it."""
        shown = np.roll(smooth(), number, axis=1)
        image = stamped(message(shown, "bgr8"), number)
        publisher.send(image)
        first.of(image.header.stamp)
        return shown

    for number in range(10, 20):  # frames that differ from the keyframe
        show(number)
    _, late, process = republish("theora", "raw", middle)
    second = support.Messages(late, Image)
    numbers = iter(range(20, 10000))
    support.wait_for(lambda: show(next(numbers)) is not None and second.received, "images")
    number = next(numbers)
    shown = show(number)
    image = second.of(rospy.Time(number, HEADER.stamp.nsecs))
    assert (image.encoding, image.header.frame_id) == ("bgr8", "eye")
    assert np.abs(array(image).astype(float) - shown).mean() < 8
    assert "ERROR" not in process.output()


STUB = """
cmake_minimum_required(VERSION 3.16)
project(robot_vision LANGUAGES CXX)
file(WRITE ${CMAKE_BINARY_DIR}/empty.cpp "")
add_library(robot_vision_ros ${CMAKE_BINARY_DIR}/empty.cpp)
target_precompile_headers(robot_vision_ros PRIVATE <string>)
function(enable_warnings target)
endfunction()
set(CATKIN_PACKAGE_LIB_DESTINATION lib)
set(CATKIN_PACKAGE_SHARE_DESTINATION share)
add_subdirectory(transports)
if(TARGET robot_vision_transports)
  message(STATUS "built")
endif()
"""


@pytest.mark.parametrize(
    "there, ours",
    [
        ([], ["compressed", "compressedDepth", "shm", "theora"]),
        (["compressed"], ["compressedDepth", "shm", "theora"]),
        (["compressed", "compressed_depth", "theora"], ["shm"]),  # which nobody else has
    ],
)
def test_our_plugins_give_way_to_the_standard_ones(start, tmp_path, there, ours):
    plugins = ROOT / "src" / "ros" / "transports" / "plugins"
    shutil.copytree(str(plugins), str(tmp_path / "transports"))
    (tmp_path / "CMakeLists.txt").write_text(STUB)
    (tmp_path / "package.xml").write_text((ROOT / "package.xml").read_text())
    options = []
    for name in ("compressed", "compressed_depth", "theora"):
        package = f"{name}_image_transport"
        if name in there:
            (tmp_path / package).mkdir()
            (tmp_path / package / f"{package}Config.cmake").write_text("")
            options.append(f"-D{package}_DIR={tmp_path / package}")
        else:
            options.append(f"-DCMAKE_DISABLE_FIND_PACKAGE_{package}=ON")
    command = ["cmake", "-S", str(tmp_path), "-B", str(tmp_path / "build"), *options]
    output = subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True).stdout
    assert ("-- built" in output) == bool(ours)
    for name in there:
        assert f"{name}_image_transport is there: its plugins are used, not ours" in output
    listed = (tmp_path / "transport_plugins.xml").read_text()
    names = re.findall(r'"image_transport/(\w+)"', listed)
    assert names == [f"{name}_{end}" for name in ours for end in ("pub", "sub")]

    # A list of one transport is not an error for those who read it.
    if len(ours) == 1:
        source, target = new_topic(), new_topic()
        path = f"{tmp_path}:/usr/share:/opt/ros/noetic/share"
        arguments = ["raw", f"in:={source}", f"out:={target}"]
        process = start(REPUBLISH, *arguments, env={"ROS_PACKAGE_PATH": path})
        Source(source).wait_for()
        topics = [t for t, _ in rospy.get_published_topics() if t.startswith(target)]
        assert sorted(topics) == [target, f"{target}/shm"]
        assert "ERROR" not in process.output()
