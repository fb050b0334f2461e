"""Where frames are to each other, for a node that was loaded beside others."""

import numpy as np
import rosgraph
import rospy
import support
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from robot_vision.ros.context import LoadedContext, active
from robot_vision.ros.frame_transforms import FrameTransforms

OF_THE_NODE = {"/tf": "/other/tf", "/tf_static": "/other/tf_static"}


def made(context):
    with active(context):
        return FrameTransforms()


def sender():
    """A publisher of what is static; of its messages the last one is latched."""
    return rospy.Publisher("/other/tf_static", TFMessage, queue_size=10, latch=True)


def turned(quarter, child="eye"):
    """A message that says that a frame is turned in `base`, about z."""
    transform = TransformStamped(child_frame_id=child)
    transform.header.frame_id = "base"
    transform.transform.rotation.z = np.sin(quarter * np.pi / 4)
    transform.transform.rotation.w = np.cos(quarter * np.pi / 4)
    return TFMessage([transform])


def wait_for(transforms, child):
    support.wait_for(lambda: transforms.rotation("base", child) is not None, f"that of {child}")


def listens():
    """The topics of transforms to which this process subscribes."""
    subscribers = dict(rosgraph.Master("/test").getSystemState()[1])
    names = ["/tf", "/tf_static", *OF_THE_NODE.values()]
    return [name for name in names if rospy.get_name() in subscribers.get(name, [])]


def test_transforms_come_on_the_topics_of_the_node_until_its_end():
    context = LoadedContext("/loaded", OF_THE_NODE, print)
    transforms = made(context)
    assert listens() == []
    publisher = sender()
    publisher.publish(turned(1))
    wait_for(transforms, "eye")
    assert np.allclose(transforms.rotation("base", "eye"), [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert transforms.age > 0 and listens() == ["/other/tf", "/other/tf_static"]
    transforms.forget()
    assert transforms.age == 0 and listens() == []
    wait_for(transforms, "eye")  # again, as it is static
    context.end()
    assert transforms.rotation("base", "eye") is None  # as of a frame that was on its way
    assert listens() == []
    publisher.unregister()


def test_a_node_that_listens_later_knows_what_the_first_one_was_told():
    """A sender's connection to a process says the last message alone to those that come later."""
    contexts = [LoadedContext(name, OF_THE_NODE, print) for name in ("/first", "/second")]
    first, second = map(made, contexts)
    publisher = sender()
    assert first.rotation("base", "eye") is None
    support.wait_for(publisher.get_num_connections, "the connection")
    for child in ("eye", "hand"):
        publisher.publish(turned(1, child))
        wait_for(first, child)
    assert second.rotation("base", "eye") is not None
    assert second.rotation("base", "hand") is not None
    first.forget()
    assert first.age == 0 and first.rotation("base", "eye") is not None
    contexts[0].end()
    publisher.publish(turned(1, "foot"))
    wait_for(second, "foot")
    contexts[1].end()
    assert listens() == []
    publisher.unregister()
