"""FramePairs: what is said of messages that come after their frame was dropped."""

import numpy as np
import pytest
import rospy
from std_msgs.msg import Header

from robot_vision.msg import DetectionArray
from robot_vision.ros.frame_pairs import FramePairs
from robot_vision.ros.transport import Frame

RATE = 30.0  # Hz
LARGE = np.zeros((1080, 1920), np.float32)  # 16 of them are kept
SMALL = np.zeros((4, 4), np.float32)


def header(seconds):
    return Header(stamp=rospy.Time.from_sec(1000.0 + seconds))


def shown(image, late, frames=120):
    """Pairs after a detector that looks at each third frame, and is this late (s); their number."""
    pairs, met = FramePairs(slop=0.02), 0
    for number in range(frames):
        now = number / RATE
        met += pairs.message_of(Frame(image, "32FC1", header(now))) is not None
        if now >= late and number % 3 == 0:
            met += pairs.frame_of(DetectionArray(header=header(now - late))) is not None
    return pairs, met


@pytest.mark.parametrize("image, late", [(LARGE, 0.4), (SMALL, 1.9)])
def test_messages_within_the_limits_have_their_frames(image, late):
    pairs, met = shown(image, late)
    assert met >= 20 and not pairs.apart() and pairs.lateness() == ""


@pytest.mark.parametrize("image, late, kept", [(LARGE, 0.6, "0.5"), (SMALL, 2.2, "2")])
def test_messages_whose_frames_were_dropped_are_late(image, late, kept):
    pairs, met = shown(image, late)
    assert met == 0 and pairs.apart()
    # The last message came two frames before the newest one.
    assert pairs.lateness() == (
        f"the last is {late + 2 / RATE:.3g} s older than the newest image, and only the images of "
        f"{kept} s are kept"
    )


@pytest.mark.parametrize("seconds", [-500.0, 0.51 / RATE, 500.0])
def test_messages_of_other_stamps_are_not_late(seconds):
    """They are of another clock, from before the first frame, or between two of them."""
    pairs = FramePairs()
    for number in range(120):
        pairs.message_of(Frame(SMALL, "32FC1", header(number / RATE)))
        pairs.frame_of(DetectionArray(header=header(number / RATE + seconds)))
    assert pairs.apart() and pairs.lateness() == ""


def test_nothing_is_late_after_the_stamps_went_back():
    pairs, _ = shown(SMALL, 2.2)
    pairs.message_of(Frame(SMALL, "32FC1", header(0.0)))
    assert pairs.frame_of(DetectionArray(header=header(0.5))) is None
    assert pairs.lateness() == ""


def test_frames_from_before_the_stamps_went_back_are_dropped():
    pairs = FramePairs()
    for seconds in (0.0, 1.0, 1.4, 0.5):
        assert pairs.message_of(Frame(SMALL, "32FC1", header(seconds))) is None
    assert pairs.frame_of(DetectionArray(header=header(1.0))) is None
    assert pairs.frame_of(DetectionArray(header=header(0.5))) is not None


def test_pairs_without_frames_say_nothing():
    pairs, _ = shown(SMALL, 2.2)
    pairs.clear()
    pairs.frame_of(DetectionArray(header=header(0.5)))
    assert pairs.lateness() == "" and not pairs.apart()
