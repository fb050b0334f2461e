"""Bonds of a manager with those who have loaded its nodes: when a loader ends, so does its node."""

import threading
from typing import Any, Callable, Dict

import rospy

from .. import _transport
from ..common.plain_text import brief
from ..ros.context import current
from ..ros.node_images import process_runtime


class Bonds:
    """The bonds of a manager, by the names of nodes; they live in C++. Thread-safe.

    Args:
        times: `connect_timeout`, `heartbeat_timeout`, `disconnect_timeout` and `period` in s, if
            not those of bond.
    """

    def __init__(self, **times: float) -> None:
        process_runtime()  # starts roscpp
        self._bonds = _transport.Bonds(current().resolve("~bond"), **times)
        self._lock = threading.Lock()
        self._ids: Dict[str, str] = {}  # by the names of nodes
        self._on_broken: Dict[str, Callable[[], Any]] = {}  # by ids
        self._ended = False
        threading.Thread(target=self._watch, name="bonds", daemon=True).start()

    def reserve(self, name: str, bond_id: str) -> None:
        """Keeps the id for a node that is to be made; raises ValueError if another node has it."""
        with self._lock:
            if bond_id in self._ids.values():
                raise ValueError(f"bond_id is {brief(bond_id)}, which is that of another node")
            self._ids[name] = bond_id

    def form(self, name: str, on_broken: Callable[[], Any]) -> None:
        """Forms the reserved bond of a node; a thread calls `on_broken` if it breaks."""
        with self._lock:
            bond_id = self._ids[name]
            self._on_broken[bond_id] = on_broken
        self._bonds.form(bond_id)

    def end(self, name: str) -> None:
        """Tells who has loaded a node that it has ended, and gives its id free."""
        with self._lock:
            bond_id = self._ids.pop(name, "")
            self._on_broken.pop(bond_id, None)
        self._bonds.end(bond_id)

    def end_all(self) -> None:
        """Ends all bonds for good."""
        self._ended = True
        self._bonds.close()

    def _watch(self) -> None:
        while True:
            bond_id = self._bonds.next_broken()
            if not bond_id:
                break
            with self._lock:
                on_broken = self._on_broken.pop(bond_id, None)
            if on_broken is None:  # the node ends by itself
                continue
            try:
                threading.Thread(target=on_broken, name="unload", daemon=True).start()
            except RuntimeError as error:  # there are too many
                rospy.logerr("a node stays though its loader is gone: %s", error)
        if not self._ended:
            rospy.signal_shutdown("its roscpp node has ended")
