"""The sessions of pages: one for each WebSocket."""

import logging
import queue
import threading
import traceback
from typing import Any, Awaitable, Callable, Dict, Hashable, List, Optional, Tuple, Type

from ..common.plain_text import error_text
from ..common.throttle import Throttle
from .channels import Channel
from .encoding import to_json
from .operations import Operation
from .outbox import Content, Message, Outbox

LOG = logging.getLogger("dashboard")
MAX_CHANNELS = 64  # of a session
MAX_CHANNEL = 65535  # the largest number of a channel
MAX_BACKLOG = 32  # requests of a session that may wait; more are not read before
GOING_AWAY, POLICY_VIOLATION = 1001, 1008  # codes of the end of a WebSocket
EXPECTED = (ValueError, OSError)  # errors whose text is told to the page

_failure_throttle = Throttle()


class Session:
    """One page, or another client of the WebSocket.

    Attributes:
        id: A number that no other session of this process has.
        role: "view" or "control".
        closed: Whether the connection is gone.

    Args:
        number: The id.
        role: The role.
        call: Calls a function on the loop soon, from any thread.
        write: Writes a message, on the loop; see Outbox.
        finish: Closes the connection with a code of WebSockets and a reason, on the loop.
        expected: Further errors of operations whose text is told to the page.
    """

    def __init__(
        self,
        number: int,
        role: str,
        call: Callable[..., Any],
        write: Callable[[Content, bool], Awaitable[Any]],
        finish: Callable[[int, str], Any],
        expected: Tuple[Type[Exception], ...] = (),
    ):
        self.id = number
        self.role = role
        self.closed = False
        self._call = call
        self.finish = finish
        self._expected = EXPECTED + expected
        self._outbox = Outbox(call, write, self._overflow, self.end)
        self._lock = threading.Lock()
        self._channels: Dict[int, Channel] = {}
        self._on_close: List[Callable[[], Any]] = []
        self._work: queue.SimpleQueue[Optional[Callable[[], Any]]] = queue.SimpleQueue()
        self._worker: Optional[threading.Thread] = None
        self._backlog = 0
        self._has_space: Callable[[], Any] = lambda: None

    def push(self, kind: str, data: Dict[str, Any], key: str = "") -> None:
        """Sends something that the page has not asked for just now. Thread-safe.

        A push that still waits for the connection is replaced by the next one of the same kind and
        key: of pushes that add to one another, as lines of a log, only one may wait.
        """
        self._send({"push": kind, "data": data}, ("push", kind, key))

    def has_waiting(self, kind: str, key: str = "") -> bool:
        """Returns whether a push of a kind and key waits for the connection. Thread-safe."""
        return self._outbox.has(("push", kind, key))

    def channel(self, number: int) -> Channel:
        """Opens a channel.

        Args:
            number: The number that the page has chosen for it.

        Raises:
            ValueError: The number is taken, or there are too many channels.
        """
        with self._lock:
            if self.closed:
                raise ValueError("the session is closed")
            if number in self._channels:
                raise ValueError(f"channel {number} is open already, must be closed before")
            if not 1 <= number <= MAX_CHANNEL:
                raise ValueError(f"channel is {number}, must be from 1 to {MAX_CHANNEL}")
            if len(self._channels) >= MAX_CHANNELS:
                raise ValueError(f"the page has {MAX_CHANNELS} open channels, which is the limit")
            channel = self._channels[number] = Channel(number, self._outbox)
        return channel

    def close_channel(self, number: int) -> None:
        """Closes a channel if it is open."""
        with self._lock:
            channel = self._channels.pop(number, None)
        if channel:
            channel.close()

    def on_close(self, callback: Callable[[], Any]) -> None:
        """Has a function called in a worker thread when the session ends, at once if it has."""
        with self._lock:
            if not self.closed:
                self._on_close.append(callback)
                return
        callback()

    # What follows is for the WebSocket's handler, and called on the loop.

    def acknowledge(self, number: Any, seq: Any) -> bool:
        """Takes the page's word that it has drawn a frame of a channel; returns whether it had."""
        channel = self._channels.get(number) if type(number) is int else None
        return channel is not None and channel.acknowledge(seq)

    def answer(self, number: int, result: Any) -> None:
        self._send({"id": number, "result": result})

    def refuse(self, number: Optional[int], error: Exception) -> None:
        self._send({"id": number, "error": error_text(error)})

    def submit(self, number: int, operation: Operation, values: Dict[str, Any]) -> None:
        """Has an operation run after those that were submitted before, or beside them."""
        self._backlog += 1  # which bounds the threads, too
        if operation.beside:
            work = (number, operation, values)
            threading.Thread(target=self._run, args=work, name=operation.name, daemon=True).start()
        else:
            self._do(lambda: self._run(number, operation, values))

    def is_busy(self, has_space: Callable[[], Any]) -> bool:
        """Returns whether too many requests wait; the function is called when they do no more."""
        self._has_space = has_space
        return self._backlog >= MAX_BACKLOG

    def end(self) -> None:
        """Takes note that the connection is gone."""
        with self._lock:
            if self.closed:
                return
            self.closed = True
        self._outbox.close()
        if self._worker or self._channels or self._on_close:
            self._do(self._close)
            self._work.put(None)

    def is_working(self) -> bool:
        """Returns whether the session's thread is there, which may outlast the connection."""
        return self._worker is not None and self._worker.is_alive()

    def _overflow(self) -> None:
        self.finish(POLICY_VIOLATION, "the page does not read what it is sent")

    def _send(self, data: Dict[str, Any], key: Hashable = None) -> None:
        self._outbox.put(Message((to_json(data),)), key)

    def _do(self, work: Callable[[], Any]) -> None:
        if self._worker is None:
            # It must not keep the process alive: an operation may wait for a service.
            name = f"session {self.id}"
            self._worker = threading.Thread(target=self._work_on, name=name, daemon=True)
            self._worker.start()
        self._work.put(work)

    def _work_on(self) -> None:
        for work in iter(self._work.get, None):
            work()

    def _run(self, number: int, operation: Operation, values: Dict[str, Any]) -> None:
        try:
            if not self.closed:
                self.answer(number, operation.run(self, values))
        except self._expected as error:
            self.refuse(number, error)
        except Exception:
            self.refuse(number, ValueError("internal error; the log of the dashboard says more"))
            if _failure_throttle.due():
                LOG.error("the operation %s failed:\n%s", operation.name, traceback.format_exc())
        self._call(self._finished)

    def _finished(self) -> None:
        self._backlog -= 1
        if self._backlog < MAX_BACKLOG:
            self._has_space()

    def _close(self) -> None:
        with self._lock:
            channels, self._channels = list(self._channels.values()), {}
            callbacks, self._on_close = self._on_close, []
        for callback in [channel.close for channel in channels] + callbacks:
            try:
                callback()
            except Exception:
                if _failure_throttle.due():
                    LOG.error("a session did not end well:\n%s", traceback.format_exc())


class Sessions:
    """The sessions that are open, and those whose last operation still runs."""

    def __init__(self, max_clients: int):
        self._max_clients = max_clients
        self._sessions: Dict[int, Session] = {}

    @property
    def full(self) -> bool:
        """Whether there are as many sessions as there may be; on the loop."""
        for number, session in list(self._sessions.items()):
            if session.closed and not session.is_working():
                del self._sessions[number]
        opened = sum(not session.closed for session in self._sessions.values())
        # Each session has a thread, which may have to wait for a service after its page has gone.
        return opened >= self._max_clients or len(self._sessions) >= 2 * self._max_clients

    def add(self, session: Session) -> None:
        self._sessions[session.id] = session

    def close(self) -> None:
        """Closes the connections of all sessions; on the loop."""
        for session in self._sessions.values():
            if not session.closed:
                session.finish(GOING_AWAY, "the dashboard ends")
