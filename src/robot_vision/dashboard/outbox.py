"""What waits to be sent to a page. The newest of a kind replaces the one that waits."""

import threading
from collections import OrderedDict
from typing import Any, Awaitable, Callable, Hashable, NamedTuple, Tuple, Union

MAX_WAITING = 1 << 20  # bytes of texts that may wait for a page that does not read

Content = Union[str, bytes, Tuple[Union[str, bytes], ...]]  # a text, or the parts of a frame


class Message(NamedTuple):
    """A message that waits.

    Attributes:
        parts: Its parts: a text, or the header and the payload of a frame, which others share.
        binary: Whether it is a frame.
        handed: Called on the loop when it is about to be written.
    """

    parts: Tuple[Union[str, bytes], ...]
    binary: bool = False
    handed: Callable[[], Any] = lambda: None

    @property
    def size(self) -> int:
        """The bytes that count as waiting; those of frames are bounded by their channels."""
        return 0 if self.binary else len(self.parts[0])


class Outbox:
    """Sends messages one after another, each when the page's connection has taken the last one.

    Args:
        call: Calls a function on the loop soon, from any thread.
        write: Writes a text, or the parts of a frame as one message, on the loop; done when the
            operating system has taken it. It raises ConnectionError if the connection is gone.
        overflow: Called on the loop when more than MAX_WAITING bytes wait.
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
        self._waiting = 0  # bytes
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
            self._messages[key] = message
            self._waiting += message.size - (before.size if before else 0)
            full = self._waiting > MAX_WAITING
            start = not self._draining and not full
            self._draining = self._draining or start
        if full:
            self.close()
            self._call(self._overflow)
        elif start:
            self._call(self._drain)

    def discard(self, wanted: Callable[[Hashable], bool]) -> None:
        """Forgets the messages that wait whose keys are wanted no more. Thread-safe."""
        with self._lock:
            for key in [key for key in self._messages if wanted(key)]:
                self._waiting -= self._messages.pop(key).size

    def close(self) -> None:
        """Forgets all that waits, and all that comes. Thread-safe."""
        with self._lock:
            self._closed = True
            self._messages.clear()
            self._waiting = 0

    async def _drain(self) -> None:
        while True:
            with self._lock:
                if not self._messages:
                    self._draining = False
                    return
                message = self._messages.popitem(last=False)[1]
                self._waiting -= message.size
            message.handed()
            content = message.parts if message.binary else message.parts[0]
            try:
                await self._write(content, message.binary)
            except ConnectionError:
                self._gone()
                self.close()
