"""Bonds of a manager with those who have loaded its nodes: when a loader ends, so does its node."""

import threading
from typing import Any, Callable, Dict

import rospy
from bond.msg import Status
from bondpy.bondpy import Bond

from ..ros.context import current

# All bonds send on one topic: what waits for a connection are the signs of life of all of them in
# the seconds after which one is missed. A bond of Python leaves room for one only, so that those of
# others would take its place on a busy machine, until its loader takes the manager for dead.
QUEUE_SIZE = 1000


class Bonds:
    """The bonds of a manager, by the names of nodes. Thread-safe."""

    def __init__(self) -> None:
        self._topic = current().resolve("~bond")
        # As long as there are these two, a bond that ends closes no topic, and says so before.
        self._publisher = rospy.Publisher(self._topic, Status, queue_size=QUEUE_SIZE)
        self._subscriber = rospy.Subscriber(self._topic, Status, _ignore)
        self._lock = threading.Lock()
        self._bonds: Dict[str, Bond] = {}

    def form(self, name: str, bond_id: str, on_broken: Callable[[], Any]) -> None:
        """Forms the bond of a node; `on_broken` is called, in its own thread, when it breaks."""

        def broken() -> None:
            with self._lock:
                counts = self._bonds.get(name) is bond
            if counts:
                threading.Thread(target=on_broken, name="unload", daemon=True).start()

        def formed() -> None:
            # A bond of Python waits for a second sign of life before it misses any: who was killed
            # between the two would be taken for alive for ever. The lock is that of all restarts.
            with bond.lock:
                bond.heartbeat_timer.reset()

        bond = Bond(self._topic, bond_id, on_broken=broken, on_formed=formed)
        self._publisher.impl.set_queue_size(QUEUE_SIZE)
        with self._lock:
            self._bonds[name] = bond
        bond.start()

    def end(self, name: str) -> None:
        """Tells who has loaded a node that it has ended."""
        with self._lock:
            bond = self._bonds.pop(name, None)
        if bond is not None:
            bond.shutdown()

    def end_all(self) -> None:
        for name in list(self._bonds):
            self.end(name)


def _ignore(_status: Any) -> None:
    pass
