"""What nodes say of themselves on /diagnostics."""

import math
import re
import threading
import time
from typing import Any, Dict, NamedTuple, Optional

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from ..common.plain_text import printable
from .message_topics import RawMessage, RawTopic

TOPIC = "/diagnostics"
FRAMES = ": frames"  # the end of the name of the status that each node of this package has
SILENCE = 5.0  # s without a status until that is told
GONE = 15.0  # s without one until it counts no more
MAX_STATUSES = 1000
MAX_VALUES = 64  # of one status
MAX_TEXT = 300  # characters of a message or a value
MAX_KEY = 100  # characters
# What the message of a node's status says while the node works, of the topic of its images.
WORKS_ON = re.compile(r"(?:running|no frames) on (/[\w/]+)")
NUMBERS = {
    "rate": "output rate (Hz)",
    "age": "output age (ms)",
    "processing": "processing time (ms)",
}


class Status(NamedTuple):
    """The newest status of a node."""

    level: int
    message: str
    values: Dict[str, str]
    received: float  # s of the monotonic clock

    def as_json(self, now: float) -> Dict[str, Any]:
        """Returns what the page gets of it; a node that is silent has level 3, "stale"."""
        silent = now - self.received
        level, message = self.level, self.message
        if silent > SILENCE:
            level, message = DiagnosticStatus.STALE, f"no status for {silent:.0f} s"
        numbers = {name: number_in(self.values.get(key)) for name, key in NUMBERS.items()}
        return {"level": level, "message": message, **numbers, "values": self.values}

    @property
    def image(self) -> str:
        """The topic of the images that the node works on; "" while it does not say that."""
        found = WORKS_ON.match(self.message)
        return found[1] if found else ""


def number_in(text: Optional[str]) -> Optional[float]:
    """Returns the finite number that a text is, or None."""
    try:
        value = float(text or "")
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def status_of(message: Any, now: float) -> Status:
    """Returns a diagnostic_msgs/DiagnosticStatus with all texts cut to what can be shown."""
    level = message.level[0] if isinstance(message.level, bytes) else int(message.level)
    values = {
        printable(pair.key, MAX_KEY): printable(pair.value, MAX_TEXT)
        for pair in message.values[:MAX_VALUES]
    }
    level = min(max(level, 0), DiagnosticStatus.STALE)
    return Status(level, printable(message.message, MAX_TEXT), values, now)


class Statuses:
    """The statuses of the nodes of this package, by node, while it listens to /diagnostics."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards _newest: each publisher has its own thread
        self._newest: Dict[str, Status] = {}
        self._topic: Optional[RawTopic] = None

    def listen(self, wanted: bool) -> None:
        """Begins or ends listening; at the end all is forgotten."""
        if wanted and self._topic is None:
            self._topic = RawTopic(TOPIC, self._on_message)
        elif not wanted and self._topic is not None:
            self._topic.close()
            self._topic = None
            with self._lock:
                self._newest.clear()

    def newest(self, now: float) -> Dict[str, Status]:
        """Returns the newest status of each node that has said something in the last GONE s."""
        with self._lock:
            self._newest = {
                node: status
                for node, status in self._newest.items()
                if now - status.received < GONE
            }
            return dict(self._newest)

    def _on_message(self, raw: RawMessage) -> None:
        message = raw.decoded()
        if not isinstance(message, DiagnosticArray):
            return
        now = time.monotonic()
        with self._lock:
            for status in message.status:
                if not status.name.endswith(FRAMES):
                    continue
                node = "/" + status.name[: -len(FRAMES)].lstrip("/")
                if node in self._newest or len(self._newest) < MAX_STATUSES:
                    self._newest[node] = status_of(status, now)
