"""Gives a bag to a browser, in parts, at the browser's pace."""

import asyncio
import contextlib
import os
from typing import BinaryIO, Iterator

from tornado.ioloop import IOLoop
from tornado.iostream import StreamClosedError

from .bag_files import BagFolder
from .handlers import GuardedHandler, Refused

CHUNK = 256 << 10  # bytes, read from the disk in a worker thread and sent before the next
TIMEOUT = 60.0  # s, in which the client has to take one
MAX_DOWNLOADS = 8  # at a time


class Downloads:
    """Counts the downloads that are going on; only the server's thread uses it."""

    def __init__(self) -> None:
        self._count = 0

    @contextlib.contextmanager
    def one_more(self) -> Iterator[None]:
        """Counts one; raises Refused if there are too many."""
        if self._count >= MAX_DOWNLOADS:
            raise Refused(503, "Too many downloads", f"{MAX_DOWNLOADS} bags are being downloaded.")
        self._count += 1
        try:
            yield
        finally:
            self._count -= 1


class BagHandler(GuardedHandler):
    """Gives the bag of the name in the path, for who may control."""

    needs = "control"

    def initialize(self, folder: BagFolder, downloads: Downloads) -> None:
        self._folder = folder
        self._downloads = downloads

    async def get(self, name: str) -> None:
        with self._downloads.one_more():
            try:
                file = await IOLoop.current().run_in_executor(None, self._folder.open, name)
            except ValueError as error:
                raise Refused(400, "No bag", f"{error}.") from None
            except OSError:
                raise Refused(404, "No bag", "There is no bag of this name.") from None
            with file:
                size = os.fstat(file.fileno()).st_size
                self.set_header("Content-Type", "application/octet-stream")
                self.set_header("Content-Disposition", f'attachment; filename="{name}"')
                self.set_header("Content-Length", str(size))
                self.set_header("Cross-Origin-Resource-Policy", "same-origin")
                with contextlib.suppress(StreamClosedError):  # The client has enough.
                    await self._send(file, size)

    async def _send(self, file: BinaryIO, size: int) -> None:
        left = size
        while left > 0:
            chunk = await IOLoop.current().run_in_executor(None, file.read, min(CHUNK, left))
            if not chunk:  # Somebody has cut the file: the client sees that something is missing.
                break
            left -= len(chunk)
            self.write(chunk)
            try:
                await asyncio.wait_for(asyncio.ensure_future(self.flush()), TIMEOUT)
            except asyncio.TimeoutError:
                break
        if left > 0:
            self.request.connection.stream.close()
