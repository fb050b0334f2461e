"""Depth images as nodes take them: what is refused, and what is told of odd ones."""

import rospy

from .. import odd_depth
from ..common.depth_encodings import require_depths
from ..common.throttle import Throttle
from .transport import Frame, FrameError

FRAMES_PER_LOOK = 10  # of which one is looked at for odd depths


class DepthLook:
    """Looks at the depth images of a topic before they are used. For one thread at a time."""

    def __init__(self, topic: str) -> None:
        self._topic = topic
        self._frames = 0
        self._told = Throttle()

    def check(self, frame: Frame) -> None:
        """Warns, now and then, of depths that are none, or probably in another unit.

        Raises:
            FrameError: The image is of no depth encoding.
        """
        try:
            require_depths(frame.encoding)
        except ValueError as error:
            raise FrameError(str(error)) from None
        looks = self._frames % FRAMES_PER_LOOK == 0
        self._frames += 1
        odd = odd_depth(frame.image) if looks else ""
        if odd and self._told.due():
            rospy.logwarn("%s: %s", self._topic, odd)
