"""Images for the page, each on a channel of its session."""

import contextlib
from typing import Any, Dict, List

from .channels import Channel
from .fields import Number, Text
from .image_hub import ImageHub
from .image_stream import Viewer
from .operations import Operation
from .pictures import Picture, Wish
from .sessions import MAX_CHANNEL
from .settings import Settings
from .watched_topic import Handle
from .web_video_handlers import web_video_routes

MAX_SIDE = 16384  # px that can be asked for
USUAL_QUALITY = 80  # %, of JPEG, that a page asks for unless somebody has chosen another one


class ChannelViewer(Viewer):
    """A channel of a page as a viewer: it is ready while fewer than two frames are in flight."""

    def __init__(self, session: Any, channel: Channel):
        self._session = session
        self._channel = channel

    @property
    def ready(self) -> bool:  # type: ignore[override]
        return self._channel.ready

    def show(self, picture: Picture, kind: int, data: bytes) -> None:
        self._channel.send_binary(
            kind, picture.stamp, picture.received, picture.width, picture.height, data
        )

    def fail(self, text: str) -> None:
        number = self._channel.number
        self._session.push("channel_error", {"channel": number, "text": text}, str(number))


class ImageFeature:
    """Shows images on channels, and to who asks with web_video_server's URLs.

    Attributes:
        operations: image.
        routes: /stream, /snapshot, /stream_viewer and /streams.
    """

    def __init__(self, settings: Settings, hub: ImageHub):
        self._hub = hub
        self.operations: List[Operation] = [
            Operation(
                "image",
                self._open,
                "view",
                {
                    "channel": Number(1, MAX_CHANNEL, integer=True),
                    "topic": Text(),
                    "width": Number(0, MAX_SIDE, integer=True, default=0),
                    "quality": Number(1, 100, integer=True, default=settings.quality),
                },
            )
        ]
        self._web_video = web_video_routes(hub, settings)
        self.routes = self._web_video.routes

    def close(self) -> None:
        self._web_video.close()
        self._hub.close()

    def _open(self, session: Any, fields: Dict[str, Any]) -> Dict[str, Any]:
        number = int(fields["channel"])
        channel = session.channel(number)
        viewer = ChannelViewer(session, channel)
        wish = Wish(needed=int(fields["width"]), quality=int(fields["quality"]))
        try:
            handle = self._view(fields["topic"], wish, viewer)
        except BaseException:
            session.close_channel(number)
            raise
        channel.on_ready(handle.wake)
        channel.on_close(handle.close)
        handle.wake()  # An acknowledgement may have come in between.
        return {}

    def _view(self, topic: str, wish: Wish, viewer: Viewer) -> Handle:
        """Shows a topic; what comes compressed is made smaller only if less is asked for."""
        if wish.quality < USUAL_QUALITY:
            with contextlib.suppress(ValueError):  # Of some topics only the bytes can be used.
                return self._hub.view(topic, wish, viewer, passed=False)
        return self._hub.view(topic, wish, viewer)
