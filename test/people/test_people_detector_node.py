"""The node people_detector: what it publishes, and its live parameters."""

import numpy as np
import pytest
import support
from figures import street
from frames import Camera
from sensor_msgs.msg import Image

from robot_vision import PeopleDetector, draw_outline
from robot_vision.msg import DetectionArray
from robot_vision.ros.messages import corners

IMAGE = street((240, 200), [(70, 20, 80, 160)])


def test_people_and_overlay_of_a_frame(start):
    camera = Camera(30.0)
    start("people_detector.py", "__name:=people_detector", f"image:={camera.topic}")
    people = support.Messages("/people_detector/people", DetectionArray)
    overlays = support.Messages("/people_detector/processed_image", Image)
    camera.wait_for()
    for messages in (people, overlays):
        support.wait_for(messages.connected, "the node's topics")
    header = camera.show(IMAGE)
    (expected,) = PeopleDetector().detect(IMAGE)
    message = people.of(header.stamp)
    assert (message.header.frame_id, message.width, message.height) == ("eye", 240, 200)
    (found,) = message.detections
    x, y, width, height = expected.box
    box = found.box
    assert (box.x_offset, box.y_offset, box.width, box.height) == (x, y, width, height)
    assert (found.label, found.id, found.area) == ("person", -1, width * height)
    assert found.score == pytest.approx(expected.score) and found.score > 0.7
    assert (found.center.x, found.center.y) == (x + (width - 1) / 2, y + (height - 1) / 2)
    outline = [(point.x, point.y) for point in found.outline]
    assert outline == [tuple(corner) for corner in corners(expected.box).tolist()]
    assert not found.predicted and not found.has_velocity
    overlay = overlays.of(header.stamp)
    assert (overlay.header.frame_id, overlay.encoding) == ("eye", "bgr8")
    drawn = IMAGE.copy()
    draw_outline(drawn, corners(expected.box), f"{expected.score:.2f}")
    assert np.array_equal(np.frombuffer(overlay.data, np.uint8).reshape(IMAGE.shape), drawn)

    config = support.reconfigured("/people_detector", hit_threshold=9.0)
    assert config["hit_threshold"] == 9.0
    assert not people.of(camera.show(IMAGE).stamp).detections
    config = support.reconfigured("/people_detector", hit_threshold=0.0, model="cat")
    assert (config["hit_threshold"], config["model"]) == (9.0, "default")  # both are refused


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("model", "cat", "model is cat, must be default or daimler"),
        ("win_stride", 2, "win_stride is 2, must be from 4 to 64"),
        ("scale", "much", "scale is 'much', must be a number"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "people_detector.py", name, value, text)
