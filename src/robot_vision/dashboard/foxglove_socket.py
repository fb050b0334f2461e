"""A client of Foxglove's protocol: what it has subscribed to, and what it is sent."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict, List, Optional, Union

import rospy
from tornado.ioloop import IOLoop
from tornado.websocket import WebSocketClosedError

from ..common.plain_text import error_text
from . import foxglove_protocol as protocol
from .foxglove_queue import FairQueue
from .foxglove_topics import ForwardedTopic
from .handlers import GuardedSocket, Refused
from .web_video_viewer import limit_unsent

FILE_ORIGIN = "file://"  # of the pages of programs that are no browsers
PROTOCOL_ERROR = 1002  # code of the end of a WebSocket
MAX_TEXTS = 1000  # that wait for a client that does not read


class FoxgloveSocket(GuardedSocket):
    """A client; it needs the token in its URL, as it may be a page from elsewhere."""

    by_url_only = True

    def initialize(self, feature: Any) -> None:
        self._feature = feature
        self._queue = FairQueue()
        self._subscriptions: Dict[int, _Subscription] = {}
        self._texts: List[str] = []
        self._draining = False
        self._loop = IOLoop.current()
        # Begins and ends subscriptions in their order; the master may take long to answer.
        self._work = ThreadPoolExecutor(1, thread_name_prefix="foxglove")

    def prepare(self) -> None:
        super().prepare()
        origin = self.request.headers.get("Origin", "")
        own = not origin or self.access.origin_allowed(self.request)
        if origin == FILE_ORIGIN:  # Without a token any file that a browser opens could read.
            own = bool(self.access.token)
        if not own and origin.lower() not in self._feature.origins:
            raise Refused(
                403,
                "Another page",
                "This page may not read topics: ~foxglove_origins names those that may.",
            )
        if len(self._feature.clients) >= self._feature.max_clients:
            raise Refused(503, "Too many clients", "As many are there as ~max_clients allows.")

    def select_subprotocol(self, subprotocols: List[str]) -> Optional[str]:
        return protocol.SUBPROTOCOL if protocol.SUBPROTOCOL in subprotocols else None

    def open(self) -> None:
        if self.selected_subprotocol is None:
            self.close(PROTOCOL_ERROR, f"the subprotocol must be {protocol.SUBPROTOCOL}")
            return
        self.set_nodelay(True)
        limit_unsent(self.ws_connection.stream.socket)
        feature = self._feature
        feature.clients.add(self)
        self._say(protocol.server_info(rospy.get_name(), feature.session))
        self._say(protocol.advertise(feature.list.channels.values()))
        feature.look()

    def tell(self, added: List[Any], gone: List[int]) -> None:
        """Tells of topics that are new or gone; on the loop."""
        if gone:
            for number, one in list(self._subscriptions.items()):
                if one.channel.id in gone:
                    self._unsubscribe(number)
            self._say(protocol.unadvertise(gone))
        if added:
            self._say(protocol.advertise(added))

    async def on_message(self, message: Union[str, bytes]) -> None:
        self._answer(message)
        # No more is read before the master has been asked for all that was wanted.
        await self._loop.run_in_executor(self._work, lambda: None)

    def _answer(self, message: Union[str, bytes]) -> None:
        try:
            if isinstance(message, bytes):
                raise ValueError("this server takes no messages: it can only be read")
            request = protocol.parse_client_text(message)
        except ValueError as error:
            self._warn(str(error))
            return
        # What one of them asks for in vain, as a channel that has just gone, leaves the others.
        if isinstance(request, protocol.Subscribe):
            for number, channel in request.pairs:
                self._try(self._subscribe, number, channel)
        else:
            for number in request.ids:
                self._try(self._unsubscribe, number)

    def _try(self, work: Callable[..., None], *numbers: int) -> None:
        try:
            work(*numbers)
        except ValueError as error:
            self._warn(str(error))

    def on_close(self) -> None:
        self._feature.clients.discard(self)
        for number in list(self._subscriptions):
            self._unsubscribe(number)
        self._work.shutdown(wait=False)

    def _subscribe(self, number: int, channel_id: int) -> None:
        channel = self._feature.list.channels.get(channel_id)
        if channel is None:
            raise ValueError(f"there is no channel {channel_id}")
        if number in self._subscriptions:
            raise ValueError(f"there is a subscription {number} already")
        if any(one.channel.id == channel_id for one in self._subscriptions.values()):
            raise ValueError(f"{channel.topic} is subscribed to already")
        if len(self._subscriptions) >= protocol.MAX_SUBSCRIPTIONS:
            raise ValueError(f"there are {protocol.MAX_SUBSCRIPTIONS} subscriptions, the limit")
        self._queue.add(number)
        one = self._subscriptions[number] = _Subscription(self, number, channel)
        self._work.submit(one.begin)

    def _unsubscribe(self, number: int) -> None:
        one = self._subscriptions.pop(number, None)
        if one is None:
            raise ValueError(f"there is no subscription {number}")
        self._queue.remove(number)
        self._work.submit(one.end)

    def forward(self, number: int, time_ns: int, data: bytes) -> None:
        """Takes a message of a topic. Thread-safe."""
        self._queue.put(number, protocol.message_data(number, time_ns), data)
        self._loop.add_callback(self._start)

    def failed(self, one: "_Subscription", text: str) -> None:
        """Ends a subscription that could not begin, so that it can be tried again. Thread-safe."""

        def drop() -> None:
            if self._subscriptions.get(one.number) is one:
                self._unsubscribe(one.number)
            self._warn(text)

        self._loop.add_callback(drop)

    def _warn(self, text: str) -> None:
        self._say(protocol.status(protocol.WARNING, text))

    def _say(self, text: str) -> None:
        if len(self._texts) < MAX_TEXTS:
            self._texts.append(text)
        self._start()

    def _start(self) -> None:
        if not self._draining:
            self._draining = True
            self._loop.add_callback(self._drain)

    async def _drain(self) -> None:
        """Sends one message after another, each when the connection has taken the last one."""
        try:
            while True:
                if self._texts:
                    await self.write_message(self._texts.pop(0))
                    continue
                waiting = self._queue.take()
                if waiting is None:
                    return
                await self.write_message(waiting.head + waiting.data, binary=True)
        except WebSocketClosedError:
            pass
        finally:
            self._draining = False


class _Subscription:
    """What a client has subscribed to; begin and end are called in its worker thread."""

    def __init__(self, client: FoxgloveSocket, number: int, channel: protocol.TopicChannel):
        self.number, self.channel = number, channel
        self._client = client
        self._topics = client._feature.topics
        self._topic: Optional[ForwardedTopic] = None

    def begin(self) -> None:
        try:
            self._topic = self._topics.take(self.channel.topic)
            self._topic.add(self.channel, self._take)
        except (OSError, ValueError) as error:
            self._client.failed(self, f"{self.channel.topic}: {error_text(error)}")

    def end(self) -> None:
        if self._topic is not None:
            self._topic.remove(self._take)
            self._topics.give_back(self.channel.topic)

    def _take(self, time_ns: int, data: bytes) -> None:
        self._client.forward(self.number, time_ns, data)
