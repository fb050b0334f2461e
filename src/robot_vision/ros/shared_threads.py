"""How many threads of OpenCV's the nodes of a process let work on an image.

OpenCV has one number for each process: where several nodes are loaded into one, that is the largest
which one of them asks for.
"""

import threading
from typing import List

from .. import _core
from .context import current

_lock = threading.Lock()
_wanted: List[float] = []  # infinite: as many as there are cores


def set_threads(count: int) -> None:
    """Sets how many threads share the work on an image of this node; 0: as many as cores."""
    wanted = float(count) if count else float("inf")
    with _lock:
        _wanted.append(wanted)
        _apply()
    current().closes(lambda: _withdraw(wanted))


def _withdraw(wanted: float) -> None:
    with _lock:
        _wanted.remove(wanted)
        _apply()


def _apply() -> None:
    largest = max(_wanted, default=1.0)
    _core.set_threads(0 if largest == float("inf") else int(largest))
