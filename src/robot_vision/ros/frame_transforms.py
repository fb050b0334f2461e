"""Where frames are to each other, as /tf and /tf_static say."""

import time
from typing import Optional

import numpy as np
import rospy
import tf2_ros

from ..common.rotations import rotation_of
from .context import current


class FrameTransforms:
    """Listens to /tf and /tf_static from the first question on, until forget()."""

    def __init__(self) -> None:
        self._listener: Optional[tf2_ros.TransformListener] = None
        self._buffer: Optional[tf2_ros.Buffer] = None
        self._since = 0.0  # s of the monotonic clock
        current().on_end(self.forget)

    @property
    def age(self) -> float:
        """The time in s since it began to listen, in which not all has come yet."""
        return time.monotonic() - self._since if self._listener else 0.0

    def rotation(self, to: str, of: str) -> Optional[np.ndarray]:
        """Returns the axes of the frame `of` in the frame `to`, (3, 3), by what was said last.

        None is returned as long as they are not known. A slash that a name begins with, as in
        times of tf_prefix, is left out.
        """
        if self._listener is None:
            self._buffer = tf2_ros.Buffer(debug=False)  # It has no service for others.
            self._listener = tf2_ros.TransformListener(self._buffer)
            self._since = time.monotonic()
        to, of = to.lstrip("/"), of.lstrip("/")
        if to == of:
            return np.eye(3)
        try:
            found = self._buffer.lookup_transform_core(to, of, rospy.Time())
        except tf2_ros.TransformException:
            return None
        turn = found.transform.rotation
        return rotation_of(np.array([turn.x, turn.y, turn.z, turn.w]))

    def forget(self) -> None:
        """Ends listening; what is static comes again when it begins anew."""
        if self._listener is not None:
            self._listener.unregister()
            self._listener = None
