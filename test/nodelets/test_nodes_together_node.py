"""Nodes that come and go at the same time leave the topics of all others alone."""

import threading

import support
from diagnostic_msgs.msg import DiagnosticArray
from frames import Camera
from python_manager import NAME, PythonManager, graph_of
from sensor_msgs.msg import Image

import robot_vision as rv
from robot_vision.msg import DetectionArray

ROUNDS = 12
NODES = [f"/node_{number}" for number in range(8)]
SCENE = rv.Scene().render(60)[::2, ::2].copy()


def together(work):
    """Calls a function with the name of each node, each in a thread of its own."""
    errors = []

    def call(name):
        try:
            work(name)
        except Exception as error:
            errors.append(error)

    threads = [threading.Thread(target=call, args=(name,)) for name in NODES]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors


def others():
    """What the master still knows of the nodes that have gone."""
    known = graph_of(NAME, NAME + "_images")
    return [entry for entry in known if entry[1].startswith("/node_")]


def assert_publishes(name, camera, diagnostics):
    """Asserts that a node still publishes its images, its results and its diagnostics."""
    topics = [support.subscribed(name + "/objects", DetectionArray)]
    topics.append(support.subscribed(name + "/processed_image", Image))
    count = len(diagnostics.received)
    support.wait_for(
        lambda: camera.show(SCENE) and all(topic.received for topic in topics), "results"
    )
    support.wait_for(
        lambda: any(
            status.name.startswith(name[1:] + ":")
            for one in diagnostics.received[count:]
            for status in one.status
        ),
        "diagnostics",
    )
    for topic in topics:
        topic.close()


def test_nodes_that_come_and_go_together_leave_the_others_alone(start):
    camera = Camera(rate=100.0)
    manager = PythonManager(start)
    words = {"/image": camera.topic}
    manager.load("/stays", "robot_vision/hsv_tracker", words)
    before = graph_of(NAME, NAME + "_images")
    diagnostics = support.subscribed("/diagnostics", DiagnosticArray)
    for _ in range(ROUNDS):
        together(lambda name: manager.load(name, "robot_vision/contours", words))
        together(manager.unload)
        assert manager.process.running(), manager.process.output()
    assert_publishes("/stays", camera, diagnostics)
    support.wait_for(
        lambda: graph_of(NAME, NAME + "_images") >= before and not others(), "the graph of before"
    )
