"""The dashboard's server without ROS, raw requests to it, and a page that tests hold in hand."""

import asyncio
import contextlib
import json
import socket
from typing import Any, Callable, Dict, Iterator, List, Optional, Tuple

from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect

from robot_vision.dashboard.access import Access
from robot_vision.dashboard.operations import Operation
from robot_vision.dashboard.server import Server, bind

TIMEOUT = 60.0  # s until a test gives up
TOKEN, VIEW_TOKEN = "token-to-control", "token-to-view"


class Served:
    """A server on a free port."""

    def __init__(
        self, *operations: Operation, address: str = "127.0.0.1", hosts: Any = (), **options: Any
    ):
        sockets = bind(address, 0)
        self.address, self.port = sockets[0].getsockname()[:2]
        self.access = Access(address, self.port, TOKEN, VIEW_TOKEN, hosts)
        self.server = Server(sockets, self.access, operations, **options)

    @property
    def host(self) -> str:
        return f"127.0.0.1:{self.port}"

    def connect(self) -> socket.socket:
        return socket.create_connection((self.address, self.port), TIMEOUT)

    def say(self, text: bytes) -> bytes:
        """All that is answered to raw bytes, until the server closes the connection."""
        with self.connect() as connection:
            connection.sendall(text)
            return b"".join(iter(lambda: connection.recv(65536), b""))

    def get(
        self,
        path: str,
        method: str = "GET",
        cookie: "Optional[Tuple[str, str]]" = None,
        **headers: str,
    ) -> "Tuple[int, Dict[str, str], str]":
        """Status, headers and body of the answer to a request; Host is ours unless it is given."""
        lines = {"Host": self.host, "Connection": "close", **headers}
        if cookie:
            lines["Cookie"] = "=".join(cookie)
        head = "".join(f"{name.replace('_', '-')}: {text}\r\n" for name, text in lines.items())
        answer = self.say(f"{method} {path} HTTP/1.1\r\n{head}\r\n".encode("latin-1"))
        start, _, body = answer.decode().partition("\r\n\r\n")
        status, *others = start.split("\r\n")
        found = dict(line.split(": ", 1) for line in others)
        return int(status.split()[1]), found, body

    @contextlib.contextmanager
    def page(self, token: str = TOKEN, **headers: str) -> Iterator["Page"]:
        """An open WebSocket."""
        page = Page(f"ws://{self.host}/ws?token={token}", headers)
        try:
            yield page
        finally:
            page.end()


class Page:
    """A WebSocket that a test reads when it likes."""

    def __init__(self, url: str, headers: Optional[Dict[str, str]] = None):
        self._loop = asyncio.new_event_loop()
        self._numbers = iter(range(1, 1000000))
        self.pushes: List[Dict[str, Any]] = []
        self.frames: List[bytes] = []
        request = HTTPRequest(url, headers=headers, request_timeout=TIMEOUT)
        self._socket = self._run(lambda: websocket_connect(request))

    def send(self, message: Any) -> None:
        text = message if isinstance(message, (str, bytes)) else json.dumps(message)
        self._run(lambda: self._socket.write_message(text, isinstance(message, bytes)))

    def read(self) -> Any:
        """The next message: JSON, the bytes of a frame, or None when the socket is closed."""
        message = self._run(self._socket.read_message)
        return json.loads(message) if isinstance(message, str) else message

    def ask(self, op: str, **fields: Any) -> Any:
        """The answer to a request: its result; raises ValueError with its error."""
        number = next(self._numbers)
        self.send({"op": op, "id": number, **fields})
        while True:
            message = self.read()
            assert message is not None, f"closed: {self.close_code} {self.close_reason}"
            if isinstance(message, bytes):
                self.frames.append(message)
            elif message.get("id") != number:
                self.pushes.append(message)
            elif "error" in message:
                raise ValueError(message["error"])
            else:
                return message["result"]

    def wait_for_end(self) -> Tuple[int, str]:
        """Reads until the server closes the socket; its code and reason."""
        while self.read() is not None:
            pass
        return self._socket.close_code, self._socket.close_reason

    @property
    def close_code(self) -> int:
        return self._socket.close_code

    @property
    def close_reason(self) -> str:
        return self._socket.close_reason

    def end_now(self) -> None:
        """Ends the connection without leave."""
        self._socket.protocol.stream.close()

    def end(self) -> None:
        async def end() -> None:
            self._socket.close()
            others = asyncio.all_tasks(self._loop) - {asyncio.current_task()}
            for task in others:
                task.cancel()
            await asyncio.gather(*others, return_exceptions=True)

        self._loop.run_until_complete(end())
        self._loop.close()

    def _run(self, work: Callable[[], Any]) -> Any:
        async def bounded() -> Any:
            return await asyncio.wait_for(work(), TIMEOUT)

        return self._loop.run_until_complete(bounded())
