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


def turned(quarter):
    """Says that the frame `eye` is turned in `base`, about z; a publisher to be kept."""
    transform = TransformStamped(child_frame_id="eye")
    transform.header.frame_id = "base"
    transform.transform.rotation.z = np.sin(quarter * np.pi / 4)
    transform.transform.rotation.w = np.cos(quarter * np.pi / 4)
    publisher = rospy.Publisher("/other/tf_static", TFMessage, queue_size=1, latch=True)
    publisher.publish([transform])
    return publisher


def listens():
    """The topics of transforms to which this process subscribes."""
    subscribers = dict(rosgraph.Master("/test").getSystemState()[1])
    names = ["/tf", "/tf_static", *OF_THE_NODE.values()]
    return [name for name in names if rospy.get_name() in subscribers.get(name, [])]


def test_transforms_come_on_the_topics_of_the_node_until_its_end():
    context = LoadedContext("/loaded", OF_THE_NODE, print)
    transforms = made(context)
    assert listens() == []
    publisher = turned(1)
    support.wait_for(lambda: transforms.rotation("base", "eye") is not None, "the transform")
    assert np.allclose(transforms.rotation("base", "eye"), [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert transforms.age > 0 and listens() == ["/other/tf", "/other/tf_static"]
    transforms.forget()
    assert transforms.age == 0 and listens() == []
    support.wait_for(lambda: transforms.rotation("base", "eye") is not None, "what is static again")
    context.end()
    assert transforms.rotation("base", "eye") is None  # as of a frame that was on its way
    assert listens() == []
    publisher.unregister()
