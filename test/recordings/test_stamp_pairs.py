"""Images of two cameras that belong together, by their stamps."""

import pytest
import rospy

from robot_vision.recordings.stamp_pairs import StampPairs

LEFT, RIGHT = TOPICS = ("/left/image", "/right/image")


def stamp(seconds):
    return rospy.Time.from_sec(seconds)


def test_stamps_meet_whichever_comes_first_and_the_nearest_does():
    pairs = StampPairs(TOPICS)
    assert pairs.add(0, stamp(1), "a") is None and pairs.add(0, stamp(2), "b") is None
    assert pairs.add(1, stamp(2), "B") == ("b", "B")
    assert pairs.add(1, stamp(1), "A") is None  # what is older is gone
    assert pairs.add(1, stamp(3), "C") is None
    assert pairs.add(0, stamp(3), "c") == ("c", "C") and pairs.found == 2
    near = StampPairs(TOPICS, 0.03)
    for seconds, name in ((0.98, "far"), (1.01, "near"), (1.1, "later")):
        near.add(1, stamp(seconds), name)
    assert near.add(0, stamp(1.0), "left") == ("left", "near")
    assert near.add(0, stamp(1.06), "left") is None


@pytest.mark.parametrize("lost", ["left 0", "left 4", "right 4"])
def test_a_lost_image_puts_no_later_pairs_off(lost):
    pairs = StampPairs(TOPICS, 0.02)  # more than the period of the cameras
    found = []
    for number in range(8):
        for side, name in enumerate(("left", "right")):
            if f"{name} {number}" != lost:
                found.append(pairs.add(side, stamp(1.0 + number / 60.0), number))
    assert [pair for pair in found if pair][-3:] == [(5, 5), (6, 6), (7, 7)]


def test_why_there_are_no_pairs_is_told():
    pairs = StampPairs(TOPICS)
    assert pairs.problem() == f"no image comes on {LEFT}"
    pairs.add(0, stamp(1.5), "a")
    assert pairs.problem() == f"no image comes on {RIGHT}"
    pairs.add(1, stamp(1.25), "b")
    newest = "the newest are 1.500000 s and 1.250000 s, must be "
    text = f"the stamps on {LEFT} and {RIGHT} do not meet: {newest}"
    assert pairs.problem() == text + "equal; --slop allows cameras that are not in step"
    wide = StampPairs(TOPICS, 0.1)
    wide.add(0, stamp(1.5), "a")
    wide.add(1, stamp(1.25), "b")
    assert wide.problem() == text + "at most --slop, 0.1 s, and half of a camera's period apart"
    unset = StampPairs(TOPICS)
    unset.add(0, stamp(0), "a")
    assert unset.add(1, stamp(0), "b") is None
    assert unset.problem() == f"the images on {LEFT} have no stamps"
