"""What Python nodes refuse of depth images, and what they tell of odd ones."""

from types import SimpleNamespace

import numpy as np
import pytest
from std_msgs.msg import Header

from robot_vision.common import throttle
from robot_vision.ros.depth_frames import FRAMES_PER_LOOK, DepthLook
from robot_vision.ros.transport import Frame, FrameError

METRES = np.full((6, 8), 2.0, np.float32)
MILLIMETRES = np.full((6, 8), 2000, np.uint16)


def frame(depth, encoding):
    return Frame(depth, encoding, Header())


def test_good_depths_pass_without_a_word(log):
    look = DepthLook("/depth")
    for depth, encoding in ((METRES, "32FC1"), (MILLIMETRES, "16UC1"), (MILLIMETRES, "mono16")):
        look.check(frame(depth, encoding))
    assert "/depth" not in log()


@pytest.mark.parametrize("encoding", ["bgr8", "mono8", "", "64FC1", "\x1b[2J"])
def test_images_of_another_encoding_are_refused(encoding):
    with pytest.raises(FrameError, match=r"must be 16UC1 \(mm\) or 32FC1 \(m\)") as refused:
        DepthLook("/depth").check(frame(MILLIMETRES, encoding))
    assert str(refused.value).isprintable()


@pytest.mark.parametrize(
    "depth, encoding, said",
    [
        (0 * MILLIMETRES, "16UC1", "none of the 8x6 pixels has a depth"),
        (np.full_like(METRES, np.nan), "32FC1", "none of the 8x6 pixels has a depth"),
        (1000.0 * METRES, "32FC1", "the median depth is 2000 m by the encoding 32FC1"),
        (MILLIMETRES // 1000, "16UC1", "the median depth is 2 mm by the encoding 16UC1"),
    ],
)
def test_odd_depths_are_told_with_their_topic_and_not_with_each_frame(
    monkeypatch, log, depth, encoding, said
):
    monkeypatch.setattr(throttle, "time", SimpleNamespace(monotonic=lambda: 7.0))
    look = DepthLook("/depth")
    for _ in range(2 * FRAMES_PER_LOOK):
        look.check(frame(depth, encoding))
    told = log()
    assert f"/depth: {said}" in told
    assert told.count("/depth: ") == 1


def test_depths_that_become_odd_are_told_soon(log):
    look = DepthLook("/depth")
    look.check(frame(METRES, "32FC1"))
    for _ in range(FRAMES_PER_LOOK):
        look.check(frame(0 * METRES, "32FC1"))
    assert log().count("/depth: none of the 8x6 pixels has a depth") == 1
