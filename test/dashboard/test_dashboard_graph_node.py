"""The graph that the dashboard pushes: nodes, topics, statuses, and what to look at."""

import contextlib
import os
import signal

import pytest
import rosgraph
import rospy
import support
from feature_page import FeaturePage, subscribes
from ros_fixtures import forget
from std_msgs.msg import Float32, String

from robot_vision.dashboard import graph_feature
from robot_vision.dashboard.graph_feature import GraphFeature, KnownGraph
from robot_vision.dashboard.graph_state import state_of
from robot_vision.dashboard.settings import Settings
from robot_vision.msg import DetectionArray
from robot_vision.ros import graph_master


class GraphPage(FeaturePage):
    """A page whose graphs have the statuses that were pushed last, as those of a browser."""

    def pushes(self, kind):
        if kind != "graph":
            return super().pushes(kind)
        graphs = []
        for known, data in list(self.pushed):
            if known == "graph":
                graphs.append(data)
            elif known == "statuses":
                nodes = [{**node, "status": data.get(node["name"])} for node in graphs[-1]["nodes"]]
                graphs.append({**graphs[-1], "nodes": nodes})
        return graphs


@pytest.fixture
def page(master):
    feature = GraphFeature(Settings())
    page = GraphPage(feature, role="view")
    page.feature = feature
    yield page
    page.close()
    feature.close()


def node_of(graph, name):
    return next((node for node in graph["nodes"] if node["name"] == name), None)


def status_of(graph, name):
    """The status of a node; {} if there is none."""
    return (node_of(graph, name) or {}).get("status") or {}


def topic_of(graph, name):
    return next((topic for topic in graph["topics"] if topic["name"] == name), None)


def views_of(graph, node):
    return [view for view in graph["views"] if view["node"] == node]


def test_a_node_has_its_topics_services_status_and_view(page, start):
    start("camera_node", "__name:=usb_cam", "_source:=synthetic", "_framerate:=5")
    start("hsv_tracker.py", "__name:=tracker", "image:=/usb_cam/image_raw")
    page.request("graph")
    page.wait_for_push(
        "graph",
        lambda graph: (
            status_of(graph, "/tracker")
            and status_of(graph, "/usb_cam")
            and topic_of(graph, "/tracker/mask")
        ),
    )
    overlay = support.Messages("/tracker/objects", DetectionArray)
    graph = page.wait_for_push(
        "graph",
        lambda graph: (
            status_of(graph, "/tracker").get("rate")
            and "running" in status_of(graph, "/tracker")["message"]
            and views_of(graph, "/tracker")[0]["image"]
        ),
    )
    overlay.close()
    tracker = node_of(graph, "/tracker")
    assert tracker["package_node"] and tracker["parameters"]
    assert "/tracker/objects" in tracker["publishes"]
    assert "/usb_cam/image_raw" in tracker["subscribes"]  # by its roscpp node, which is not shown
    assert node_of(graph, "/tracker_images") is None
    assert {"/tracker/set_parameters", "/tracker/save_parameters"} <= set(tracker["services"])
    status = tracker["status"]
    assert status["level"] == 0 and "running on /usb_cam/image_raw" in status["message"]
    assert status["processing"] > 0.0 and status["age"] > 0.0
    assert status["values"]["frames received"].isdigit()
    assert views_of(graph, "/tracker") == [
        {
            "node": "/tracker",
            "title": "tracker",
            "image": "/usb_cam/image_raw",
            "overlays": ["/tracker/objects"],
            "processed": "/tracker/processed_image",
        }
    ]
    assert [view["image"] for view in views_of(graph, "/usb_cam")] == ["/usb_cam/image_raw"]
    assert views_of(graph, "/usb_cam")[0]["overlays"] == []
    image = topic_of(graph, "/usb_cam/image_raw")
    assert image["image"] and image["type"] == "sensor_msgs/Image"
    assert "/usb_cam" in image["publishers"]
    assert not topic_of(graph, "/usb_cam/image_raw/compressed")["image"]
    # What it worked on is remembered when it rests.
    graph = page.wait_for_newest(
        "graph", lambda graph: "idle" in status_of(graph, "/tracker").get("message", "")
    )
    assert views_of(graph, "/tracker")[0]["image"] == "/usb_cam/image_raw"


def test_nobody_who_looks_means_no_subscription(page):
    support.wait_for(lambda: not subscribes("/diagnostics"), "the end of who looked before")
    page.request("graph")
    support.wait_for(lambda: subscribes("/diagnostics"), "a subscription")
    page.close()
    support.wait_for(lambda: not subscribes("/diagnostics"), "the end of the subscription")


def test_nodes_come_and_go(page, start):
    page.request("graph")
    process = start("motion_detector.py", "__name:=motion", "image:=/nobody")
    # It is registered then as a whole: what a node registers while it ends may stay.
    page.wait_for_push("graph", lambda graph: status_of(graph, "/motion"))
    process.interrupt()
    process.end()
    forget(["/motion", "/motion_images"])  # as the master does, unless it was told too late
    page.wait_for_newest("graph", lambda graph: node_of(graph, "/motion") is None)


def test_a_nodelet_is_a_node_of_its_own(page, start):
    manager = support.NodeletManager(start)
    page.request("graph")
    assert manager.load("/edges", "edge_detector", {"image": "/nobody"})
    graph = page.wait_for_push("graph", lambda graph: status_of(graph, "/edges"))
    node = node_of(graph, "/edges")
    assert "/edges/processed_image" in node["publishes"] and node["parameters"]
    assert "/edges/set_parameters" in node["services"]
    assert "/edges/processed_image" not in node_of(graph, "/manager")["publishes"]


def test_a_topic_that_changes_its_type_is_shown_with_the_new_one(page):
    page.request("graph")
    topic = "/changing"
    first = rospy.Publisher(topic, String, queue_size=1)
    page.wait_for_push(
        "graph", lambda graph: (topic_of(graph, topic) or {}).get("type") == "std_msgs/String"
    )
    first.unregister()
    second = rospy.Publisher(topic, Float32, queue_size=1)
    page.wait_for_push(
        "graph", lambda graph: (topic_of(graph, topic) or {}).get("type") == "std_msgs/Float32"
    )
    second.unregister()


@contextlib.contextmanager
def stopped(process):
    os.kill(process, signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(process, signal.SIGCONT)


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(graph_master, "TIMEOUT", 3.0)


def test_a_master_that_hangs_blocks_nothing_and_is_told(impatient, page, master):
    page.request("graph")
    page.wait_for_push("graph", lambda graph: graph["nodes"])
    pid = rosgraph.Master("/test").getPid()
    with stopped(pid):
        graph = page.wait_for_push("graph", lambda graph: graph["problem"])
        assert "does not answer" in graph["problem"] and graph["nodes"]
        assert page.request("graph") == {}
    page.wait_for_push("graph", lambda graph: not graph["problem"])


def test_names_with_markup_stay_text(page):
    hostile = rosgraph.Master("/<script>alert(1)</script>")
    hostile.registerPublisher("/<b>x</b>", "a/<i>", "http://127.0.0.1:9/")
    try:
        page.request("graph")
        graph = page.wait_for_push("graph", lambda graph: topic_of(graph, "/<b>x</b>"))
    finally:
        hostile.unregisterPublisher("/<b>x</b>", "http://127.0.0.1:9/")
    assert topic_of(graph, "/<b>x</b>")["type"] == "a/<i>"
    assert node_of(graph, "/<script>alert(1)</script>")


def test_a_master_that_is_another_one_is_read_anew(start, monkeypatch):
    other = support.Master(start)
    monkeypatch.setenv("ROS_MASTER_URI", other.env["ROS_MASTER_URI"])
    known = KnownGraph()
    monkeypatch.setattr(known._statuses, "listen", lambda _: None)  # rospy has its own master
    announce = rosgraph.Master("/somebody", other.env["ROS_MASTER_URI"]).registerPublisher
    announce("/first", "std_msgs/String", "http://127.0.0.1:9/")
    assert topic_of(known.look(), "/first") and not known.look()["problem"]
    other.end()
    graph = known.look()
    assert topic_of(graph, "/first") and "does not answer" in graph["problem"]
    other.begin()
    announce("/second", "std_msgs/String", "http://127.0.0.1:9/")
    graph = known.look()
    assert [topic["name"] for topic in graph["topics"]] == ["/second"] and not graph["problem"]
    known.rest()


def test_what_has_not_changed_is_not_read_again(page, monkeypatch):
    read = []

    def counted(*arguments):
        read.append(arguments)
        return state_of(*arguments)

    monkeypatch.setattr(graph_feature, "state_of", counted)
    known = KnownGraph()
    known.look()  # which subscribes to /diagnostics
    known.look()
    before = len(read)
    graphs = [known.look() for _ in range(5)]
    assert len(read) == before and graphs[0]["topics"] == graphs[-1]["topics"]
    publisher = rospy.Publisher("/one_more", String, queue_size=1)
    assert topic_of(known.look(), "/one_more")
    publisher.unregister()
    known.rest()


class Looks:
    """Plays what is known of the graph, and counts how often it is asked."""

    def __init__(self):
        self.count = 0
        self.topics = []

    def look(self):
        self.count += 1
        status = {"level": 0, "values": {"frames received": str(self.count)}}
        nodes = [{"name": "/eye", "status": status}, {"name": "/ear", "status": None}]
        return {"time": self.count, "problem": "", "nodes": nodes, "topics": list(self.topics)}

    def rest(self):
        pass


def test_of_a_graph_that_stays_only_statuses_are_pushed(page, monkeypatch):
    monkeypatch.setattr(graph_feature, "PERIOD", 0.01)
    looks = page.feature._known = Looks()
    page.request("graph")
    page.wait_for_push(
        "statuses", lambda statuses: int(statuses["/eye"]["values"]["frames received"]) > 5
    )
    assert all(set(statuses) == {"/eye"} for statuses in page.pushes("statuses"))
    kinds = [kind for kind, _ in list(page.pushed)]
    assert set(kinds[1:]) == {"statuses"} and kinds[0] == "graph"
    looks.topics.append({"name": "/one_more"})
    page.wait_for_push("graph", lambda graph: topic_of(graph, "/one_more"))
    assert [kind for kind, _ in list(page.pushed)].count("graph") == 2


def test_who_asks_again_and_again_has_nobody_ask_the_master_more_often(page, monkeypatch):
    monkeypatch.setattr(graph_feature, "PERIOD", support.DEADLINE)
    looks = page.feature._known = Looks()
    for _ in range(20):
        page.request("graph")
    page.wait_for_push("graph")
    assert looks.count <= 2  # the first request may come before the thread waits


def test_pushes_end_with_the_session_and_others_stay(page):
    other = FeaturePage(page.feature)
    for one in (page, other):
        one.request("graph")
        one.wait_for_push("graph")
    other.close()
    before = len(other.pushes("graph"))
    publisher = rospy.Publisher("/one_more", String, queue_size=1)
    page.wait_for_push("graph", lambda graph: topic_of(graph, "/one_more"))
    publisher.unregister()
    assert len(other.pushes("graph")) == before
