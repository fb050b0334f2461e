"""The sessions that look at something."""

import threading
from typing import Any, Callable, Dict, Set


class Watchers:
    """The sessions that are told of something, until they leave or end.

    Args:
        on_empty: A function that is called when the last one has left, by the thread in which it
            left.
    """

    def __init__(self, on_empty: Callable[[], Any] = lambda: None):
        self._on_empty = on_empty
        self._lock = threading.Lock()
        self._sessions: Dict[int, Any] = {}
        self._known: Set[int] = set()  # ids of those whose end is told to this object

    def __len__(self) -> int:
        return len(self._sessions)

    def add(self, session: Any) -> None:
        """Adds a session; one that is there already stays once."""
        with self._lock:
            is_new = session.id not in self._known
            self._known.add(session.id)
            self._sessions[session.id] = session
        if is_new:
            session.on_close(lambda: self._end(session))

    def remove(self, session: Any) -> None:
        """Removes a session if it is there."""
        with self._lock:
            was_there = self._sessions.pop(session.id, None)
            is_empty = not self._sessions
        if was_there and is_empty:
            self._on_empty()

    def _end(self, session: Any) -> None:
        with self._lock:
            self._known.discard(session.id)
        self.remove(session)

    def push(self, kind: str, data: Dict[str, Any]) -> None:
        """Tells all of them; see Session.push()."""
        with self._lock:
            sessions = list(self._sessions.values())
        for session in sessions:
            session.push(kind, data)
