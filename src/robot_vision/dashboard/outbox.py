"""What waits to be sent to a page. The newest of a kind replaces the one that waits."""

import threading
from collections import OrderedDict
from typing import Any, Awaitable, Callable, Dict, Hashable, List, NamedTuple, Tuple, Union

MAX_WAITING = 1 << 20  # bytes of texts; one more than wait then is too much for the page
MAX_PACED = 16 << 20  # bytes of what channels send; no more of it is begun while as many wait

Content = Union[str, bytes, Tuple[Union[str, bytes], ...]]  # a text, or the parts of a frame


class Message(NamedTuple):
    """A message that waits.

    Attributes:
        parts: Its parts: a text, or the header and the payload of a frame, which others share.
        binary: Whether it is a frame.
        handed: Called on the loop when it is about to be written.
        paced: Whether it is of a channel, which begins no more of them while is_full() says so.
    """

    parts: Tuple[Union[str, bytes], ...]
    binary: bool = False
    handed: Callable[[], Any] = lambda: None
    paced: bool = False

    @property
    def size(self) -> int:
        """Its bytes; texts are JSON, which is ASCII."""
        return sum(map(len, self.parts))


class Outbox:
    """Sends messages one after another, each when the page's connection has taken the last one.

    Args:
        call: Calls a function on the loop soon, from any thread.
        write: Writes a text, or the parts of a frame as one message, on the loop; done when the
            operating system has taken it. It raises ConnectionError if the connection is gone.
        overflow: Called on the loop when another message comes while more than MAX_WAITING bytes
            wait. A single message may be larger: it says nothing of how the page reads.
        gone: Called on the loop when a message finds the connection gone.
    """

    def __init__(
        self,
        call: Callable[..., Any],
        write: Callable[[Content, bool], Awaitable[Any]],
        overflow: Callable[[], Any],
        gone: Callable[[], Any],
    ):
        self._call = call
        self._write = write
        self._overflow = overflow
        self._gone = gone
        self._lock = threading.Lock()
        self._messages: OrderedDict[Hashable, Message] = OrderedDict()
        self._waiting = 0  # bytes, but for what is paced
        self._paced = 0  # bytes
        self._when_room: Dict[Callable[[], Any], None] = {}  # in the order in which they asked
        self._number = 0
        self._draining = False
        self._closed = False

    def put(self, message: Message, key: Hashable = None) -> None:
        """Adds a message, in place of the one with the same key that waits. Thread-safe."""
        with self._lock:
            if self._closed:
                return
            if key is None:
                self._number += 1
                key = self._number
            before = self._messages.pop(key, None)
            if before:
                self._count(before, -1)
            full = not message.paced and self._waiting > MAX_WAITING
            self._messages[key] = message
            self._count(message, 1)
            start = not self._draining and not full
            self._draining = self._draining or start
        if full:
            self.close()
            self._call(self._overflow)
        elif start:
            self._call(self._drain)

    def has(self, key: Hashable) -> bool:
        """Returns whether a message with a key waits. Thread-safe."""
        with self._lock:
            return key in self._messages

    def discard(self, wanted: Callable[[Hashable], bool]) -> None:
        """Forgets the messages that wait whose keys are wanted no more. Thread-safe."""
        with self._lock:
            for key in [key for key in self._messages if wanted(key)]:
                self._count(self._messages.pop(key), -1)

    def is_full(self, has_room: Callable[[], Any]) -> bool:
        """Returns whether nothing paced may begin; if so has_room() is called when it may again.

        Thread-safe; has_room() is called on the loop.
        """
        with self._lock:
            full = self._paced >= MAX_PACED
            if full:
                self._when_room[has_room] = None
            return full

    def close(self) -> None:
        """Forgets all that waits, and all that comes. Thread-safe."""
        with self._lock:
            self._closed = True
            self._messages.clear()
            self._when_room.clear()
            self._waiting = self._paced = 0

    def _count(self, message: Message, sign: int) -> None:
        if message.paced:
            self._paced += sign * message.size
        else:
            self._waiting += sign * message.size

    def _take(self) -> Tuple[List[Message], List[Callable[[], Any]]]:
        """Returns the next message, if there is one, and who has to know that there is room."""
        with self._lock:
            taken = [self._messages.popitem(last=False)[1]] if self._messages else []
            for message in taken:
                self._count(message, -1)
            self._draining = bool(taken)
            waking: List[Callable[[], Any]] = []
            if self._paced < MAX_PACED:
                waking = list(self._when_room)
                self._when_room.clear()
            return taken, waking

    async def _drain(self) -> None:
        while True:
            taken, waking = self._take()
            for has_room in waking:
                has_room()
            if not taken:
                return
            (message,) = taken
            message.handed()
            content = message.parts if message.binary else message.parts[0]
            try:
                await self._write(content, message.binary)
            except ConnectionError:
                self._gone()
                self.close()
