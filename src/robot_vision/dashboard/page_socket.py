"""The WebSocket of a page."""

import itertools
import logging
import struct
import time
from typing import Any, Awaitable, Callable, Dict, Optional, Tuple, Type, Union

from tornado.ioloop import IOLoop
from tornado.iostream import StreamClosedError
from tornado.locks import Event
from tornado.websocket import WebSocketClosedError

from .handlers import GuardedSocket, require_room
from .operations import OperationTable, parse_request, request_number
from .sessions import Session, Sessions
from .web_video_viewer import limit_unsent

LOG = logging.getLogger("dashboard")
BINARY = 0x82  # the first byte of a binary message that is whole
BAD_DATA, INTERNAL_ERROR = 1003, 1011  # codes of the end of a WebSocket
_numbers = itertools.count(1)


class PageSocket(GuardedSocket):
    """A session of a page: requests, answers, pushes and channels."""

    def initialize(
        self,
        table: OperationTable,
        sessions: Sessions,
        hello: Callable[[], Dict[str, Any]],
        expected: Tuple[Type[Exception], ...] = (),
    ) -> None:
        self._table = table
        self._sessions = sessions
        self._hello = hello
        self._expected = expected
        self._space = Event()
        self._session: Any = None

    def prepare(self) -> None:
        super().prepare()
        require_room(self._sessions)

    def open(self) -> None:
        self.set_nodelay(True)
        limit_unsent(self.ws_connection.stream.socket)
        loop = IOLoop.current()

        def call(function: Callable[..., Any]) -> None:
            loop.add_callback(function)

        self._session = Session(
            next(_numbers), self.role, call, self._write, self.close, self._expected
        )
        self._sessions.add(self._session)
        self._session.push("hello", {"role": self.role, **self._hello()})

    def on_message(self, message: Union[str, bytes]) -> Optional[Awaitable[Any]]:
        """Returns what is to be waited for before the next message is read, or None.

        It is no coroutine, as acknowledgements come with each frame, and a task for each of them
        costs as much as sending a frame does.
        """
        try:
            return self._take(message)
        except Exception:  # tornado would read no more, and leave the page waiting.
            LOG.exception("a message of a page failed")
            self.close(INTERNAL_ERROR, "internal error; the log of the dashboard says more")
            return None

    def _take(self, message: Union[str, bytes]) -> Optional[Awaitable[Any]]:
        if isinstance(message, bytes):
            self.close(BAD_DATA, "pages send text only")
            return None
        number = None
        try:
            request = parse_request(message)
            name = request.pop("op", None)
            if name == "ack":
                if self._session.acknowledge(request.get("channel"), request.get("seq")):
                    self.pace.give_back()
                return None
            number = request_number(request)
            if name == "ping":
                self._session.answer(number, {"time": time.time()})
                return None
            operation, values = self._table.find(name, self.role, request)
        except ValueError as error:
            self._session.refuse(number, error)
            return None
        self._session.submit(number, operation, values)
        return self._wait_for_space()

    def on_close(self) -> None:
        if self._session:
            self._session.end()
        self._space.set()

    def _wait_for_space(self) -> Optional[Awaitable[Any]]:
        """Reads no more from a page while too many of its requests wait."""
        self._space.clear()
        if self._session.is_busy(self._space.set) and not self._session.closed:
            return self._space.wait()
        return None

    async def _write(self, message: Any, binary: bool) -> None:
        try:
            await (self._write_frame(message) if binary else self.write_message(message))
        except (WebSocketClosedError, StreamClosedError):
            raise ConnectionError("the page is gone") from None

    def _write_frame(self, parts: Tuple[bytes, ...]) -> Awaitable[Any]:
        """Writes parts as one message; write_message() would copy the pixels for each page."""
        connection = self.ws_connection
        if connection is None or connection.is_closing():
            raise WebSocketClosedError
        head = binary_head(sum(map(len, parts)))
        connection.stream.write(head + parts[0])
        return connection.stream.write(parts[1])


def binary_head(size: int) -> bytes:
    """Returns what comes before a binary message of so many bytes: RFC 6455, 5.2."""
    if size < 126:
        return struct.pack("!BB", BINARY, size)
    if size < 1 << 16:
        return struct.pack("!BBH", BINARY, 126, size)
    return struct.pack("!BBQ", BINARY, 127, size)
