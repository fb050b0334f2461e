"""The dashboard's server, in a thread of its own."""

import asyncio
import errno
import logging
import socket
import threading
from typing import Any, Callable, Dict, Iterable, List, Sequence, Tuple, Type

from tornado.ioloop import IOLoop
from tornado.netutil import bind_sockets
from tornado.web import Application

from ..common.plain_text import error_text
from .access import Access
from .fields import Number
from .handlers import UnknownHandler
from .http_server import BoundedServer
from .operations import Operation, OperationTable
from .page_files import FileHandler, StartHandler, file_table
from .page_socket import PageSocket
from .sessions import MAX_CHANNEL, Sessions

LOG = logging.getLogger("dashboard")
MAX_MESSAGE = 64 << 10  # bytes of a message of a page
PING_PERIOD = 20.0  # s between two pings of a WebSocket; without an answer for 60 s it is closed
END_TIMEOUT = 0.8  # s for the connections to end
MAX_PORT = 65535


class Server:
    """Serves the page, its WebSocket and what features add.

    Args:
        sockets: What to listen on, from bind().
        access: Who may do what.
        operations: What a page can ask for.
        routes: Further routes of tornado: (pattern, handler[, arguments]).
        hello: What a page is told at first, besides its role.
        max_clients: The number of pages that may be open.
        expected: Further errors of operations whose text is told to the page.
    """

    def __init__(
        self,
        sockets: List[socket.socket],
        access: Access,
        operations: Iterable[Operation] = (),
        routes: Sequence[Tuple] = (),
        hello: Callable[[], Dict[str, Any]] = dict,
        max_clients: int = 32,
        expected: Tuple[Type[Exception], ...] = (),
    ):
        self.sessions = Sessions(max_clients)
        table = OperationTable([_CLOSE_CHANNEL, *operations])
        files = {"table": file_table()}
        session = {
            "table": table,
            "sessions": self.sessions,
            "hello": lambda: {"max_clients": max_clients, **hello()},
            "expected": expected,
        }
        self._application = Application(
            [
                ("/", StartHandler, {"sessions": self.sessions, **files}),
                ("/page/([a-z0-9_.-]+)", FileHandler, files),
                ("/ws", PageSocket, session),
                *routes,
                (".*", UnknownHandler),
            ],
            access=access,
            log_function=lambda _: None,  # nobody reads a line for each request
            websocket_max_message_size=MAX_MESSAGE,
            websocket_ping_interval=PING_PERIOD,
            compress_response=True,  # of texts, as the files of the page
        )
        self._sockets = sockets
        self._started = threading.Event()
        self._thread = threading.Thread(target=self._run, name="server", daemon=True)
        self._thread.start()
        self._started.wait()

    def close(self) -> None:
        """Ends all connections and the thread; returns after at most END_TIMEOUT."""
        self._loop.add_callback(self._stop)
        self._thread.join(END_TIMEOUT)

    def _run(self) -> None:
        asyncio.set_event_loop(asyncio.new_event_loop())
        self._loop = IOLoop.current()
        self._server = BoundedServer(self._application)
        self._application.settings["keep"] = self._server.keep
        self._server.add_sockets(self._sockets)
        self._started.set()
        self._loop.start()

    async def _stop(self) -> None:
        self._server.stop()
        self.sessions.close()
        await self._server.close_all_connections()
        self._loop.stop()


def bind(address: str, port: int, tries: int = 1) -> List[socket.socket]:
    """Returns sockets that listen on a port of an address, or on one of the next if it is taken.

    Args:
        address: An address or a name of this machine; 0.0.0.0 is all of them.
        port: The port; 0 is any that is free.
        tries: How many ports are tried.

    Raises:
        ValueError: All are taken, or this machine has no such address, or may not use the port.
    """
    last = min(port + max(tries, 1) - 1, MAX_PORT) if port else 0
    for candidate in range(port, last + 1):
        try:
            return bind_sockets(candidate, address)
        except (OSError, UnicodeError) as error:  # names are encoded
            if getattr(error, "errno", None) != errno.EADDRINUSE:
                where = f"address is '{address}', port {candidate}"
                raise ValueError(
                    f"{where}: nothing can listen there: {error_text(error)}"
                ) from None
    taken = f"port {port} is" if last == port else f"the ports {port} to {last} are all"
    raise ValueError(f"{taken} taken at {address}; ~port names another one, 0 is any that is free")


def _close_channel(session: Any, fields: Dict[str, Any]) -> None:
    session.close_channel(fields["channel"])


_CLOSE_CHANNEL = Operation(
    "close_channel", _close_channel, "view", {"channel": Number(1, MAX_CHANNEL, integer=True)}
)
