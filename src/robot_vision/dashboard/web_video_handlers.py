"""web_video_server's URLs: /stream, /snapshot, /stream_viewer, and its list as /streams."""

import asyncio
import contextlib
from collections import Counter
from html import escape
from typing import Any, ContextManager, Dict, Iterator, List, Set
from urllib.parse import urlencode

from tornado.ioloop import IOLoop

from .handlers import GuardedHandler, Refused
from .image_hub import Handle, ImageHub
from .image_topics import BESIDE
from .settings import Settings
from .web_video_request import BOUNDARY, ImageRequest, parse_image_request
from .web_video_viewer import HttpViewer, MultipartStream, mime_of

SNAPSHOT_TIMEOUT = 10.0  # s
PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title></head>
<body><h1>{title}</h1>{body}</body></html>
"""


class WebVideo:
    """What all these handlers share.

    Attributes:
        streams: Those that are open; of each the connection is no longer the HTTP server's.
    """

    def __init__(self, hub: ImageHub, settings: Settings):
        self.hub = hub
        self.settings = settings
        self.streams: Set[MultipartStream] = set()
        self._taken: Counter[bool] = Counter()  # places, by whether who has them has a token
        shared = {"shared": self}
        self.routes: List[Any] = [
            ("/stream", StreamHandler, shared),
            ("/snapshot", SnapshotHandler, shared),
            ("/stream_viewer", ViewerHandler, shared),
            ("/streams", ListHandler, shared),
        ]
        self._loop: Any = None

    @contextlib.contextmanager
    def place(self, known: bool) -> Iterator[None]:
        """Takes a place for a stream, or for a request that waits for an image; on the loop.

        Args:
            known: Whether it is for somebody with a token, from whom others take no places.

        Raises:
            Refused: As many are taken as may be.
        """
        self._loop = IOLoop.current()
        if self._taken[known] >= self.settings.max_clients:
            raise Refused(
                503,
                "Too many streams",
                "As many are open as ~max_clients allows: close another one.",
            )
        self._taken[known] += 1
        try:
            yield
        finally:
            self._taken[known] -= 1

    def close(self) -> None:
        """Ends all streams. Thread-safe."""
        if self._loop is not None:
            self._loop.add_callback(self._close)

    def _close(self) -> None:
        for stream in list(self.streams):
            stream.close()


def web_video_routes(hub: ImageHub, settings: Settings) -> WebVideo:
    """Returns what has the routes."""
    return WebVideo(hub, settings)


class WebVideoHandler(GuardedHandler):
    """The base of all of them."""

    def initialize(self, shared: WebVideo) -> None:
        self.shared = shared

    def is_open(self) -> bool:
        return self.shared.settings.open_streams

    def arguments(self) -> Dict[str, str]:
        """Returns the last value of each argument."""
        return {
            name: values[-1].decode("utf-8", "replace")
            for name, values in self.request.query_arguments.items()
        }

    def parsed(self) -> ImageRequest:
        try:
            return parse_image_request(self.arguments(), self.shared.settings.quality)
        except ValueError as error:
            raise Refused(400, "Not understood", str(error)) from None

    def place(self) -> ContextManager[None]:
        return self.shared.place(bool(self.role))

    async def view(self, asked: ImageRequest, viewer: HttpViewer) -> Handle:
        """Has images shown to a viewer; the master is asked in another thread."""
        hub = self.shared.hub

        def begin() -> Handle:
            topic = asked.topic
            if asked.compressed and not topic.endswith(BESIDE):
                hub.refresh()
                topic += BESIDE if hub.topics.is_published(topic + BESIDE) else ""
            return hub.view(topic, asked.wish, viewer, asked.passed)

        try:
            handle = await IOLoop.current().run_in_executor(None, begin)
        except (ValueError, OSError) as error:
            raise Refused(400, "No images", f"{asked.topic}: {error}") from None
        viewer.wake = handle.wake
        return handle


class StreamHandler(WebVideoHandler):
    """/stream: images one after another, as multipart/x-mixed-replace."""

    async def get(self) -> None:
        asked = self.parsed()
        with self.place():
            await self._stream(asked)

    async def _stream(self, asked: ImageRequest) -> None:
        viewer = HttpViewer(IOLoop.current())
        handle = await self.view(asked, viewer)
        if self.request.connection.stream.closed():
            await self._end(handle)
            return
        # Without the HTTP server, as its answers without a length come in chunks, which not all
        # programs that read such streams know.
        stream = MultipartStream(self.detach(), self._head(), viewer)
        self.shared.streams.add(stream)
        try:
            await stream.run()
        finally:
            self.shared.streams.discard(stream)
            await self._end(handle)

    def _head(self) -> bytes:
        self.set_header("Content-Type", "multipart/x-mixed-replace;boundary=" + BOUNDARY.decode())
        self.set_header("Connection", "close")
        self.set_header("Pragma", "no-cache")
        lines = [f"{name}: {value}" for name, value in self._headers.get_all()]
        return "\r\n".join(["HTTP/1.1 200 OK", *lines, "\r\n"]).encode()

    async def _end(self, handle: Handle) -> None:
        await IOLoop.current().run_in_executor(None, handle.close)


class SnapshotHandler(WebVideoHandler):
    """/snapshot: the newest image."""

    def initialize(self, shared: WebVideo) -> None:
        super().initialize(shared)
        self._viewer = HttpViewer(IOLoop.current())

    async def get(self) -> None:
        asked = self.parsed()
        with self.place():
            await self._answer(asked)

    async def _answer(self, asked: ImageRequest) -> None:
        handle = await self.view(asked, self._viewer)
        try:
            picture, kind, data = await asyncio.wait_for(self._viewer.next(), SNAPSHOT_TIMEOUT)
        except asyncio.TimeoutError:
            late = f"none has come on {asked.topic} within {SNAPSHOT_TIMEOUT:g} s"
            raise Refused(503, "No image", late) from None
        except ValueError as error:
            raise Refused(400, "No image", str(error)) from None
        finally:
            self._viewer.ready = False
            await IOLoop.current().run_in_executor(None, handle.close)
        self.set_header("Content-Type", mime_of(kind))
        self.set_header("X-Timestamp", f"{picture.stamp:.6f}")
        self.finish(data)

    def on_connection_close(self) -> None:
        self._viewer.leave()


class ViewerHandler(WebVideoHandler):
    """/stream_viewer: a page with a stream."""

    def get(self) -> None:
        asked = self.parsed()
        source = escape("/stream?" + urlencode(self.arguments()))
        title = escape(asked.topic)
        self.finish(PAGE.format(title=title, body=f'<img src="{source}" alt="{title}">'))


class ListHandler(WebVideoHandler):
    """/streams: a page with links to the streams of all topics."""

    async def get(self) -> None:
        hub = self.shared.hub
        try:
            await IOLoop.current().run_in_executor(None, hub.refresh)
        except OSError as error:
            raise Refused(503, "No master", str(error)) from None
        kept = {name: value for name, value in self.arguments().items() if name == "token"}
        items = []
        for topic in hub.topics.images():
            query = escape(urlencode({"topic": topic, **kept}))
            items.append(
                f'<li><a href="/stream_viewer?{query}">{escape(topic)}</a> '
                f'(<a href="/stream?{query}">stream</a>, '
                f'<a href="/snapshot?{query}">snapshot</a>)</li>'
            )
        body = f"<ul>{''.join(items)}</ul>" if items else "<p>There are none.</p>"
        self.finish(PAGE.format(title="Image topics", body=body))
