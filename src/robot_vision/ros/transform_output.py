"""The frames of what a node sees, as one of its outputs."""

from typing import Callable

import rospy
from tf2_msgs.msg import TFMessage

from ..common.throttle import Throttle
from .image_node import ImageNode


class TransformOutput:
    """Publishes transforms in /tf, whose subscribers make the node work as those of others do.

    Args:
        node: The node.
        enabled: A function that returns whether to publish; while not, no subscriber counts.
        sources: What has the parent frame of the transforms; by default these are the node's
            images.
        listens: Whether the node itself may listen to transforms. It then does not work for those
            of its process that do, of which it is one.
    """

    def __init__(
        self,
        node: ImageNode,
        enabled: Callable[[], bool],
        sources: str = "",
        listens: bool = False,
    ) -> None:
        self._enabled = enabled
        self._sources = sources or f"the images of {node.topic}"
        self._topic = node.shared_publisher("/tf", TFMessage, enabled, listens)
        self._without_frame = Throttle(60.0)

    def is_wanted(self) -> bool:
        """Returns whether somebody would get transforms, which need not be made otherwise."""
        return self._enabled() and self._topic.get_num_connections() > 0

    def publish(self, message: TFMessage) -> None:
        """Publishes transforms of one parent frame, unless it has no name, which tf2 refuses."""
        if not message.transforms:
            return
        if message.transforms[0].header.frame_id:
            self._topic.publish(message)
        elif self._without_frame.due():
            rospy.logwarn("no transforms: %s have no frame_id", self._sources)
