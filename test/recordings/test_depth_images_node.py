"""Recorded depth images: raw and compressed by both codecs, from messages and from bags."""

import depth_streams
import numpy as np
import pytest
import rosbag
import rospy
from frames import message
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Header

from robot_vision.recordings.depth_images import depth_pixels, depths_of_bag

MILLIMETRES = (np.arange(48 * 64, dtype=np.uint16).reshape(48, 64) * 5) % 9000
MILLIMETRES[5:9, 7:20] = 0
METRES = np.linspace(0.2, 9.9, 48 * 64, dtype=np.float32).reshape(48, 64)
METRES[5:9, 7:20] = np.nan
STEP = METRES**2 / (depth_streams.QUANTIZATION * (depth_streams.QUANTIZATION + 1.0))  # of a code, m


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("encoding", ["16UC1", "mono16", "32FC1"])
def test_raw_depths_are_as_they_were(encoding, order):
    sent = METRES if encoding == "32FC1" else MILLIMETRES
    found = depth_pixels(message(sent, encoding, padding=4, order=order))
    assert found.dtype == sent.dtype
    np.testing.assert_array_equal(found, sent)


@pytest.mark.parametrize("codec", ["png", "rvl"])
def test_compressed_depths_are_those_that_were_sent(codec):
    found = depth_pixels(depth_streams.compressed(MILLIMETRES, codec))
    assert found.dtype == np.uint16 and np.array_equal(found, MILLIMETRES)
    found = depth_pixels(depth_streams.compressed(METRES, codec))
    assert found.dtype == np.float32
    assert np.array_equal(np.isnan(found), np.isnan(METRES))
    assert np.nanmax(np.abs(found - METRES) / STEP) < 1.01


@pytest.mark.parametrize(
    "bad, said",
    [
        (message(np.zeros((4, 6, 3), np.uint8), "bgr8"), "a depth image is 'bgr8', must be 16UC1"),
        (CompressedImage(format="jpeg", data=b"\xff\xd8"), "format is 'jpeg', must be 16UC1"),
        (CompressedImage(format="16UC1; compressedDepth rvl", data=bytes(20)), "has no pixels"),
    ],
)
def test_what_has_no_depths_is_refused(bad, said):
    with pytest.raises(ValueError, match=said):
        depth_pixels(bad)


def test_a_bag_gives_headers_and_depths(tmp_path):
    path, topics = str(tmp_path / "depths.bag"), ("/raw", "/raw/compressedDepth")
    with rosbag.Bag(path, "w") as bag:
        for number in (1, 2):
            depth = MILLIMETRES + np.uint16(number) * (MILLIMETRES > 0)
            sent = message(depth, "16UC1"), depth_streams.compressed(depth, "png")
            for topic, one in zip(topics, sent):
                one.header = Header(stamp=rospy.Time(number, 5), frame_id="eye")
                bag.write(topic, one, one.header.stamp)
    for topic in topics:
        found = list(depths_of_bag(path, topic))
        assert [header.stamp for header, _ in found] == [rospy.Time(1, 5), rospy.Time(2, 5)]
        for number, (header, depth) in enumerate(found, 1):
            assert header.frame_id == "eye"
            assert np.array_equal(depth, MILLIMETRES + number * (MILLIMETRES > 0))
    with pytest.raises(ValueError, match=r"no images on '/other', but on /raw, /raw/compressed"):
        list(depths_of_bag(path, "/other"))


def test_a_damaged_image_of_a_bag_is_named(tmp_path):
    path = str(tmp_path / "depths.bag")
    good = depth_streams.compressed(MILLIMETRES, "rvl")
    bad = CompressedImage(format=good.format, data=good.data[:-20])
    with rosbag.Bag(path, "w") as bag:
        for second, sent in enumerate((good, bad), 1):
            bag.write("/depths", sent, rospy.Time(second))
    found = depths_of_bag(path, "/depths")
    assert np.array_equal(next(found)[1], MILLIMETRES)
    with pytest.raises(ValueError, match=r"depths\.bag: image 1 on /depths: RVL of \d+ bytes is"):
        next(found)
