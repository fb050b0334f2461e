"""Depth images over compressedDepth and through bags, from the camera to what is made of them."""

import time

import depth_streams
import numpy as np
import pytest
import rospy
import support
from frames import Source, pixels
from geometry_msgs.msg import TransformStamped, Vector3
from rgbd_cameras import RgbdCameras, depth_to_color, info_of, model_of
from ros_programs import program_of
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

import robot_vision as rv
from robot_vision.recordings.depth_images import depths_of_bag
from robot_vision.transport import ImageSubscriber

SIZE = "_image_width:=96", "_image_height:=72", "_framerate:=10"
FRAMES = 30  # that are recorded


def step_of(metres):
    """What one step of the code of 32FC1 is at these depths, m."""
    return metres**2 / (depth_streams.QUANTIZATION * (depth_streams.QUANTIZATION + 1.0))


def start_camera(start, name, *arguments):
    frames = f"_camera_name:={name}", f"_camera_frame_id:={name}_rgb_optical_frame"
    words = "_source:=synthetic", "_views:=rgbd", "_depth_noise:=kinect", *SIZE, *frames
    return start("camera_node", f"__name:={name}", *words, *arguments)


def start_registration(start, camera, transport):
    """A node on this transport; gives the topic of its images."""
    name = f"{camera}_{transport}"
    target = f"/{name}/depth_registered/image_raw"
    words = f"_depth_image_transport:={transport}", f"depth_registered/image_raw:={target}"
    start("depth_registration_node", f"__ns:=/{camera}", f"__name:={name}", *words)
    return target


def same(a, b):
    return (
        a.dtype == b.dtype
        and np.array_equal(np.isnan(a), np.isnan(b))
        and np.array_equal(np.nan_to_num(a), np.nan_to_num(b))
    )


@pytest.mark.parametrize("codec", ["png", "rvl"])
@pytest.mark.parametrize("encoding", ["16UC1", "32FC1"])
def test_the_camera_s_depths_arrive_as_they_are_raw(start, encoding, codec):
    name = f"eye_{encoding}_{codec}".lower()
    topic = f"/{name}/depth/image_raw"
    rospy.set_param(f"{topic}/compressedDepth/format", codec)
    start_camera(start, name, f"_depth_encoding:={encoding}")
    raw = support.Messages(topic, Image)
    wire = support.Messages(f"{topic}/compressedDepth", CompressedImage)
    received = []
    subscriber = ImageSubscriber(topic, received.append, transport="compressedDepth")

    def on_all():
        stamps = [{support.stamp_of(m) for m in one} for one in (raw.received, wire.received)]
        return [frame for frame in received if all(frame.header.stamp in s for s in stamps)]

    frame = support.wait_for(on_all, "a frame over both transports")[-1]
    subscriber.unregister()
    sent, coded = raw.of(frame.header.stamp), wire.of(frame.header.stamp)
    assert coded.format == f"{encoding}; compressedDepth {codec}"
    assert frame.header.frame_id == sent.header.frame_id == f"{name}_depth_optical_frame"
    depth, found = pixels(sent), frame.image
    assert (frame.encoding, found.shape, found.dtype) == (encoding, depth.shape, depth.dtype)
    if encoding == "16UC1":
        assert np.array_equal(found, depth)
        seen = depth > 0
    else:
        seen = np.isfinite(depth)
        assert np.array_equal(np.isfinite(found), seen)
        assert np.isnan(found[~seen]).all()
        assert (np.abs(found - depth)[seen] <= 1.01 * step_of(depth[seen])).all()
    assert 0.3 < seen.mean() < 1.0  # of a Kinect, which has holes
    assert same(rv.decompress_depth(coded.format, coded.data), found)


@pytest.mark.parametrize("codec", ["png", "rvl"])
def test_registered_depths_are_the_same_over_both_transports(start, codec):
    name = f"rig_{codec}"
    rospy.set_param(f"/{name}/depth/image_raw/compressedDepth/format", codec)
    start_camera(start, name)
    targets = [start_registration(start, name, way) for way in ("raw", "compressedDepth")]
    raw, compressed = support.same_frame(*(support.Messages(one, Image) for one in targets))
    assert raw.encoding == compressed.encoding == "16UC1"
    assert raw.data == compressed.data
    assert raw.header.frame_id == compressed.header.frame_id == f"{name}_rgb_optical_frame"
    assert (pixels(raw) > 0).mean() > 0.3


@pytest.mark.parametrize("codec", ["png", "rvl"])
@pytest.mark.parametrize("kind", [np.uint16, np.float32])
def test_what_the_standard_transport_sends_is_registered(start, kind, codec):
    metres = np.full((48, 64), 2.0, np.float32)
    metres[10:30, 20:40] = 1.2
    metres[5, 5] = np.nan
    depth = metres if kind is np.float32 else (1000 * np.nan_to_num(metres)).astype(np.uint16)
    cameras = RgbdCameras()
    words = *cameras.arguments(), "_depth_image_transport:=compressedDepth"
    start("depth_registration_node", "__name:=registration", *words)
    answers = support.subscribed(cameras.output("image_raw"), Image)
    cameras.place()
    source = Source(cameras.topic("depth", "image_raw") + "/compressedDepth", CompressedImage)
    for one in (source, *cameras.infos.values()):
        one.wait_for()
    sent = depth_streams.compressed(depth, codec)

    def answered():
        cameras.send_infos()
        sent.header = Header(stamp=cameras.next_stamp(), frame_id=cameras.frames["depth"])
        source.send(sent)
        return answers.received

    answer = support.wait_for(answered, "an answer")[-1]
    coded = depth_streams.compressed(depth, "png")  # the codec makes no difference
    told = depth_streams.decompressed(coded)
    models = [model_of(info_of(camera)) for camera in ("depth", "rgb")]
    expected = rv.DepthRegistration(*models, depth_to_color()).apply(told)
    assert expected.dtype == kind
    assert same(pixels(answer), expected)


def recorded(start, camera, path):
    """Has rosbag record some frames, and ends the camera."""
    names = "depth/image_raw", "depth/image_raw/compressedDepth", "depth/camera_info"
    topics = [f"/{camera}/{name}" for name in (*names, "rgb/camera_info")]
    node = start_camera(start, camera)
    words = f"--output-name={path}", f"--limit={FRAMES}", *topics
    process = start(program_of("rosbag", "record"), *words)
    assert process.exit_code() == 0, process.output()
    node.interrupt()
    assert node.exit_code() == 0, node.output()
    return topics


def place(parent, child):
    """Says where the depth camera of the scene is, as the camera node did."""
    transform = TransformStamped(header=Header(frame_id=parent), child_frame_id=child)
    x, y, z = rv.Scene().view_pose("depth")[:3, 3]
    transform.transform.translation = Vector3(x, y, z)
    transform.transform.rotation.w = 1.0
    publisher = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
    publisher.publish(TFMessage([transform]))
    return publisher


def test_a_bag_gives_the_depths_that_were_recorded(start, tmp_path):
    path, camera = tmp_path / "depths.bag", "taped"
    raw, compressed, *infos = recorded(start, camera, path)
    found = {topic: list(depths_of_bag(str(path), topic)) for topic in (raw, compressed)}
    assert [len(frames) for frames in found.values()] == [FRAMES, FRAMES]
    depths = {
        topic: {header.stamp: depth for header, depth in frames} for topic, frames in found.items()
    }
    common = depths[raw].keys() & depths[compressed].keys()
    assert common
    for stamp in common:
        assert np.array_equal(depths[raw][stamp], depths[compressed][stamp])

    publisher = place(*(f"{camera}_{view}_optical_frame" for view in ("rgb", "depth")))
    calibrations = [support.Messages(topic, CameraInfo) for topic in infos]
    targets = [start_registration(start, camera, way) for way in ("raw", "compressedDepth")]
    answers = [support.subscribed(topic, Image) for topic in targets]
    play_until(start, path, lambda: all(one.received for one in (*answers, *calibrations)))
    own, color = (model_of(one.wait()[0]) for one in calibrations)
    registration = rv.DepthRegistration(own, color, rv.Scene().view_pose("depth"))
    for topic, messages in zip((raw, compressed), answers):
        for message in messages.received:
            expected = registration.apply(depths[topic][message.header.stamp])
            assert np.array_equal(pixels(message), expected)
    publisher.unregister()


def play_until(start, path, done):
    """Plays a bag, again and again until something has happened."""
    deadline = time.monotonic() + support.DEADLINE
    while not done():
        assert time.monotonic() < deadline, "nothing has come of the bag"
        process = start(program_of("rosbag", "play"), "--quiet", "--wait-for-subscribers", path)
        assert process.exit_code() == 0, process.output()
