"""Foxglove's and Lichtblick's live connection: a WebSocket that all topics can be read from."""

import threading
import time
from typing import Any, List, Set, Tuple

import rospy
from tornado.ioloop import IOLoop

from ..common.throttle import Throttle
from .foxglove_socket import FoxgloveSocket
from .foxglove_topics import LOOK_PERIOD, ForwardedTopic, TopicList
from .message_topics import SharedTopics
from .operations import Operation
from .settings import Settings


class FoxgloveFeature:
    """Lets Foxglove and Lichtblick read all topics, if ~foxglove is true.

    Attributes:
        operations: none.
        routes: /foxglove.
    """

    def __init__(self, settings: Settings):
        self.operations: List[Operation] = []
        self.origins = [origin.rstrip("/").lower() for origin in settings.foxglove_origins]
        self.max_clients = settings.max_clients
        self.clients: Set[FoxgloveSocket] = set()  # used on the loop
        self.list = TopicList()
        self.session = str(time.time_ns())
        self.topics = SharedTopics(ForwardedTopic)
        self.routes: List[Any] = []
        if settings.foxglove:
            self.routes.append(("/foxglove", FoxgloveSocket, {"feature": self}))
        self._throttle = Throttle()
        self._lock = threading.Lock()  # guards the end of the thread
        self._looking = False
        self._closed = threading.Event()

    def close(self) -> None:
        self._closed.set()

    def look(self) -> None:
        """Begins to look at the topics, until there are no clients; on the loop."""
        with self._lock:
            if self._looking:
                return
            self._looking = True
        loop = IOLoop.current()
        threading.Thread(target=self._look, args=(loop,), name="foxglove", daemon=True).start()

    def _look(self, loop: IOLoop) -> None:
        while not self._closed.is_set():
            try:
                loop.add_callback(self._tell, self.list.ask())
            except OSError as error:
                if self._throttle.due():
                    rospy.logwarn("foxglove: %s", error)
            self._closed.wait(LOOK_PERIOD)
            with self._lock:
                if not self.clients:
                    self._looking = False
                    return

    def _tell(self, topics: Set[Tuple[str, str]]) -> None:
        added, gone = self.list.update(topics)
        if added or gone:
            for client in list(self.clients):
                client.tell(added, gone)
