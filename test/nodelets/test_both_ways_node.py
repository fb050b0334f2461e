"""Each node in Python is the same whether it runs alone or is loaded into a manager."""

import re

import pytest
import rosgraph
import roslib.message
import rospy
import support
from diagnostic_msgs.msg import DiagnosticArray
from dynamic_reconfigure.msg import ConfigDescription
from frames import Camera
from python_manager import NAME, PythonManager, graph_of
from std_srvs.srv import Trigger

import robot_vision as rv
from robot_vision.nodelets.node_types import type_names

# rospy's own services, of each process, and topics that the process has anyway.
OF_PROCESS = re.compile(r".*/(get_loggers|set_logger_level)|/rosout|/clock|/vision/.*")
# What finds something in the scene, in which topic; others have results of other kinds.
FOUND = {
    "hsv_tracker": "objects",
    "ball_tracker": "objects",
    "code_reader": "codes",
    "apriltag_detector": "tags",
    "hough": "objects",
    "contours": "contours",
}
# They make nothing of a color image alone: they need depths, faces or /diagnostics.
OF_OTHER_INPUTS = {"demo_status", "detections_3d", "face_recognizer", "tabletop"}
LACK_CAMERA_INFO = {"object_recognizer"}  # They show nothing as long as this may still come.
MIN_FRAMES = 6  # some nodes need more than one to be sure
NODES = sorted({name.partition("/")[2] for name in type_names()} - OF_OTHER_INPUTS)


class BothWays:
    """A node that runs as /alone_NAME and as /loaded_NAME."""

    def __init__(self, start, manager, kind):
        self.kind = kind
        self.image = f"/{kind}/image"
        self._manager = manager
        self._before = graph_of(NAME, NAME + "_images")
        self._alone = start(kind + ".py", f"__name:=alone_{kind}", f"image:={self.image}")
        manager.load(f"/loaded_{kind}", f"robot_vision/{kind}", {"/image": self.image})

    def end(self):
        self._alone.end()
        self._manager.unload(f"/loaded_{self.kind}")

    def graph(self, way):
        """What it publishes, subscribes to and serves, without its namespace."""
        if way == "alone":
            found = graph_of(f"/alone_{self.kind}", f"/alone_{self.kind}_images")
        else:
            found = graph_of(NAME, NAME + "_images") - self._before
        return {
            (what, name.replace(f"/{way}_", "/"), kind)
            for what, name, kind in found
            if not OF_PROCESS.fullmatch(name) and (what, name) != ("publishes", "/diagnostics")
        }

    def params(self, way):
        master = rosgraph.Master("/test")
        name = f"/{way}_{self.kind}"
        return master.getParam(name) if master.hasParam(name) else {}


@pytest.fixture(scope="module")
def manager(start_once):
    return PythonManager(start_once)


@pytest.fixture(scope="module")
def both(start_once, manager, request):
    """All tests of a node, which follow each other, look at the same two."""
    node = BothWays(start_once, manager, request.param)
    try:
        same(node.graph)
        yield node
    finally:
        node.end()


def same(look):
    """Waits until something is the same of both, and there is something."""
    try:
        support.wait_for(lambda: look("alone") and look("alone") == look("loaded"), "the same")
    except AssertionError:
        assert look("alone") == look("loaded")
        raise


# pytest knows by their numbers which parameters of two tests are the same.
@pytest.mark.parametrize("both", [*NODES, *sorted(OF_OTHER_INPUTS)], indirect=True)
def test_names_types_and_parameters_are_the_same(both):
    same(lambda way: {"of it": both.params(way)})
    served = {name for what, name, _ in both.graph("loaded") if what == "serves"}
    if f"/{both.kind}/set_parameters" in served:
        assert_same_live_parameters(both.kind)
        assert statuses("alone", both.kind) == statuses("loaded", both.kind)


def assert_same_live_parameters(kind):
    described, values, answers = [], [], []
    for way in ("alone", "loaded"):
        node = f"/{way}_{kind}"
        topic = support.Messages(node + "/parameter_descriptions", ConfigDescription)
        described.append(topic.wait()[0])
        values.append(support.reconfigured(node))
        answers.append(rospy.ServiceProxy(node + "/save_parameters", Trigger)())
    assert described[0] == described[1]
    assert values[0] == values[1]
    assert answers[0] == answers[1]
    assert "config_file" in answers[0].message


def statuses(way, kind):
    """What a node tells on /diagnostics in two periods, without its namespace: names and keys."""
    received = support.Messages("/diagnostics", DiagnosticArray).received
    beginning = f"{way}_{kind}: "

    def own():
        found = [status for one in received for status in one.status]
        return [
            (status.name[len(way) :], tuple(value.key for value in status.values))
            for status in found
            if status.name.startswith(beginning)
        ]

    support.wait_for(lambda: any(own().count(one) >= 2 for one in own()), f"statuses of {kind}")
    return set(own())


def results_of(way, kind):
    """All that a node publishes under its name, by topic: the messages so far."""
    own = f"/{way}_{kind}/"
    topics = {}
    for what, name, type_name in graph_of(NAME, NAME + "_images", own[:-1], own[:-1] + "_images"):
        short = name[len(own) :]
        own_topic = what == "publishes" and name.startswith(own) and "/" not in short
        if own_topic and not short.startswith("parameter_"):
            topics[short] = support.Messages(name, roslib.message.get_message_class(type_name))
    return topics


def text_of(messages, stamp, way):
    """The message of a frame in words, without the namespace and the number of the message."""
    for message in messages.received:
        if hasattr(message, "header") and message.header.stamp == stamp:
            message.header.seq = 0
            return str(message).replace(f"/{way}_", "/")
    return ""


def differs(alone, loaded, stamp):
    """Whether two topics have other results of a frame, or none where they have some of others."""
    texts = text_of(alone, stamp, "alone"), text_of(loaded, stamp, "loaded")
    any_came = any(hasattr(one, "header") for one in (*alone.received, *loaded.received))
    return texts[0] != texts[1] or (any_came and not texts[0])


@pytest.mark.parametrize("both", NODES, indirect=True)
def test_results_of_the_same_frames_are_the_same(both):
    alone, loaded = (results_of(way, both.kind) for way in ("alone", "loaded"))
    assert set(alone) == set(loaded) and alone
    camera = Camera(rate=30.0, topic=both.image)
    camera.wait_for(2)
    for one in (*alone.values(), *loaded.values()):
        support.wait_for(one.connected, "the publishers of the results")
    image = rv.Scene().render(60)
    shown, differing = [], ["the first frames"]
    overlays = [
        topics["processed_image"] for topics in (alone, loaded) if "processed_image" in topics
    ]

    def begun():
        camera.show(image)
        return all(overlay.received for overlay in overlays)

    def same_results():
        stamp = camera.show(image).stamp
        shown.append(stamp)
        for overlay in overlays:
            overlay.of(stamp)
        if len(shown) > MIN_FRAMES:
            # Of the newest frame, what comes after the processed image is still on its way.
            stamp = shown[-2]
            differing[:] = [topic for topic in alone if differs(alone[topic], loaded[topic], stamp)]
        return not differing and found(both.kind, loaded, stamp)

    if both.kind in LACK_CAMERA_INFO:
        support.wait_for(begun, "the first overlays")
    try:
        support.wait_for(same_results, "the same results")
    except AssertionError as error:
        raise AssertionError(f"{error}: others on {differing}, or nothing found") from None


def found(kind, topics, stamp):
    """Whether a node that finds something in the scene has done so in this frame."""
    if kind not in FOUND:
        return True
    return "- \n" in text_of(topics[FOUND[kind]], stamp, "loaded")
