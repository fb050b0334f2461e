"""The operation log: what nodes log, kept since the first session has looked."""

import collections
import threading
from typing import Any, Deque, Dict, Iterable, List, Optional, Set

from .fields import Number
from .log_lines import LogLine, LogTopic
from .operations import Operation
from .sessions import Session
from .settings import Settings

MAX_KEPT = 1000  # lines
MAX_PUSH = 200000  # bytes of the lines in one push, a fifth of what may wait for a page
PERIOD = 0.1  # s between two pushes


class Reader:
    """What a session is to get of the log.

    Args:
        level: The least level of its lines.
        older: The lines that it gets first.
    """

    def __init__(self, level: int, older: Iterable[LogLine]):
        self._level = level
        self._lines: Deque[LogLine] = collections.deque(maxlen=MAX_KEPT)
        self._left_out = 0
        for line in older:
            self.add(line)

    @property
    def waits(self) -> bool:
        """Whether there are lines for it."""
        return bool(self._lines)

    def add(self, line: LogLine) -> None:
        """Adds a line, in place of the oldest one if too many wait."""
        if line.level >= self._level:
            self._left_out += len(self._lines) == MAX_KEPT
            self._lines.append(line)

    def take(self) -> Dict[str, Any]:
        """Returns the newest of its lines, and how many before them it does not get."""
        entries = newest(list(self._lines))
        left_out = self._left_out + len(self._lines) - len(entries)
        self._lines.clear()
        self._left_out = 0
        return {"entries": [line._asdict() for line in entries], "left_out": left_out}


class LogFeature:
    """Pushes lines of the log to sessions: those that are kept, then what comes.

    It subscribes while a session looks. So what is kept begins with the first one, and is forgotten
    after the last. A session that has not taken a push gets no other one: lines are left out of
    what it gets then, and what else the page is sent goes on.
    """

    def __init__(self, settings: Settings):
        self.operations = [
            Operation("log", self._on_log, "view", {"level": Number(1, 16, True, default=1)}),
            Operation("close_log", self._on_close, "view"),
        ]
        self._changed = threading.Condition()  # guards all below
        self._readers: Dict[Session, Reader] = {}
        self._known: Set[Session] = set()  # those whose end is told to this object
        self._kept: Deque[LogLine] = collections.deque(maxlen=MAX_KEPT)
        self._closed = False
        self._subscribing = threading.Lock()  # held while the topic is made or closed
        self._topic: Optional[LogTopic] = None
        self._thread = threading.Thread(target=self._run, name="log", daemon=True)
        self._thread.start()

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify()
        with self._subscribing:
            if self._topic is not None:
                self._topic.close()
                self._topic = None

    def _on_log(self, session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        with self._subscribing:
            if self._topic is None:
                self._topic = LogTopic(self._on_line)
            with self._changed:
                is_new = session not in self._known
                self._known.add(session)
                self._readers[session] = Reader(request["level"], self._kept)
                self._changed.notify()
        if is_new:
            session.on_close(lambda: self._end(session))
        return {}

    def _on_close(self, session: Session, _request: Dict[str, Any]) -> Dict[str, Any]:
        self._forget(session)
        return {}

    def _end(self, session: Session) -> None:
        with self._changed:
            self._known.discard(session)
        self._forget(session)

    def _forget(self, session: Session) -> None:
        with self._subscribing:
            with self._changed:
                self._readers.pop(session, None)
                if self._readers:
                    return
                self._kept.clear()
            if self._topic is not None:
                self._topic.close()
                self._topic = None

    def _on_line(self, line: LogLine) -> None:
        with self._changed:
            self._kept.append(line)
            for reader in self._readers.values():
                reader.add(line)
            self._changed.notify()

    def _run(self) -> None:
        pause = threading.Event()  # that is never set
        while True:
            with self._changed:
                self._changed.wait_for(
                    lambda: self._closed or any(one.waits for one in self._readers.values())
                )
                if self._closed:
                    return
                self._push()
            pause.wait(PERIOD)  # so that many lines go in one push

    def _push(self) -> None:
        """Pushes lines to those who have taken what they got before. The lock must be held."""
        for session, reader in self._readers.items():
            if reader.waits and not session.has_waiting("log"):
                session.push("log", reader.take())


def newest(lines: List[LogLine]) -> List[LogLine]:
    """Returns as many of the last lines as fit into a push, the oldest first."""
    size, taken = 0, []
    for line in reversed(lines):
        size += line.size
        if size > MAX_PUSH:
            break
        taken.append(line)
    return taken[::-1]
