"""The node skeleton: what it publishes, and its live parameters."""

import dynamic_reconfigure.client
import numpy as np
import pytest
import rospy
import support
from frames import Source, message, new_topic
from sensor_msgs.msg import Image
from std_msgs.msg import Float64

IMAGE = np.zeros((120, 160, 3), np.uint8)
IMAGE[90:] = 200


def test_share_and_overlay_of_a_frame(start):
    topic = new_topic()
    source = Source(topic)
    start("skeleton.py", "__name:=skeleton", f"image:={topic}")
    shares = support.Messages("/skeleton/share", Float64)
    overlays = support.Messages("/skeleton/processed_image", Image)
    source.wait_for()
    for messages in (shares, overlays):
        support.wait_for(messages.connected, "the node's topics")
    sent = message(IMAGE, "bgr8")
    sent.header.stamp = rospy.Time(10)
    sent.header.frame_id = "eye"
    source.send(sent)
    overlay = overlays.of(sent.header.stamp)
    assert shares.wait()[0].data == 0.25
    assert (overlay.header.frame_id, overlay.encoding) == ("eye", "bgr8")
    pixels = np.frombuffer(overlay.data, np.uint8).reshape(IMAGE.shape)
    assert (pixels != IMAGE).any() and np.array_equal(pixels[40:], IMAGE[40:])
    client = dynamic_reconfigure.client.Client("/skeleton", timeout=support.DEADLINE)
    assert client.update_configuration({"threshold": 250.0})["threshold"] == 250.0
    client.close()
    source.send(sent)
    assert shares.wait(2)[1].data == 0.0


@pytest.mark.parametrize("name, value, text", [("threshold", 256, "must be from 0 to 255")])
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "skeleton.py", name, value, text)
