"""The topics that Foxglove's clients can subscribe to, and their messages."""

import contextlib
import itertools
import threading
from typing import Any, Callable, Dict, List, Optional, Set, Tuple

import rospy

from ..common.throttle import Throttle
from ..ros.graph_master import MasterCalls
from .foxglove_protocol import TopicChannel
from .message_topics import RawMessage, RawTopic, class_of

LOOK_PERIOD = 1.0  # s between two looks at the topics while a client is there
TRANSFORMS = "tf2_msgs/TFMessage"
OnMessage = Callable[[int, bytes], Any]  # time in ns, bytes


class TopicList:
    """The channels of all topics whose types are installed here."""

    def __init__(self) -> None:
        self._numbers = itertools.count(1)
        self._known: Dict[Tuple[str, str], Optional[TopicChannel]] = {}
        self.channels: Dict[int, TopicChannel] = {}

    def ask(self) -> Set[Tuple[str, str]]:
        """Asks the master for all topics, (name, type), and finds the types; not on the loop.

        Raises:
            OSError: The master does not answer.
        """
        with contextlib.closing(MasterCalls()) as master:
            topics = set(map(tuple, master.call("getPublishedTopics", "")))
        for key in sorted(topics - set(self._known)):
            self._known[key] = self._made(*key)
        return topics

    def update(self, topics: Set[Tuple[str, str]]) -> Tuple[List[TopicChannel], List[int]]:
        """Takes what ask() gave; returns channels that are new, and numbers of those gone."""
        found = (self._known[key] for key in sorted(topics))
        now = {channel.id: channel for channel in found if channel is not None}
        added = [channel for number, channel in now.items() if number not in self.channels]
        gone = [number for number in self.channels if number not in now]
        self.channels = now
        return added, gone

    def _made(self, topic: str, kind: str) -> Optional[TopicChannel]:
        try:
            schema = class_of(kind)._full_text
        except ValueError:
            return None  # There is nothing to read its messages by.
        return TopicChannel(next(self._numbers), topic, kind, schema)


class ForwardedTopic:
    """A subscription to a topic for all clients; who comes later gets a latched message, too."""

    def __init__(self, topic: str):
        self._lock = threading.Lock()  # guards all below
        self._callbacks: List[Tuple[TopicChannel, OnMessage]] = []
        # By the publisher, and the frames of transforms.
        self._latched: Dict[Tuple[str, ...], Tuple[RawMessage, int, bytes]] = {}
        self._throttle = Throttle()
        self._topic = RawTopic(topic, self._take)

    def close(self) -> None:
        self._topic.close()

    def add(self, channel: TopicChannel, callback: OnMessage) -> None:
        """Has a function called with all messages of the channel's type."""
        with self._lock:
            self._callbacks.append((channel, callback))
            latched = list(self._latched.values())
        for raw, time, data in latched:
            if raw.type == channel.type:
                callback(time, data)

    def remove(self, callback: OnMessage) -> None:
        with self._lock:
            self._callbacks = [pair for pair in self._callbacks if pair[1] != callback]

    def _take(self, raw: RawMessage) -> None:
        time, data = rospy.Time.now().to_nsec(), raw.serialized()
        frames = _frames_of(raw) if raw.latched else ()
        with self._lock:
            if raw.latched:
                self._latched[(raw.publisher, *frames)] = (raw, time, data)
            callbacks = [
                callback for channel, callback in self._callbacks if channel.type == raw.type
            ]
        for callback in callbacks:
            callback(time, data)


def _frames_of(raw: RawMessage) -> Tuple[str, ...]:
    """Returns which frames a message says the places of; none if it has no transforms.

    A node may say what is static in several messages, all of which still hold.
    """
    if raw.type != TRANSFORMS:
        return ()
    try:
        return tuple(transform.child_frame_id for transform in raw.decoded().transforms)
    except ValueError:
        return ()
