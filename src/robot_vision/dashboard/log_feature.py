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
MAX_PUSH = 200000  # bytes of the lines in one push; a page gets a fifth of what may wait
PERIOD = 0.1  # s between two pushes


class LogFeature:
    """Pushes lines of the log to sessions: those that are kept, then what comes.

    It subscribes while a session looks. So what is kept begins with the first one, and is forgotten
    after the last.
    """

    def __init__(self, settings: Settings):
        self.operations = [
            Operation("log", self._on_log, "view", {"level": Number(1, 16, True, default=1)}),
            Operation("close_log", self._on_close, "view"),
        ]
        self._changed = threading.Condition()  # guards all below
        self._levels: Dict[Session, int] = {}
        self._known: Set[Session] = set()  # those whose end is told to this object
        self._kept: Deque[LogLine] = collections.deque(maxlen=MAX_KEPT)
        self._new: Deque[LogLine] = collections.deque(maxlen=MAX_KEPT)
        self._left_out: Dict[Session, int] = {}  # lines that came too fast, not told yet
        self._pushes = 0
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
                self._levels[session] = request["level"]
                older = list(self._kept)[: max(len(self._kept) - len(self._new), 0)]
                self._push([session], older)  # what is new comes with the next push to all
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
                self._levels.pop(session, None)
                self._left_out.pop(session, None)
                if self._levels:
                    return
                self._kept.clear()
                self._new.clear()
            if self._topic is not None:
                self._topic.close()
                self._topic = None

    def _on_line(self, line: LogLine) -> None:
        with self._changed:
            if len(self._new) == MAX_KEPT:
                self._leave_out(self._new[0])
            self._new.append(line)
            self._kept.append(line)
            self._changed.notify()

    def _leave_out(self, line: LogLine) -> None:
        for session, level in self._levels.items():
            if line.level >= level:
                self._left_out[session] = self._left_out.get(session, 0) + 1

    def _run(self) -> None:
        pause = threading.Event()  # that is never set
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closed or self._new)
                if self._closed:
                    return
                new, self._new = self._new, collections.deque(maxlen=MAX_KEPT)
                self._push(list(self._levels), new)
            pause.wait(PERIOD)  # so that many lines go in one push

    def _push(self, sessions: Iterable[Session], lines: Iterable[LogLine]) -> None:
        """Pushes the newest of the lines, and how many are left out. The lock must be held."""
        for session in sessions:
            level = self._levels[session]
            wanted = [line for line in lines if line.level >= level]
            entries = newest(wanted)
            left_out = len(wanted) - len(entries) + self._left_out.pop(session, 0)
            if entries or left_out:
                self._pushes += 1
                data = {"entries": [line._asdict() for line in entries], "left_out": left_out}
                session.push("log", data, str(self._pushes))


def newest(lines: List[LogLine]) -> List[LogLine]:
    """Returns as many of the last lines as fit into a push, the oldest first."""
    size, taken = 0, []
    for line in reversed(lines):
        size += line.size
        if size > MAX_PUSH:
            break
        taken.append(line)
    return taken[::-1]
