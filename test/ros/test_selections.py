"""Regions that wait for a frame: which, how long, and how they keep a node working."""

import math
import threading
import time

import pytest
import rospy
from sensor_msgs.msg import RegionOfInterest

from robot_vision.ros.selections import SELECT_TIMEOUT, Selection, Selections

BOX = (1, 2, 30, 40)
DEADLINE = 20.0  # s


class Node:
    """What selections need of an ImageNode."""

    topic = "/eye/image"

    def __init__(self):
        self.working = []

    def keep_working(self, wanted):
        self.working.append(wanted)

    def no_frame(self, seconds):
        return f"no frame within {seconds:g} s"


@pytest.fixture
def node():
    return Node()


@pytest.fixture
def lock():
    return threading.Lock()


@pytest.fixture
def selections(node, lock):
    return Selections(node, lock)


@pytest.fixture
def logged(monkeypatch):
    lines = []
    monkeypatch.setattr(rospy, "logerr", lambda text, *values: lines.append(text % values))
    return lines


def test_the_newest_region_of_the_topic_waits_for_one_frame(monkeypatch, node, selections):
    topics = {}
    monkeypatch.setattr(rospy, "Subscriber", lambda *arguments: topics.update([arguments[::2]]))
    selections.subscribe()
    for left in (1, 2):
        topics["~select"](RegionOfInterest(x_offset=left, y_offset=5, width=2**32 - 1, height=7))
    assert node.working == [True]
    (taken,) = selections.take()
    assert taken.box == (2, 5, 2**30, 7)
    assert 0.0 < taken.deadline - time.monotonic() <= SELECT_TIMEOUT
    selections.keep_working()
    assert node.working == [True, False] and not selections.take()


def test_a_frame_that_comes_too_late_selects_nothing(node, lock, selections, logged):
    old, patient = Selection(BOX, timeout=-1.0), Selection(BOX, timeout=math.inf)
    with lock:
        selections.add(old)
        assert not selections.take()
        assert old.done.is_set() and old.error == "no frame within 10 s"
        assert logged == ["nothing selected: no frame within 10 s"]
        selections.keep_working()
        assert node.working == [True, False]
        selections.add(patient)
        assert selections.take() == [patient] and len(logged) == 1


def test_a_region_is_refused_in_time_though_no_frame_comes(node, lock, selections, logged):
    short, patient = Selection(BOX, timeout=0.01), Selection(BOX, timeout=math.inf)
    short.replaces = False
    with lock:
        selections.add(short)
    assert short.done.wait(DEADLINE) and short.error == "no frame within 10 s"
    with lock:  # held until all is told
        assert logged == ["nothing selected: no frame within 10 s"]
        assert node.working == [True, False]
        selections.add(patient)
        assert selections.take() == [patient]


def test_one_thread_looks_after_all_regions(lock, selections):
    before = set(threading.enumerate())
    regions = [Selection(BOX, timeout=0.01) for _ in range(20)]
    for one in regions:
        one.replaces = False
    with lock:
        for one in regions:
            selections.add(one)
        assert len(set(threading.enumerate()) - before) == 1
    assert all(one.done.wait(DEADLINE) for one in regions)


def test_what_cannot_be_selected_is_logged_but_not_with_every_region(selections, logged):
    wanted = [Selection(BOX) for _ in range(3)]
    for one in wanted:
        selections.refuse(one, ValueError("not inside"))
    assert logged == ["nothing selected on /eye/image: not inside"]
    assert all(one.done.is_set() and one.error == "not inside" for one in wanted)


def test_a_node_that_is_busy_works_on_without_a_region(node):
    busy = [True]
    selections = Selections(node, threading.Lock(), lambda: busy[0])
    selections.add(Selection(BOX))
    selections.take()
    selections.keep_working()
    assert node.working == [True]
    busy[0] = False
    selections.keep_working()
    assert node.working == [True, False]
