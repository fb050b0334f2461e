"""Nodes of a process that publish on the same topic, for which rospy has one publisher."""

import contextlib
import logging
import threading

import pytest
import rospy
import support
from diagnostic_msgs.msg import DiagnosticArray
from frames import Source, new_topic
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from robot_vision.nodelets.log_names import log_by_node
from robot_vision.ros.context import LoadedContext, active
from robot_vision.ros.frame_transforms import FrameTransforms
from robot_vision.ros.image_node import ImageNode
from robot_vision.ros.listeners import listeners_elsewhere
from robot_vision.ros.status_topic import StatusTopic
from robot_vision.ros.transform_output import TransformOutput

NODES = ["/first", "/second", "/third"]
LISTENER = """
import rospy
from tf2_msgs.msg import TFMessage

rospy.init_node("listener")
rospy.Subscriber("/tf", TFMessage, print)
rospy.spin()
"""


@contextlib.contextmanager
def loaded(names=NODES):
    """The contexts of nodes of this process, which end at the end."""
    contexts = [LoadedContext(name, {"/image": new_topic()}, print) for name in names]
    yield contexts
    for context in contexts:
        context.end()


@contextlib.contextmanager
def held_writer(publisher):
    """Has rospy's thread that sends the messages of a topic wait, as it does for the GIL."""
    support.wait_for(lambda: publisher.impl.connections, "a connection")
    (connection,) = publisher.impl.connections
    sender, may_go_on = connection._connection, threading.Event()
    send = sender.write_data

    def held(data):
        assert may_go_on.wait(support.DEADLINE)
        send(data)

    sender.write_data = held
    yield
    may_go_on.set()


def transforms_of(context):
    with active(context):
        return ImageNode(lambda _: None).shared_publisher("/tf", TFMessage, lambda: True, False)


def test_transforms_of_several_nodes_at_the_same_moment_all_come():
    with loaded() as contexts:
        outputs = [transforms_of(context) for context in contexts]
        came = support.subscribed("/tf", TFMessage)
        with held_writer(outputs[0]):
            for name, output in zip(NODES, outputs):
                output.publish(TFMessage([TransformStamped(child_frame_id=name)]))
        frames = [one.transforms[0].child_frame_id for one in came.wait(len(NODES))]
    assert frames == NODES


def test_statuses_of_several_nodes_at_the_same_moment_all_come():
    with loaded() as contexts:
        topics = []
        for context in contexts:
            with active(context):
                topics.append(StatusTopic("objects"))
        came = support.subscribed("/diagnostics", DiagnosticArray)
        with held_writer(topics[0]._publisher):
            for context, topic in zip(contexts, topics):
                with active(context):
                    topic.publish(lambda: (0, "well", {}))
        expected = {name[1:] + ": objects" for name in NODES}
        support.wait_for(
            lambda: expected <= {one.name for array in came.received for one in array.status},
            "the statuses",
        )


def test_the_last_status_before_a_rest_is_told():
    rospy.set_param("/first/diagnostic_period", 3600.0)
    with loaded(NODES[:1]) as (context,), active(context):
        topic = StatusTopic("objects")
        came = support.subscribed("/diagnostics", DiagnosticArray)

        def told():
            return [one.message for array in came.received for one in array.status]

        for text in ("the first", "not due", "the last"):
            topic.publish(lambda text=text: (0, text, {}))
        for _ in range(2):
            topic.publish_untold()
        support.wait_for(lambda: "the last" in told(), "the last status")
        topic._last = float("-inf")
        topic.publish(lambda: (0, "another", {}))
        support.wait_for(lambda: "another" in told(), "one that is due")
        assert [text for text in told() if text] == ["the first", "the last", "another"]
    rospy.delete_param("/first")


@pytest.fixture
def logged_by_node(monkeypatch):
    """Has this process log as one does that holds several nodes."""
    logger = logging.getLogger("rosout")
    monkeypatch.setattr(logger, "handlers", logger.handlers[:])
    monkeypatch.setattr(rospy, "get_name", rospy.get_name)
    monkeypatch.setattr(rospy.core, "_frame_to_caller_id", rospy.core._frame_to_caller_id)
    log_by_node()


def test_a_node_works_for_another_of_its_process_that_listens_to_transforms(logged_by_node):
    """But those that listen come to rest, although they hear themselves and each other."""
    with loaded() as contexts:
        nodes = []
        for context, listens in zip(contexts, (True, True, False)):
            with active(context):
                nodes.append(ImageNode(lambda _: None))
                TransformOutput(nodes[-1], lambda: True, listens=listens)
                nodes[-1].start()
        images = [Source(node.topic) for node in nodes]
        with active(contexts[0]):
            transforms = FrameTransforms()
        assert transforms.rotation("base", "eye") is None
        images[2].wait_for()
        for node, source in zip(nodes[:2], images):
            node.keep_working(True)
            source.wait_for()
            node.keep_working(False)
            source.wait_for(0)
        images[2].wait_for()
        transforms.forget()
        images[2].wait_for(0)


def test_transforms_without_a_parent_are_told_by_each_node(log):
    with loaded(NODES[:2]) as contexts:
        for context in contexts:
            with active(context):
                output = TransformOutput(ImageNode(lambda _: None), lambda: True)
                for _ in range(2):
                    output.publish(TFMessage([TransformStamped()]))
                topic = context.resolve("image")
            assert log().count(f"no transforms: the images of {topic} have no frame_id") == 1


def test_who_listens_elsewhere_counts(run_script):
    with loaded(NODES[:1]) as (context,):
        output = transforms_of(context)
        run_script(LISTENER, fork=True)
        support.wait_for(lambda: listeners_elsewhere(output) == 1, "the other process")


class LastListener(rospy.SubscribeListener):
    """Tells when all listeners before it have been called."""

    def __init__(self):
        self.called = threading.Event()

    def peer_subscribe(self, *_):
        self.called.set()


def test_a_node_that_has_ended_has_nothing_made_by_who_comes_later():
    """rospy goes on to call it, as another node has the same topic."""
    with loaded(NODES[:1]) as (stays,):
        transforms_of(stays)
        with loaded(NODES[1:2]) as (gone,):
            transforms_of(gone)
        last = LastListener()
        publisher = rospy.Publisher("/tf", TFMessage, subscriber_listener=last, queue_size=100)
        later = support.subscribed("/tf", TFMessage)
        assert last.called.wait(support.DEADLINE)
        assert not gone._parts
        later.close()
        publisher.unregister()
