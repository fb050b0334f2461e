"""Viewers that ask by HTTP: of a stream, which never queues, and of one image."""

import asyncio
import contextlib
import socket
from typing import Any, Callable, Optional, Tuple

from tornado.ioloop import IOLoop
from tornado.iostream import IOStream, StreamClosedError

from .channels import PNG
from .http_server import READ_SIZE, UNREAD_TIMEOUT, bytes_taken
from .image_stream import Viewer
from .pictures import Picture
from .web_video_request import BOUNDARY, part_of

REPEAT_AFTER = 0.25  # s without another image: Chromium shows one when the next one begins
MAX_UNSENT = 128 << 10  # bytes that the kernel keeps for a reader who is slower
READ_PERIOD = 0.1  # s between two looks at what a reader says, who should say nothing
# s without a word of the reader's system until it is asked, between two questions, and their number
KEEP_ALIVE = {"TCP_KEEPIDLE": 20, "TCP_KEEPINTVL": 10, "TCP_KEEPCNT": 4}
MIMES = {PNG: "image/png"}
Shown = Tuple[Picture, int, bytes]


def mime_of(kind: int) -> str:
    return MIMES.get(kind, "image/jpeg")


class HttpViewer(Viewer):
    """Takes one picture after another, each when the last one has been sent.

    Args:
        loop: The server's loop.
    """

    def __init__(self, loop: IOLoop):
        self.ready = True
        self.wake: Callable[[], Any] = lambda: None
        self._loop = loop
        self._shown: Optional[Shown] = None
        self._has_shown = False
        self._error = ""
        self._came = asyncio.Event()

    def show(self, picture: Picture, kind: int, data: bytes) -> None:
        self.ready = False
        self._has_shown = True
        self._shown = (picture, kind, data)
        self._loop.add_callback(self._came.set)

    def fail(self, text: str) -> None:
        if not self._has_shown:  # else another picture may come
            self._end(text)

    def leave(self) -> None:
        """Wakes who waits, as the connection is gone; on the loop."""
        self._end("the connection is gone")

    async def next(self) -> Shown:
        """Returns the next picture; on the loop.

        Raises:
            ValueError: There is none, and why.
        """
        while self._shown is None and not self._error:
            self._came.clear()
            await self._came.wait()
        shown, self._shown = self._shown, None
        if shown is None:
            raise ValueError(self._error)
        return shown

    async def comes_within(self, seconds: float) -> bool:
        """Waits for the next picture, or the end, and returns whether it is there; on the loop."""
        if self._shown is None and not self._error:
            self._came.clear()
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._came.wait(), seconds)
        return self._shown is not None or bool(self._error)

    def _end(self, text: str) -> None:
        self._error = text
        self._loop.add_callback(self._came.set)

    def go_on(self) -> None:
        """Takes another picture."""
        self.ready = True
        self.wake()


class MultipartStream:
    """Sends the pictures of a viewer on a connection until that is gone, or not read any more.

    Whatever the reader says is read and forgotten, as else the end of the connection behind it
    would not be noticed.

    Args:
        stream: The connection, which has been taken from its handler.
        head: The head of the answer.
        viewer: Who gets the pictures.
    """

    def __init__(self, stream: IOStream, head: bytes, viewer: HttpViewer):
        self._stream = stream
        self._head = head
        self._viewer = viewer
        stream.set_close_callback(viewer.leave)
        limit_unsent(stream.socket)
        keep_alive(stream.socket)

    async def run(self) -> None:
        reading = asyncio.ensure_future(self._read())
        try:
            await self._write(self._head + b"--" + BOUNDARY + b"\r\n")
            while True:
                picture, kind, data = await self._viewer.next()
                part = b"".join(part_of(data, mime_of(kind), picture.stamp))
                del picture, data  # or they would stay until the next one comes
                await self._write(part)
                self._viewer.go_on()
                if not await self._viewer.comes_within(REPEAT_AFTER):
                    await self._write(part)
        except (StreamClosedError, ValueError):
            pass
        finally:
            self._viewer.ready = False
            self._stream.close()
            await reading

    async def _read(self) -> None:
        with contextlib.suppress(StreamClosedError):
            while True:
                await self._stream.read_bytes(READ_SIZE, partial=True)
                await asyncio.sleep(READ_PERIOD)

    async def _write(self, data: bytes) -> None:
        """Writes; raises StreamClosedError if nothing of it is taken for UNREAD_TIMEOUT."""
        written, taken = self._stream.write(data), -1
        while not (await asyncio.wait([written], timeout=UNREAD_TIMEOUT))[0]:
            if bytes_taken(self._stream) == taken:
                self._stream.close()
            taken = bytes_taken(self._stream)
        written.result()

    def close(self) -> None:
        self._stream.close()


def limit_unsent(connection: Any) -> None:
    """Has the kernel keep less that is not sent yet, so that what is newest does not wait long."""
    if connection is not None and hasattr(socket, "TCP_NOTSENT_LOWAT"):
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, MAX_UNSENT)


def keep_alive(connection: Any) -> None:
    """Has the system notice within a minute that the other one is gone without a word."""
    if connection is not None:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        for name, value in KEEP_ALIVE.items():
            if hasattr(socket, name):
                connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)
