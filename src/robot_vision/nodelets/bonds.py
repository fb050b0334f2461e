"""Bonds of a manager with those who have loaded its nodes: when a loader ends, so does its node."""

import threading
from typing import Any, Callable, Dict, Tuple

from .. import _transport
from ..ros.context import current
from ..ros.node_images import process_runtime


class Bonds:
    """The bonds of a manager, by the names of nodes; they live in C++. Thread-safe.

    Args:
        times: `connect_timeout`, `heartbeat_timeout` and `period` in s, if not those of bond.
    """

    def __init__(self, **times: float) -> None:
        process_runtime()  # starts roscpp
        self._bonds = _transport.Bonds(current().resolve("~bond"), **times)
        self._lock = threading.Lock()
        self._ids: Dict[str, str] = {}  # by the names of nodes
        self._on_broken: Dict[str, Tuple[str, Callable[[], Any]]] = {}  # by ids, with the names
        threading.Thread(target=self._watch, name="bonds", daemon=True).start()

    def form(self, name: str, bond_id: str, on_broken: Callable[[], Any]) -> None:
        """Forms the bond of a node; `on_broken` is called, in its own thread, when it breaks."""
        with self._lock:
            self._ids[name] = bond_id
            self._on_broken[bond_id] = name, on_broken
        self._bonds.form(bond_id)

    def end(self, name: str) -> None:
        """Tells who has loaded a node that it has ended."""
        with self._lock:
            bond_id = self._ids.pop(name, "")
            self._on_broken.pop(bond_id, None)
        self._bonds.end(bond_id)

    def end_all(self) -> None:
        """Ends all bonds for good."""
        self._bonds.close()

    def _watch(self) -> None:
        while True:
            bond_id = self._bonds.next_broken()
            if not bond_id:
                return
            with self._lock:
                name, on_broken = self._on_broken.pop(bond_id, ("", None))
                self._ids.pop(name, None)
            if on_broken is not None:
                threading.Thread(target=on_broken, name="unload", daemon=True).start()
