"""Where frames are to each other, as /tf and /tf_static say."""

import threading
import time
from typing import Dict, List, Optional, Tuple

import numpy as np
import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from ..common.rotations import rotation_of
from .context import NodeContext, current

MAX_AHEAD = rospy.Duration(10.0)  # as long as tf2 keeps what was said


class FrameTransforms:
    """Listens to the node's /tf and /tf_static from the first question on, until forget()."""

    def __init__(self) -> None:
        self._context = current()
        self._lock = threading.Lock()  # guards all below
        self._ended = False
        self._buffer: Optional[tf2_ros.Buffer] = None  # while it listens
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
        """Ends listening; what is static is there again when it begins anew."""
        with self._lock:
            self._forget()

    def _end(self) -> None:
        with self._lock:
            self._ended = True  # A frame may still be on its way, which would begin anew.
            self._forget()

    def _forget(self) -> None:
        if self._buffer is not None:
            _leave(self._context, self._buffer)
            self._buffer = None

    def _listen(self) -> None:
        buffer = tf2_ros.Buffer(debug=False)  # It has no service for others.
        _join(self._context, buffer)
        self._buffer, self._since = buffer, time.monotonic()


class _Listener:
    """Puts what comes into buffers, as tf2_ros.TransformListener does."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards all below, as each topic may have several threads
        self._buffers: List[tf2_ros.Buffer] = []
        self._static: Dict[str, TransformStamped] = {}  # by child frame
        self._newest = rospy.Time()
        self._topics: List[rospy.Subscriber] = []

    def open(self, context: NodeContext) -> None:
        """Subscribes to the topics of a node, but not as this node, which others may outlive."""
        # tf2's own listener would take the topics of the process, however a node's are remapped.
        for name, take in ("/tf", self.take), ("/tf_static", self.take_static):
            self._topics.append(rospy.Subscriber(context.given(name), TFMessage, take))

    def close(self) -> None:
        while self._topics:
            self._topics.pop().unregister()

    def add(self, buffer: tf2_ros.Buffer) -> None:
        with self._lock:
            for transform in self._static.values():
                buffer.set_transform_static(transform, "tf")
            self._buffers.append(buffer)

    def remove(self, buffer: tf2_ros.Buffer) -> None:
        with self._lock:
            self._buffers.remove(buffer)

    def is_used(self) -> bool:
        return bool(self._buffers)

    def take(self, message: TFMessage) -> None:
        with self._lock:
            now = self._look_at_clock()
            for transform in message.transforms:
                # What is of before the time went back can be on its way when the clock's message is
                # here: tf2 would leave out what is said from then on until the time is there
                # again.
                if self._is_simulated() and now and transform.header.stamp > now + MAX_AHEAD:
                    continue
                for buffer in self._buffers:
                    buffer.set_transform(transform, "tf")

    def take_static(self, message: TFMessage) -> None:
        with self._lock:
            self._look_at_clock()
            for transform in message.transforms:
                self._static[transform.child_frame_id] = transform
                for buffer in self._buffers:
                    buffer.set_transform_static(transform, "tf")

    def _look_at_clock(self) -> rospy.Time:
        """Returns the time.

        Forgets what is of a time to come, if the time went back, as when a bag begins anew.
        """
        now = rospy.Time.now()
        if now < self._newest:
            for buffer in self._buffers:
                buffer.clear()
        self._newest = now
        return now

    @staticmethod
    def _is_simulated() -> bool:
        return not rospy.rostime.is_wallclock()


# By the names of both topics. A process has one connection to each sender, which says all that is
# static at its beginning only; so a node that listens later shares the listener of the first one.
_listeners: Dict[Tuple[str, str], _Listener] = {}
_listeners_lock = threading.Lock()


def _join(context: NodeContext, buffer: tf2_ros.Buffer) -> None:
    """Has a buffer get what is said on the topics of a node, and what is static of before."""
    names = context.resolve("/tf"), context.resolve("/tf_static")
    with _listeners_lock:
        if names not in _listeners:
            listener = _Listener()
            listener.open(context)
            _listeners[names] = listener
        _listeners[names].add(buffer)


def _leave(context: NodeContext, buffer: tf2_ros.Buffer) -> None:
    """Has a buffer get no more; with the last one the process ends listening."""
    names = context.resolve("/tf"), context.resolve("/tf_static")
    with _listeners_lock:
        _listeners[names].remove(buffer)
        if not _listeners[names].is_used():
            _listeners.pop(names).close()
