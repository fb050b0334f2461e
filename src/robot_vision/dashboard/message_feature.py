"""The operations messages and rate: any topic as JSON, and how much comes on it."""

import threading
import time
from typing import Any, Dict, List, Optional, Tuple

from ..common.plain_text import error_text
from .channels import Channel
from .fields import Number, Text
from .message_json import stamp_of, to_plain
from .message_topics import RawMessage, RawTopic, SharedTopics
from .operations import Operation
from .sessions import Session
from .settings import Settings

MAX_RATE = 1000.0  # Hz
MAX_PERIOD = 3600.0  # s between two messages; threads can wait for a limited time only
RATE_TIME = 2.0  # s that a rate is measured for
RATE_MIN_COUNT = 100  # messages that are enough for a rate before that


class MessageFeature:
    """Sends the messages of topics to the channels of sessions, and measures their rates."""

    def __init__(self, settings: Settings):
        self._topics = SharedTopics(MessageTopic)
        self.operations = [
            Operation(
                "messages",
                self._on_messages,
                "view",
                {
                    "channel": Number(1, 65535, integer=True),
                    "topic": Text(),
                    "rate": Number(0.0, MAX_RATE, default=0.0),
                },
            ),
            Operation("rate", self._on_rate, "view", {"topic": Text()}, beside=True),
        ]

    def close(self) -> None:
        """All topics end with the channels."""

    def _on_messages(self, session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        channel = session.channel(request["channel"])
        name = request["topic"]
        try:
            topic = self._topics.take(name)
        except BaseException:
            session.close_channel(channel.number)
            raise
        topic.add(channel, request["rate"])
        channel.on_close(lambda: (topic.remove(channel), self._topics.give_back(name)))
        return {}

    def _on_rate(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        counter = _Counter()
        topic = RawTopic(request["topic"], counter.add)
        try:
            counter.enough.wait(RATE_TIME)
        finally:
            topic.close()
        return counter.result()


class _Counter:
    """Counts messages from the first one on."""

    def __init__(self) -> None:
        self.enough = threading.Event()
        self._lock = threading.Lock()  # guards all below
        self._times: List[float] = []  # s of the monotonic clock
        self._bytes = 0

    def add(self, message: RawMessage) -> None:
        with self._lock:
            if self.enough.is_set():
                return
            self._times.append(time.monotonic())
            self._bytes += len(message.serialized())
            if len(self._times) > RATE_MIN_COUNT and self._times[-1] - self._times[0] > 1.0:
                self.enough.set()

    def result(self) -> Dict[str, Any]:
        """Returns messages per s and bytes per s, both null for less than two messages."""
        with self._lock:
            count = len(self._times)
            span = self._times[-1] - self._times[0] if count > 1 else 0.0
            rate = (count - 1) / span if span > 0.0 else None
            bandwidth = None if rate is None else rate * self._bytes / count
            return {"rate": rate, "bandwidth": bandwidth, "count": count}


class _Taker:
    """A channel that messages go to."""

    def __init__(self, channel: Channel, rate: float):
        self.channel = channel
        self.period = min(1.0 / rate, MAX_PERIOD) if rate else 0.0  # s
        self.due = 0.0  # s of the monotonic clock, when it may get the next message
        self.sent = 0  # the number of the last one


class MessageTopic:
    """A topic whose newest message goes, as JSON, to each channel that is ready for it.

    It is converted once for all channels, in a thread of its own, and only if one is ready.

    Args:
        name: The name of the topic.

    Raises:
        ValueError, OSError: It cannot be subscribed to.
    """

    def __init__(self, name: str):
        self._changed = threading.Condition()  # guards all below
        self._takers: Dict[Channel, _Taker] = {}
        self._newest: Optional[RawMessage] = None
        self._number = 0  # of the newest
        self._closed = False
        self._topic = RawTopic(name, self._on_message)
        self._thread = threading.Thread(target=self._run, name=f"messages {name}", daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._topic.close()
        with self._changed:
            self._closed = True
            self._changed.notify()

    def add(self, channel: Channel, rate: float) -> None:
        """Sends messages to a channel, at most `rate` in a second; 0: as many as it takes."""
        channel.on_ready(self._wake)
        with self._changed:
            self._takers[channel] = _Taker(channel, rate)
            self._changed.notify()

    def remove(self, channel: Channel) -> None:
        with self._changed:
            self._takers.pop(channel, None)

    def _wake(self) -> None:
        with self._changed:
            self._changed.notify()

    def _on_message(self, message: RawMessage) -> None:
        with self._changed:
            self._newest = message
            self._number += 1
            self._changed.notify()

    def _run(self) -> None:
        while True:
            takers, message = self._next()
            if message is None:
                return
            try:
                decoded = message.decoded()
                data, stamp = to_plain(decoded), stamp_of(decoded)
            except Exception as error:  # Whatever it is, the next message may be better.
                data, stamp = {"_error": error_text(error)}, 0.0
            data["_type"] = message.type
            for taker in takers:
                taker.channel.send_message(data, stamp or message.ros_time, message.received)

    def _next(self) -> Tuple[List[_Taker], Optional[RawMessage]]:
        """Waits until a message can be sent; returns it and whom to, or None at the end."""
        with self._changed:
            while not self._closed:
                now = time.monotonic()
                behind = [
                    taker
                    for taker in self._takers.values()
                    if taker.sent != self._number and taker.channel.ready
                ]
                takers = [taker for taker in behind if taker.due <= now]
                if takers and self._newest is not None:
                    for taker in takers:
                        taker.sent = self._number
                        taker.due = max(taker.due, now - taker.period) + taker.period
                    return takers, self._newest
                waits = [taker.due - now for taker in behind]
                self._changed.wait(max(min(waits), 0.0) if waits else None)
        return [], None
