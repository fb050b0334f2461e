"""The form in which images of a topic are recorded, by what they hold."""

import pytest

from robot_vision.dashboard.bag_images import recorded_topic

COMPRESSED = "sensor_msgs/CompressedImage"


def published(topic, kind=COMPRESSED):
    return {f"{topic}/{form}": kind for form in ("compressed", "compressedDepth")}


@pytest.mark.parametrize(
    "topic, encoding, form",
    [
        ("/eye/image_raw", "bgr8", "/compressed"),
        ("/eye/image_raw", "yuv422", "/compressed"),
        ("/stereo_matcher/disparity_image", "bgr8", "/compressed"),
        ("/depth_camera/rgb/image_raw", "rgb8", "/compressed"),
        ("/eye/depth/image_raw", "16UC1", "/compressedDepth"),
        ("/stereo_matcher/depth", "32FC1", "/compressedDepth"),
        ("/segmenter/labels", "mono16", ""),  # JPEG would have 8 bits of them
        ("/thermal/image_raw", "16UC1", ""),  # compressedDepth loses all above 10 m
        ("/depth_camera/thermal/image_raw", "16UC1", ""),
        ("/stereo/disparity", "32FC1", ""),
        ("/dense_flow/flow", "32FC2", ""),
        ("/eye/image_raw", "bayer_rggb8", ""),  # JPEG would mix its colours
        ("/eye/image_raw", "", ""),
    ],
)
def test_images_are_recorded_in_the_smallest_form_that_keeps_them(topic, encoding, form):
    assert recorded_topic(topic, encoding, published(topic)) == topic + form


@pytest.mark.parametrize("published", [{}, published("/eye/image_raw", "std_msgs/String")])
def test_images_without_transports_are_recorded_as_they_are(published):
    assert recorded_topic("/eye/image_raw", "bgr8", published) == "/eye/image_raw"
