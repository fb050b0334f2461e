"""How far a training is: a line that changes on a terminal, and lines elsewhere."""

import math
import sys
import time
from typing import Any, Optional, TextIO

PERIOD = 0.2  # s between two changes of the line on a terminal
SHARE = 0.1  # of all views, after which there is another line elsewhere


class TrainingProgress:
    """Tells how many views of an object are learned, and how long the others will take.

    Args:
        title: What is trained, as "coke: LINEMOD".
        done: How many views were learned by an earlier run.
        total: How many there are.
        stream: Where to tell it; None: stdout.
    """

    def __init__(self, title: str, done: int, total: int, stream: Optional[TextIO] = None) -> None:
        self._title = title
        self._begun = done
        self._total = total
        self._stream = stream or sys.stdout
        self._on_terminal = self._stream.isatty()
        self._begin = self._last = time.monotonic()  # s
        self._told = done
        if not self._on_terminal:
            self._write(done, "")

    def __enter__(self) -> "TrainingProgress":
        return self

    def __exit__(self, kind: Any, _error: Any, _trace: Any) -> None:
        if kind is not None:  # What is wrong gets a line of its own.
            self._clear()

    def update(self, done: int) -> None:
        """Tells that so many views are learned, if it is time to."""
        now = time.monotonic()
        if self._on_terminal and now - self._last >= PERIOD:
            self._last = now
            self._write(done, self._left(done, now))
        elif not self._on_terminal and self._told + SHARE * self._total <= done < self._total:
            self._told = done
            self._write(done, self._left(done, now))

    def tell(self, text: str) -> None:
        """Tells something in place of how far it is, as the result."""
        self._clear()
        print(f"{self._title}: {text}", file=self._stream, flush=True)

    def _clear(self) -> None:
        if self._on_terminal:
            print("\r\033[K", end="", file=self._stream, flush=True)

    def _left(self, done: int, now: float) -> str:
        learned = done - self._begun
        if not learned:
            return ""
        seconds = math.ceil((now - self._begin) * (self._total - done) / learned)
        return f", {seconds // 60}:{seconds % 60:02d} min left"

    def _write(self, done: int, left: str) -> None:
        line = f"{self._title}: {done} of {self._total} views{left}"
        begin, end = ("\r", "\033[K") if self._on_terminal else ("", "\n")
        print(f"{begin}{line}", end=end, file=self._stream, flush=True)
