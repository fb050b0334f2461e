"""Nodes come and go in a manager, with frames flowing, and leave nothing behind."""

import threading

import pytest
import rospy
import support
from frames import Camera
from private_memory import GIVES_BACK
from python_manager import NAME, Counts, PythonManager, graph_of
from std_msgs.msg import Header

import robot_vision as rv
from robot_vision.msg import DetectionArray

LOADS = 100
RATE = 30.0  # Hz
MAX_GROWTH = 6.0  # MiB, in all loads behind the first ones: the allocator's own


class Flow:
    """Sends frames all the time."""

    def __init__(self):
        self.camera = Camera(RATE)
        self._ended = threading.Event()
        self._image = rv.Scene().render(60)[::2, ::2].copy()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._ended.wait(1.0 / RATE):
            self.camera.show(self._image)

    def end(self):
        self._ended.set()
        self._thread.join()


@pytest.fixture
def flow():
    made = Flow()
    yield made
    made.end()


@pytest.mark.parametrize("kind", ["hsv_tracker", "object_tracker", "object_detector"])
def test_a_hundred_loads_leave_all_as_it_was(start, flow, kind):
    # A fork shares memory with its parent until it writes there, which would be growth as well.
    manager = PythonManager(start, fork=False, env=GIVES_BACK)
    manager.load("/stays", "robot_vision/hsv_tracker", {"/image": flow.camera.topic})
    stays = support.subscribed("/stays/objects", DetectionArray)
    output = "/comes/" + ("object" if kind == "object_tracker" else "objects")
    rospy.set_param("/comes/auto_select", True)

    def come_and_go():
        manager.load("/comes", "robot_vision/" + kind, {"/image": flow.camera.topic})
        # A subscription that lasts may miss a topic of rospy that goes and is there again at once.
        results = support.Messages(output, DetectionArray)
        results.wait(1)
        results.close()
        manager.unload("/comes")

    for _ in range(5):  # what is imported and made once
        come_and_go()
    before = settled(manager.process.pid)
    graph = graph_of(NAME, NAME + "_images")
    loads = LOADS if kind == "hsv_tracker" else LOADS // 5
    for _ in range(loads):
        come_and_go()
    more = {"before": before}

    def as_it_was():
        """Whether nothing is left behind; what ends, such as a connection's thread, takes time."""
        now, more["graph"] = Counts(manager.process.pid), graph_of(NAME, NAME + "_images") ^ graph
        more["after"] = now
        counted = now.threads <= before.threads + 2 and now.descriptors <= before.descriptors + 2
        return counted and now.memory <= before.memory + MAX_GROWTH and not more["graph"]

    try:
        support.wait_for(as_it_was, "all as it was before")
    except AssertionError as error:
        raise AssertionError(f"{error}: {more}") from None
    del stays.received[:]
    stays.wait(5)
    assert manager.loaded() == {"/stays"}


def settled(pid):
    """The smallest counts within some seconds: threads of connections end a bit later."""
    counts = [Counts(pid)]
    clock = support.Messages("/nothing", Header)
    for _ in range(10):
        threading.Event().wait(0.2)
        counts.append(Counts(pid))
    clock.close()
    least = counts[-1]
    least.threads = min(one.threads for one in counts)
    least.descriptors = min(one.descriptors for one in counts)
    least.memory = min(one.memory for one in counts)  # without frames on their way
    return least
