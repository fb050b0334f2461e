"""What object_detector does with a frame, by a network that takes the place of another."""

from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest
from std_msgs.msg import Header
from still_clock import StillClock

from robot_vision.dnn.object_detector import ObjectDetector
from robot_vision.msg import DetectionArray
from robot_vision.ros import frame_calls
from robot_vision.ros.frame_calls import FrameCalls
from robot_vision.ros.transport import Frame

FRAME = Frame(np.zeros((8, 8, 3), np.uint8), "bgr8", Header())


@pytest.fixture
def clock(monkeypatch):
    clock = StillClock()
    monkeypatch.setattr(frame_calls, "time", clock)
    return clock


@pytest.fixture
def detector():
    """One without parameters and a network, for which nobody but calls wait."""
    detector = object.__new__(ObjectDetector)
    detector._calls = FrameCalls(SimpleNamespace())
    detector._report = SimpleNamespace(running=nullcontext, add_run=lambda seconds: None)
    detector._found = SimpleNamespace(wanted=False)
    return detector


def test_a_call_is_late_by_the_time_in_which_the_network_does_not_run(clock, detector):
    call = frame_calls._Call(clock.now, 0.0, None)

    def find(_image):
        clock.now += 100.0
        return []

    detector._find = find
    assert detector._look(FRAME) == []
    assert detector._calls._waited(call) == 0.0
    clock.now += 3.0
    assert detector._calls._waited(call) == 3.0


@pytest.mark.parametrize("wanted", [True, False])
def test_the_message_of_a_frame_is_made_once_if_somebody_wants_it(detector, wanted):
    made, published = [], []
    detector._find = lambda _image: []
    detector._array = lambda frame, _found: made.append(frame) or DetectionArray()
    detector._found = SimpleNamespace(wanted=wanted, publish=published.append)
    found, array = detector._looked(FRAME)
    assert (found, made) == ([], [FRAME] * wanted)
    message = array()
    assert array() is message and made == [FRAME]
    assert published == [message] * wanted
