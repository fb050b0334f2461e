"""The node motion_detector: what it publishes, and when it is occupied."""

import itertools

import dynamic_reconfigure.client
import numpy as np
import pytest
import rospy
import support
from frames import Source, message, new_topic
from sensor_msgs.msg import Image
from std_srvs.srv import Trigger

from robot_vision import draw_text
from robot_vision.msg import DetectionArray, MotionState

EMPTY = np.full((240, 320, 3), 60, np.uint8)
BOX = (100, 80, 60, 50)  # x, y, width, height


def with_box():
    x, y, width, height = BOX
    full = EMPTY.copy()
    full[y : y + height, x : x + width] = 220
    return full


class Room:
    """A camera at 10 Hz of its own time, and what the node says of its frames."""

    def __init__(self, start, *arguments):
        topic = new_topic()
        self._source = Source(topic)
        self._numbers = itertools.count(1)
        self.process = start("motion_detector.py", "__name:=motion", f"image:={topic}", *arguments)
        self.listen()

    def listen(self):
        """Subscribes to what the node publishes, and waits until it takes frames."""
        self.motion = support.Messages("/motion/motion", DetectionArray)
        self.states = support.Messages("/motion/state", MotionState)
        self.overlays = support.Messages("/motion/processed_image", Image)
        self._source.wait_for()
        for messages in (self.motion, self.states, self.overlays):
            support.wait_for(messages.connected, "the node's topics")

    def leave(self):
        """Ends all subscriptions, and waits until the node takes no frames."""
        for messages in (self.motion, self.states, self.overlays):
            messages.close()
        self._source.wait_for(0)

    def show(self, image, frames=1):
        """Shows an image; the last frame's detections, state and overlay."""
        for _ in range(frames):
            sent = message(image, "bgr8")
            sent.header.stamp = rospy.Time.from_sec(next(self._numbers) / 10.0)
            sent.header.frame_id = "eye"
            self._source.send(sent)
            topics = (self.motion, self.states, self.overlays)
            answers = [topic.of(sent.header.stamp) for topic in topics]
            assert all(answer.header.frame_id == "eye" for answer in answers)
        return answers


def test_the_room_is_occupied_and_unoccupied_again(start):
    room = Room(start, "_hold:=0.5")
    motion, state, _ = room.show(EMPTY, 2)
    assert not motion.detections and not state.occupied and state.changed == 0.0
    motion, state, overlay = room.show(with_box())
    assert (motion.width, motion.height) == (320, 240)
    (found,) = motion.detections
    assert found.label == "motion"
    assert found.box.x_offset == pytest.approx(BOX[0], abs=8)
    assert found.box.y_offset == pytest.approx(BOX[1], abs=8)
    assert found.box.x_offset + found.box.width == pytest.approx(BOX[0] + BOX[2], abs=8)
    assert found.box.y_offset + found.box.height == pytest.approx(BOX[1] + BOX[3], abs=8)
    assert state.occupied and not state.everywhere
    assert state.changed == pytest.approx(60 * 50 / (320 * 240), rel=0.5)
    pixels = np.frombuffer(overlay.data, np.uint8).reshape(240, 320, 3)
    green = (pixels == (0, 255, 0)).all(axis=2)
    assert green[found.box.y_offset, found.box.x_offset + 5]
    drawn = (pixels != 60).any(axis=2)
    assert drawn[:25, :120].any() and drawn[225:].any()  # state and time
    motion, state, _ = room.show(EMPTY, 4)
    assert not motion.detections and state.occupied  # held for half a second
    _, state, _ = room.show(EMPTY, 3)
    assert not state.occupied


def test_background_can_be_taken_anew(start):
    room = Room(start)
    room.show(EMPTY)
    motion, _, _ = room.show(with_box(), 3)
    assert len(motion.detections) == 1
    assert rospy.ServiceProxy("/motion/reset_background", Trigger)().success
    motion, _, _ = room.show(with_box(), 2)
    assert not motion.detections
    motion, _, _ = room.show(EMPTY)
    assert len(motion.detections) == 1


@pytest.mark.parametrize(
    "method, moved",
    [("first_frame", 1), ("previous_frame", 0), ("running_average", 0), ("mog2", 0)],
)
def test_what_changed_while_nobody_subscribed_is_motion_only_against_the_first_frame(
    start, method, moved
):
    room = Room(start, f"_method:={method}")
    room.show(EMPTY, 2)
    room.leave()
    room.listen()
    motion, state, _ = room.show(with_box())
    assert len(motion.detections) == moved and state.occupied == bool(moved)


def test_light_is_reported_as_such(start):
    room = Room(start, "_settle:=0.5")
    room.show(EMPTY)
    motion, state, overlay = room.show(EMPTY + 100)
    assert state.everywhere and not state.occupied and not motion.detections
    said = EMPTY + 100
    draw_text(said, "whole image changes", (10, 20))
    assert np.array_equal(np.frombuffer(overlay.data, np.uint8).reshape(said.shape)[:40], said[:40])
    room.process.wait_for_output("the whole image changes")
    _, state, _ = room.show(EMPTY + 100, 7)
    assert not state.everywhere and state.changed == 0.0


def test_parameters_are_changed_live_before_the_same_background(start):
    room = Room(start)
    client = dynamic_reconfigure.client.Client("/motion", timeout=support.DEADLINE)
    room.show(EMPTY)
    assert len(room.show(with_box())[0].detections) == 1
    client.update_configuration({"threshold": 40.0, "blur_size": 15})
    assert len(room.show(with_box())[0].detections) == 1  # still before the first frame
    client.update_configuration({"method": "previous_frame"})
    room.show(EMPTY)  # the background of another method
    assert len(room.show(with_box())[0].detections) == 1
    assert not room.show(with_box())[0].detections
    config = client.update_configuration({"method": "magic", "blur_size": 20})
    assert (config["method"], config["blur_size"]) == ("previous_frame", 15)
    room.process.wait_for_output("refused, the parameters stay as they are: ")
    client.close()


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("method", "magic", "method is magic, must be first_frame, previous_frame"),
        ("blur_size", 20, "blur_size is 20, must be odd and from 1 to 99"),
        ("minArea", -1, "minArea is -1, must be from 0 to 1e+07"),
        ("hold", "long", "hold is 'long', must be a number"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "motion_detector.py", name, value, text)
