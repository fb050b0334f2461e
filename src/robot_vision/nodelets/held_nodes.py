"""The nodes that a manager holds: those of this package in Python, and nodelets in C++."""

import threading
import time
from typing import Dict, List, Optional, Union

import rospy

from ..ros.node_images import process_runtime
from .bonds import Bonds
from .load_requests import LoadRequest
from .loaded_node import LoadedNode
from .memory import give_memory_back, keep_start
from .node_types import PACKAGE, find_type, type_names

FINISH_TIMEOUT = 0.7  # s that nodes have to finish when the process ends
STARTING, ENDING = "starting", "ending"  # in place of a node


class Nodelet:
    """A nodelet in C++, of which only the name is known here."""


Node = Union[LoadedNode, Nodelet, str]


class HeldNodes:
    """Loads and unloads nodes. Thread-safe.

    A node in Python that takes long to start delays no other. Nodelets start and end one by one,
    as in nodelet's own managers, which they may rely on.
    """

    def __init__(self) -> None:
        self._runtime = process_runtime()
        self._bonds = Bonds()
        keep_start()
        self._changed = threading.Condition()  # guards the nodes
        self._nodes: Dict[str, Node] = {}
        self._starting: Dict[str, LoadedNode] = {}  # they may work before they are among the nodes
        self._finishing = False

    def load(self, request: LoadRequest) -> None:
        """Loads a node.

        Raises:
            ValueError, RuntimeError: It cannot be loaded; the message says why.
        """
        name = request.name
        with self._changed:
            self._changed.wait_for(lambda: self._nodes.get(name) != ENDING)
            if self._finishing:
                raise ValueError(f"{name}: the manager ends")
            if name in self._nodes:
                raise ValueError(f"{name}: there is a node of this name already")
            self._nodes[name] = STARTING
        try:
            if request.bond_id:
                self._bonds.reserve(name, request.bond_id)
            node = self._started(request)
        except BaseException:
            self._bonds.end(name)
            self._set(name, None)
            raise
        if request.bond_id:
            self._bonds.form(name, lambda: self._drop(name, node))
        self._set(name, node)

    def unload(self, name: str) -> None:
        """Ends a node, which may be starting; raises ValueError if there is none of that name."""
        if not self._end(name, None):
            raise ValueError(f"{name}: there is no node of this name")

    def names(self) -> List[str]:
        """Returns the names of all nodes."""
        with self._changed:
            return sorted(n for n, node in self._nodes.items() if node not in (STARTING, ENDING))

    def finish(self) -> None:
        """Has all nodes finish at once, as the process ends; each has its time for it."""
        with self._changed:
            self._finishing = True
            nodes = [node for node in self._nodes.values() if isinstance(node, LoadedNode)]
            nodes += self._starting.values()
        threads = [threading.Thread(target=node.finish, daemon=True) for node in nodes]
        for thread in threads:
            thread.start()
        deadline = time.monotonic() + FINISH_TIMEOUT
        for thread in threads:
            thread.join(max(0.0, deadline - time.monotonic()))
        self._bonds.end_all()

    def _started(self, request: LoadRequest) -> Node:
        try:
            kind = find_type(request.type)
        except KeyError:
            self._load_nodelet(request)
            return Nodelet()
        node = LoadedNode(request.name, request.remappings, lambda: self._drop(request.name, node))
        with self._changed:
            self._starting[request.name] = node
        node.start(kind)
        return node

    def _load_nodelet(self, request: LoadRequest) -> None:
        others = self._runtime.nodelet_types()
        if request.type not in others:
            own = ", ".join(name[len(PACKAGE) :] for name in type_names())
            nodelets = ", ".join(sorted(others))
            raise ValueError(
                f"type is {request.type}, must be {PACKAGE} and one of {own}; or a nodelet, of "
                f"{nodelets}"
            )
        self._runtime.load_nodelet(
            request.name, request.type, request.remappings, request.arguments
        )

    def _drop(self, name: str, node: Node) -> None:
        """Ends a node that has lost its loader or wants to end, unless another has its name."""
        if self._end(name, node):
            rospy.loginfo("%s: unloaded", name)

    def _end(self, name: str, only: Optional[Node]) -> bool:
        with self._changed:
            self._changed.wait_for(lambda: self._nodes.get(name) not in (STARTING, ENDING))
            node = self._nodes.get(name)
            if node is None or (only is not None and node is not only):
                return False
            self._nodes[name] = ENDING
        try:
            self._bonds.end(name)
            if isinstance(node, LoadedNode):
                node.end()
            else:
                self._runtime.unload_nodelet(name)
        finally:
            node = None
            give_memory_back()
            self._set(name, None)
        return True

    def _set(self, name: str, node: Optional[Node]) -> None:
        with self._changed:
            self._nodes.pop(name)
            self._starting.pop(name, None)
            if node is not None:
                self._nodes[name] = node
            self._changed.notify_all()
