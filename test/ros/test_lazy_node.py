"""Capture and processing run only while there are subscribers."""

import pytest
import rosgraph
import rospy
import support
from sensor_msgs.msg import CameraInfo, Image

FILTERS = [
    f"{name}_node"
    for name in ("brightness", "edge_detector", "filter", "dense_flow", "spectrum", "segmenter")
]


def subscribers(topic):
    """The nodes that subscribe to a topic according to the master."""
    state = rosgraph.Master("/test").getSystemState()[1]
    return dict(state).get(topic, [])


def frames_published(diagnostics, node):
    return int(diagnostics.value(node, "frames published"))


def wait_until_idle(diagnostics, node):
    support.wait_for(
        lambda: diagnostics.next(node).message == "idle: nobody subscribes", "idle " + node
    )


def stands_still(diagnostics, node, key):
    """True if a count is the same in three reports."""
    counts = {int(diagnostics.value(node, key)) for _ in range(3)}
    return len(counts) == 1


@pytest.mark.parametrize(
    "topic, kind", [("image_raw", Image), ("camera_info", CameraInfo), ("image_mono", Image)]
)
def test_camera_captures_while_somebody_subscribes(start, diagnostics, topic, kind):
    start("camera_node", "__name:=lazy", "_source:=synthetic", "_diagnostic_period:=0.1")
    wait_until_idle(diagnostics, "lazy")
    assert int(diagnostics.value("lazy", "frames received")) == 0

    messages = support.Messages("/lazy/" + topic, kind)
    messages.wait(2)
    rising = int(diagnostics.value("lazy", "frames received"))
    support.wait_for(
        lambda: int(diagnostics.value("lazy", "frames received")) > rising, "more frames"
    )
    messages.close()

    wait_until_idle(diagnostics, "lazy")
    assert stands_still(diagnostics, "lazy", "frames received")


@pytest.mark.parametrize("node", FILTERS)
def test_filter_subscribes_while_somebody_subscribes(start, diagnostics, node):
    start("camera_node", "__name:=source", "_source:=synthetic", "_always_subscribe:=true")
    start(node, "__name:=lazy", "image:=/source/image_raw", "_diagnostic_period:=0.1")
    diagnostics.next("lazy")
    assert "/lazy" not in subscribers("/source/image_raw")
    assert int(diagnostics.value("lazy", "frames received")) == 0

    for _ in range(2):
        messages = support.Messages("/lazy/processed_image", Image)
        messages.wait(3)
        # For a moment it is not there while the node leaves raw for shm.
        support.wait_for(lambda: "/lazy" in subscribers("/source/image_raw"), "the subscription")
        messages.close()
        support.wait_for(
            lambda: "/lazy" not in subscribers("/source/image_raw"), "the end of the subscription"
        )
        # A frame that was there before may be counted after the subscription.
        support.wait_for(lambda: stands_still(diagnostics, "lazy", "frames received"), "no frames")
        assert stands_still(diagnostics, "lazy", "frames received")


@pytest.mark.parametrize("node", ["brightness_node", "edge_detector_node"])
def test_always_subscribe_runs_without_an_audience(start, diagnostics, node):
    start("camera_node", "__name:=source", "_source:=synthetic")
    start(node, "__name:=eager", "image:=/source/image_raw", "_always_subscribe:=true")
    support.wait_for(lambda: frames_published(diagnostics, "eager") > 5, "frames that go out")


@pytest.mark.parametrize("node", ["brightness_node", "edge_detector_node"])
def test_missing_frames_are_reported(start, diagnostics, node):
    process = start(node, "__name:=waits", "_always_subscribe:=true")
    process.wait_for_output("topic 'image' is not remapped")

    def told():
        status = diagnostics.next("waits")
        return (status.level, status.message) == (1, "no frames on /image")

    support.wait_for(told, "that there are no frames")
    start("camera_node", "__name:=source", "_source:=synthetic", "~image_raw:=/image")
    support.wait_for(lambda: diagnostics.next("waits").message == "running on /image", "frames")


def test_the_transport_is_the_one_that_the_node_started_with(start):
    start("camera_node", "__name:=source", "_source:=synthetic")
    start("edge_detector_node", "__name:=lazy", "image:=/source/image_raw")
    support.wait_for(lambda: support.publishers_of("/lazy/processed_image"), "the node")
    rospy.set_param("/lazy/image_transport", "nonsense")
    support.Messages("/lazy/processed_image", Image).wait(2)


def test_chain_starts_and_stops_with_its_last_link(start, diagnostics):
    period = "_diagnostic_period:=0.1"
    start("camera_node", "__name:=link0", "_source:=synthetic", period)
    start("brightness_node", "__name:=link1", "image:=/link0/image_raw", period)
    start("edge_detector_node", "__name:=link2", "image:=/link1/processed_image", period)
    edges = support.Messages("/link2/processed_image", Image)
    edges.wait(5)
    edges.close()
    for link in ("link2", "link1", "link0"):
        wait_until_idle(diagnostics, link)
