"""Messages for a node's own topics, from people who select or click something."""

import collections
import threading
from typing import Any, Tuple

import rospy

from ..ros.graph_master import graph_name, require_master

CONNECTION_TIMEOUT = 2.0  # s until the node must have connected
MAX_PUBLISHERS = 32  # that stay connected


class NodeTopics:
    """Publishes to topics of nodes. Those that were used last stay connected."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards the dictionary
        self._outputs: collections.OrderedDict[Tuple[str, str], _Output]
        self._outputs = collections.OrderedDict()

    def close(self) -> None:
        with self._lock:
            outputs, self._outputs = self._outputs, collections.OrderedDict()
        for output in outputs.values():
            output.close()

    def send(self, node: str, name: str, message: Any) -> str:
        """Publishes a message on `<node>/<name>`, and returns that in words.

        Raises:
            ValueError: The node is no name.
            OSError: Nobody subscribes to it, or the master does not answer.
        """
        topic = f"{graph_name(node)}/{name}"
        key = topic, type(message)._type
        with self._lock:
            output = self._outputs.pop(key, None)
        if output is None or not output.publisher.get_num_connections():
            if output:
                output.close()
            require_master()
            output = _Output(topic, type(message))
        try:
            output.send(message)
        except BaseException:
            output.close()
            raise
        self._keep(key, output)
        return f"sent to {topic}"

    def _keep(self, key: Tuple[str, str], output: "_Output") -> None:
        with self._lock:
            old = [self._outputs.pop(key, None)]
            self._outputs[key] = output
            if len(self._outputs) > MAX_PUBLISHERS:
                old.append(self._outputs.popitem(last=False)[1])
        for one in old:
            if one is not None:
                one.close()


class _Output(rospy.SubscribeListener):
    """A publisher that can wait for a subscriber."""

    def __init__(self, topic: str, kind: Any):
        super().__init__()
        self._topic = topic
        self._connected = threading.Event()
        self.publisher = rospy.Publisher(topic, kind, subscriber_listener=self, queue_size=10)

    def peer_subscribe(self, *_: Any) -> None:
        self._connected.set()

    def send(self, message: Any) -> None:
        # Of a connection that another publisher of this topic has, this one is not told.
        if not (self.publisher.get_num_connections() or self._connected.wait(CONNECTION_TIMEOUT)):
            raise OSError(
                f"nobody subscribes to {self._topic}: the node has ended, takes none, or rests "
                "because nobody looks at what it finds"
            )
        self.publisher.publish(message)

    def close(self) -> None:
        self.publisher.unregister()
