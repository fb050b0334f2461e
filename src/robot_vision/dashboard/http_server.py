"""tornado's HTTP server with a limit on connections of strangers."""

import re
from collections import OrderedDict
from typing import Any, Awaitable, Dict, Optional, Tuple, Union

from tornado.httpserver import HTTPServer
from tornado.httputil import (
    HTTPHeaders,
    HTTPMessageDelegate,
    HTTPServerRequest,
    RequestStartLine,
    ResponseStartLine,
)
from tornado.ioloop import PeriodicCallback
from tornado.iostream import IOStream

MAX_CONNECTIONS = 256  # of HTTP; WebSockets have a limit of their own
HEADER_TIMEOUT = 10.0  # s for the whole head of a request, and between two of them
BODY_TIMEOUT = 10.0  # s for the body of a request
UNREAD_TIMEOUT = 30.0  # s in which a client has to take something of an answer that waits for it
MAX_HEADER = 16 << 10  # bytes
MAX_BODY = 64 << 10  # bytes
READ_SIZE = 8 << 10  # bytes that are read at once, and so of requests that wait in a closed stream


def bytes_taken(stream: IOStream) -> int:
    """Returns how much of what was written on a connection the system has taken so far."""
    return int(stream._total_write_done_index)


class BoundedServer(HTTPServer):
    """Closes the oldest connection of nobody in particular when there are too many.

    So connections that say nothing, say it slowly, or do not read what they are answered cannot
    keep others out, nor use up the process's open files. What may stay is what keep() names, as
    long as it reads its answers.
    """

    def initialize(self, application: Any) -> None:
        super().initialize(
            application,
            idle_connection_timeout=HEADER_TIMEOUT,
            body_timeout=BODY_TIMEOUT,
            max_header_size=MAX_HEADER,
            max_body_size=MAX_BODY,
            chunk_size=READ_SIZE,
        )
        self._strangers: OrderedDict[IOStream, None] = OrderedDict()  # oldest first
        self._taken: Dict[IOStream, int] = {}  # bytes, of connections with an answer that waits
        PeriodicCallback(self._close_unread, UNREAD_TIMEOUT * 1000.0).start()

    def keep(self, request: HTTPServerRequest) -> None:
        """Keeps the connection of a request until the next one, as it is of somebody known."""
        self._strangers.pop(request.connection.stream, None)

    def handle_stream(self, stream: IOStream, address: Tuple) -> None:
        self._strangers[stream] = None
        super().handle_stream(stream, address)
        if len(self._connections) > MAX_CONNECTIONS:  # Some of them may be closed already.
            opened = sum(not one.stream.closed() for one in self._connections)
            if opened > MAX_CONNECTIONS:
                self._close_oldest()

    def start_request(self, server_conn: Any, request_conn: Any) -> HTTPMessageDelegate:
        self._strangers.pop(server_conn.stream, None)
        if server_conn.stream.closed():  # What was read before is requests that nobody waits for.
            return HTTPMessageDelegate()
        self._strangers[server_conn.stream] = None
        return _WithPlainBody(super().start_request(server_conn, request_conn))

    def _close_oldest(self) -> None:
        while self._strangers:
            stream = self._strangers.popitem(last=False)[0]
            if not stream.closed():
                stream.close()
                break

    def _close_unread(self) -> None:
        """Closes connections whose client has taken nothing of what waits since the last call."""
        streams = [one.stream for one in self._connections]
        taken = {one: bytes_taken(one) for one in streams if one.writing()}
        for stream, count in taken.items():
            if self._taken.get(stream) == count:
                stream.close()
        self._taken = taken

    def on_close(self, server_conn: Any) -> None:
        self._strangers.pop(server_conn.stream, None)
        super().on_close(server_conn)


class _WithPlainBody(HTTPMessageDelegate):
    """Has requests refused whose body has no length in plain digits before it is read.

    tornado 6.2 waits without end, with the whole loop, on a chunk that claims a negative size. No
    browser sends chunks.
    """

    def __init__(self, taker: HTTPMessageDelegate):
        self._taker = taker

    def headers_received(
        self, start_line: Union[RequestStartLine, ResponseStartLine], headers: HTTPHeaders
    ) -> Optional[Awaitable[None]]:
        length = headers.get("Content-Length", "0")
        if "Transfer-Encoding" in headers or not re.fullmatch("[0-9]{1,18}", length):
            headers["Content-Length"] = "none"  # tornado answers that it is malformed
        return self._taker.headers_received(start_line, headers)

    def data_received(self, chunk: bytes) -> Optional[Awaitable[None]]:
        return self._taker.data_received(chunk)

    def finish(self) -> None:
        self._taker.finish()

    def on_connection_close(self) -> None:
        self._taker.on_connection_close()
