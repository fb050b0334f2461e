"""Where frames are to each other, as /tf and /tf_static say."""

import threading
import time
from typing import List, Optional

import numpy as np
import rospy
import tf2_ros
from tf2_msgs.msg import TFMessage

from ..common.rotations import rotation_of
from .context import current

MAX_AHEAD = rospy.Duration(10.0)  # as long as tf2 keeps what was said


class FrameTransforms:
    """Listens to the node's /tf and /tf_static from the first question on, until forget()."""

    def __init__(self) -> None:
        self._context = current()
        self._lock = threading.Lock()  # guards all below
        self._ended = False
        self._buffer: Optional[tf2_ros.Buffer] = None  # while it listens
        self._topics: List[rospy.Subscriber] = []
        self._since = 0.0  # s of the monotonic clock
        self._context.on_end(self._end)

    @property
    def age(self) -> float:
        """The time in s since it began to listen, in which not all has come yet."""
        return time.monotonic() - self._since if self._buffer else 0.0

    def rotation(self, to: str, of: str) -> Optional[np.ndarray]:
        """Returns the axes of the frame `of` in the frame `to`, (3, 3), by what was said last.

        None is returned as long as they are not known, and after the end of the node. A slash that
        a name begins with, as in times of tf_prefix, is left out.
        """
        with self._lock:
            if self._ended:
                return None
            if self._buffer is None:
                self._listen()
            buffer = self._buffer
        to, of = to.lstrip("/"), of.lstrip("/")
        if to == of:
            return np.eye(3)
        try:
            found = buffer.lookup_transform_core(to, of, rospy.Time())
        except tf2_ros.TransformException:
            return None
        turn = found.transform.rotation
        return rotation_of(np.array([turn.x, turn.y, turn.z, turn.w]))

    def forget(self) -> None:
        """Ends listening; what is static comes again when it begins anew."""
        with self._lock:
            self._forget()

    def _end(self) -> None:
        with self._lock:
            self._ended = True  # A frame may still be on its way, which would begin anew.
            self._forget()

    def _forget(self) -> None:
        for topic in self._topics:
            self._context.close(topic.unregister)
        self._topics = []
        self._buffer = None

    def _listen(self) -> None:
        self._buffer = tf2_ros.Buffer(debug=False)  # It has no service for others.
        self._since = time.monotonic()
        listener = _Listener(self._buffer)
        # tf2's own listener would take the topics of the process, however a node's are remapped.
        for name, take in ("/tf", listener.take), ("/tf_static", listener.take_static):
            self._topics.append(self._context.subscriber(name, TFMessage, take))


class _Listener:
    """Puts what comes into a buffer, as tf2_ros.TransformListener does."""

    def __init__(self, buffer: tf2_ros.Buffer) -> None:
        self._buffer = buffer
        self._lock = threading.Lock()  # guards the time, as each topic may have several threads
        self._newest = rospy.Time()

    def take(self, message: TFMessage) -> None:
        now = self._look_at_clock()
        for transform in message.transforms:
            # What is of before the time went back can be on its way when the clock's message is
            # here: tf2 would leave out what is said from then on until the time is there again.
            if not (self._is_simulated() and now and transform.header.stamp > now + MAX_AHEAD):
                self._buffer.set_transform(transform, "tf")

    def take_static(self, message: TFMessage) -> None:
        self._look_at_clock()
        for transform in message.transforms:
            self._buffer.set_transform_static(transform, "tf")

    def _look_at_clock(self) -> rospy.Time:
        """Returns the time.

        Forgets what is of a time to come, if the time went back, as when a bag begins anew.
        """
        with self._lock:
            now = rospy.Time.now()
            if now < self._newest:
                self._buffer.clear()
            self._newest = now
        return now

    @staticmethod
    def _is_simulated() -> bool:
        return not rospy.rostime.is_wallclock()
