"""What all handlers of requests derive from: it lets in who may come in, and says no in words."""

import asyncio
import logging
from typing import Any, Optional

from tornado.iostream import StreamClosedError
from tornado.web import HTTPError, RequestHandler
from tornado.websocket import WebSocketHandler

from .access import Access
from .error_page import ERROR_PAGE_POLICY, OPEN_PRINTED, error_page, words_of
from .operations import may
from .pace import Pace
from .sessions import Sessions

LOG = logging.getLogger("dashboard")
POLICY = (
    "default-src 'self'; img-src 'self' blob: data:; style-src 'self'; connect-src 'self'; "
    "object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
PING_COST = 40.0  # frames that a ping counts as: browsers send none, and each is answered
HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",  # the address may have a token in it
    "Cache-Control": "no-store",
}


class Refused(HTTPError):  # noqa: N818
    """An error whose text the client is told."""

    def __init__(self, status: int, title: str, text: str):
        super().__init__(status)
        self.title = title
        self.text = text


class Guarded:
    """Checks host, origin and role of a request before anything else is done with it.

    The application's settings have "access", an Access, and "keep", BoundedServer's method.

    Attributes:
        needs: The role that is needed: "view" or "control".
        by_url_only: Whether only a token in the URL counts, and pages of other origins may ask:
            for a WebSocket that other programs use.
        role: The role that the request has.
    """

    needs = "view"
    by_url_only = False
    always_check_origin = False
    role = ""
    _is_known = False

    @property
    def access(self) -> Access:
        return self.settings["access"]

    def is_open(self) -> bool:
        """Returns whether this needs no role, for instance by a parameter."""
        return False

    def set_default_headers(self) -> None:
        self.clear_header("Server")
        for name, value in HEADERS.items():
            self.set_header(name, value)

    def prepare(self) -> None:
        if not self.access.host_allowed(self.request):
            raise Refused(
                403,
                "Another name",
                "The dashboard is not known by the name in this address. "
                "Its parameter ~hosts can name it.",
            )
        self.role = self.access.role_of(self.request, self.by_url_only)
        self._check_origin_header()
        if not self.is_open() and not may(self.role, self.needs):
            if self.role:
                raise Refused(403, "For viewing only", "This address may look, but not control.")
            raise Refused(403, "Who is there?", OPEN_PRINTED)
        self._is_known = True
        if self.role:
            self.settings["keep"](self.request)

    def write_error(self, status_code: int, **kwargs: Any) -> None:
        error = kwargs.get("exc_info", (None, None))[1]
        title, text = words_of(status_code)
        if isinstance(error, Refused):
            title, text = error.title, error.text
        if not self._is_known:
            self.set_header("Connection", "close")
        if "text/html" in self.request.headers.get("Accept", ""):
            self.set_header("Content-Type", "text/html; charset=utf-8")
            self.set_header("Content-Security-Policy", ERROR_PAGE_POLICY)
            self.finish(error_page(title, text))
        else:
            self.set_header("Content-Type", "text/plain; charset=utf-8")
            self.finish(f"{title}: {text}\n")

    def on_finish(self) -> None:
        if not self._is_known:  # or a stranger could keep us busy by one connection
            self.request.connection.stream.close()

    def log_exception(self, kind: Any, value: Optional[BaseException], trace: Any) -> None:
        if not isinstance(value, HTTPError):  # What a client does wrong is told the client.
            LOG.error("a request failed", exc_info=(kind, value, trace))

    def _check_origin_header(self) -> None:
        if self.by_url_only:
            return
        by_url = self.access.role_of(self.request, by_url_only=True)
        if self.always_check_origin and by_url and "Origin" not in self.request.headers:
            return  # a program: browsers always tell the origin
        checked = self.always_check_origin or self.request.method not in ("GET", "HEAD")
        if checked and not self.access.origin_allowed(self.request):
            raise Refused(403, "Another page", "Only the dashboard's own page may do this.")


class GuardedHandler(Guarded, RequestHandler):
    """The base of all handlers of HTTP."""


class GuardedSocket(Guarded, WebSocketHandler):
    """The base of all WebSockets; the origin is checked for each of them.

    Frames are read at a pace, of whatever kind they are: tornado reads on as long as there are
    some, and lets nobody else have a turn.

    Attributes:
        pace: What the client may send.
    """

    always_check_origin = True
    pace: Pace

    def get_websocket_protocol(self) -> Any:
        self.pace = Pace()
        protocol: Any = super().get_websocket_protocol()
        if protocol is not None:
            receive = protocol._receive_frame

            async def receive_later() -> None:
                await receive()
                seconds = self.pace.take()
                if seconds > 0.0:
                    await asyncio.sleep(seconds)
                    if protocol.stream.closed():  # else all that has come is read first
                        raise StreamClosedError

            protocol._receive_frame = receive_later
        return protocol

    def on_ping(self, _data: bytes) -> None:
        self.pace.take(PING_COST)

    def check_origin(self, origin: str) -> bool:
        return True  # prepare() has checked it.


def require_room(sessions: Sessions) -> None:
    """Refuses a request if there are as many pages as there may be."""
    if sessions.full:
        raise Refused(
            503,
            "Too many pages",
            "As many pages are open as ~max_clients allows: close another one.",
        )


class UnknownHandler(GuardedHandler):
    """Answers requests for what is not there."""

    def prepare(self) -> None:
        super().prepare()
        raise HTTPError(404)
