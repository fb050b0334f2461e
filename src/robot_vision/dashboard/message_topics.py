"""Subscriptions of the dashboard by rospy, all of them to bytes.

rospy has one class of messages for each topic of a process, that of whoever subscribes first. So
who takes bytes here must not meet somebody who takes messages. Also bytes cost nothing until they
are needed, and a topic may change its type.
"""

import functools
import importlib.util
import io
import os
import threading
import time
from typing import Any, Callable, Dict, Hashable, NamedTuple, Optional, Type

import genpy
import roslib.message
import rospy

from ..common.plain_text import printable
from ..common.throttle import Throttle
from ..ros.graph_master import graph_name, require_master

MAX_CLASSES = 500  # message types whose classes are kept


class RawMessage(NamedTuple):
    """A message as it came."""

    type: str  # such as std_msgs/String
    md5sum: str
    data: bytes  # empty if others in this process have it decoded: see serialized()
    received: float  # s of the wall clock
    publisher: str  # the name of the node
    message: Any = None  # the same if others in this process have it decoded, else None
    latched: bool = False  # whether who comes later is to get it, too
    ros_time: float = 0.0  # s of ROS' clock, when it came

    def decoded(self) -> Any:
        """Returns the message.

        Raises:
            ValueError: Its type is not installed here, or another version; or it is damaged.
        """
        if self.message is not None:
            return self.message
        kind = class_of(self.type)
        if kind._md5sum != self.md5sum:
            raise ValueError(f"{printable(self.type)} is installed here in another version")
        try:
            return kind().deserialize(self.data)
        except (genpy.DeserializationError, UnicodeDecodeError) as error:
            says = printable(str(error), 200)
            raise ValueError(f"a message of {printable(self.type)} is damaged: {says}") from None

    def serialized(self) -> bytes:
        """Returns the bytes, also of what others have decoded."""
        if self.message is None:
            return self.data
        buffer = io.BytesIO()
        self.message.serialize(buffer)
        return buffer.getvalue()


@functools.lru_cache(maxsize=MAX_CLASSES)
def class_of(kind: str) -> Type[Any]:
    """Returns the class of a message type.

    Raises:
        ValueError: It is not installed here.
    """
    found = None
    package, _, name = kind.partition("/")
    try:
        if name.isidentifier() and _has_messages(package):
            found = roslib.message.get_message_class(kind)
    except Exception:  # whatever the import of a broken package raises
        found = None
    if found is None:
        raise ValueError(f"the type {printable(kind)} is not installed here")
    return found


def _has_messages(package: str) -> bool:
    """Tells without an import, as anybody may name a type, and any module by that."""
    spec = importlib.util.find_spec(package) if package.isidentifier() else None
    folders = spec.submodule_search_locations if spec else None
    return any(os.path.isdir(os.path.join(folder, "msg")) for folder in folders or ())


class RawTopic:
    """A subscription to a topic of any type, which may change.

    Args:
        topic: The whole name of the topic.
        callback: The function that gets each RawMessage in a thread of rospy; it must be quick.

    Raises:
        ValueError: The topic is no name.
        OSError: The master does not answer.
    """

    def __init__(self, topic: str, callback: Callable[[RawMessage], Any]):
        self.topic = graph_name(topic)
        self._callback = callback
        self._throttle = Throttle()
        require_master()
        self._subscriber = rospy.Subscriber(topic, rospy.AnyMsg, self._on_message, tcp_nodelay=True)

    def close(self) -> None:
        """Ends the subscription; does not raise if it has ended."""
        self._subscriber.unregister()

    def _on_message(self, message: Any) -> None:
        header = message._connection_header
        raw = isinstance(message, rospy.AnyMsg)
        try:
            self._callback(
                RawMessage(
                    str(header.get("type", message._type)),
                    str(header.get("md5sum", message._md5sum)),
                    message._buff if raw else b"",
                    time.time(),
                    str(header.get("callerid", "")),
                    None if raw else message,
                    header.get("latching") == "1",
                    rospy.get_time(),
                )
            )
        except ValueError as error:
            if self._throttle.due():
                rospy.logwarn("%s: %s", self.topic, error)


class SharedTopics:
    """One subscription for all who want the same, gone with the last of them.

    Args:
        make: The function that makes what is shared of a topic, or another key; it has close().
    """

    def __init__(self, make: Callable[[Any], Any]):
        self._make = make
        self._lock = threading.Lock()  # guards all below; nothing that can hang is done with it
        self._shared: Dict[Hashable, _Entry] = {}

    def take(self, topic: Hashable) -> Any:
        """Returns what is shared of a topic, for as many calls of give_back().

        Raises:
            ValueError, OSError: `make` has raised it.
        """
        with self._lock:
            entry = self._shared.setdefault(topic, _Entry())
            entry.users += 1
        try:
            with entry.lock:
                if entry.object is None:
                    entry.object = self._make(topic)
        except BaseException:
            self._leave(topic, entry)
            raise
        return entry.object

    def give_back(self, topic: Hashable) -> None:
        """Ends the use that began with take()."""
        with self._lock:
            entry = self._shared.get(topic)
        if entry is not None:
            self._leave(topic, entry)

    def _leave(self, topic: Hashable, entry: "_Entry") -> None:
        with self._lock:
            entry.users -= 1
            if entry.users:
                return
            del self._shared[topic]
        with entry.lock:
            if entry.object is not None:
                entry.object.close()


class _Entry:
    def __init__(self) -> None:
        self.lock = threading.Lock()  # held while the object is made
        self.users = 0
        self.object: Optional[Any] = None
