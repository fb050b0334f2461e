"""Registers a rospy node again when the master was restarted, and so has forgotten all nodes.

src/ros/images/registration.cpp does the same for roscpp.
"""

import contextlib
import functools
import http.client
import sys
import threading
import xmlrpc.client
from typing import Any, Dict, Optional, Set
from xml.parsers.expat import ExpatError

import rosgraph
import rospy
from rospy.impl.registration import get_service_manager

from .context import loaded_names
from .master_calls import ask_master

PERIOD = 5.0  # s between two checks of the master
# The errors that calls of a master or a node raise if it is gone, or is something else.
UNREACHABLE_ERRORS = (
    OSError,
    ExpatError,
    rosgraph.MasterException,
    http.client.HTTPException,
    xmlrpc.client.Error,
)


@functools.lru_cache(maxsize=None)
def keep_registered() -> "_Registration":
    """Keeps topics and services of this process's node registered until it is shut down.

    Existing connections stay. Private parameters of this node, and of those that were loaded into
    its process, are set to their last values if a new master does not have them. The check() of
    what is returned has those noted at once that a node has which was just loaded.
    """
    registration = _Registration(rospy.names.get_name())
    registration.check()
    # Has to end before the node unregisters itself.
    rospy.core.add_preshutdown_hook(lambda _reason: registration.ended.set())
    threading.Thread(target=registration.run, name="registration", daemon=True).start()
    return registration


class _Registration:
    def __init__(self, name: str):
        self.ended = threading.Event()
        self._lock = threading.Lock()  # held while the master is asked
        self._name = name
        self._uri = rospy.get_node_uri()
        self._master_pid: Optional[int] = None  # process id of the master that knows the node
        self._params: Dict[str, Dict[str, Any]] = {}  # by node

    def run(self) -> None:
        while not self.ended.wait(PERIOD):
            self.check()

    def check(self) -> None:
        """Asks the master whether it knows the node, and registers the node if not."""
        # There may be no master at the moment.
        with self._lock, contextlib.suppress(*UNREACHABLE_ERRORS):
            self._check()

    def _check(self) -> None:
        master = rosgraph.Master(self._name)
        pid = master.getPid()
        # A new master may know the node already, by a topic that was registered since its start,
        # and have the process id of the old one, as in a container.
        is_same = pid == self._master_pid and self._knows_first_service(master)
        forgotten = self._master_pid is not None and not is_same
        try:
            address = master.lookupNode(self._name)
        except rosgraph.MasterError:
            address, forgotten = self._uri, self._master_pid is not None
        if address != self._uri:  # Registering again would make the master shut that node down.
            if forgotten:  # rospy's log would register this node to read a parameter.
                print(
                    f"{self._name}: the master is another one, and knows another node of this "
                    "name: not registered again",
                    file=sys.stderr,
                    flush=True,
                )
        elif not forgotten:
            self._params = self._present()
        elif not self.ended.is_set():
            self._register(master)
        self._master_pid = pid

    def _knows_first_service(self, master: rosgraph.Master) -> bool:
        """Returns whether the master knows what rospy registers once, when the node starts."""
        try:
            master.lookupService(f"{self._name}/get_loggers")
        except rosgraph.MasterError:
            return False
        return True

    def _present(self) -> Dict[str, Dict[str, Any]]:
        names = (self._name, *loaded_names())
        answers = ask_master([("getParam", self._name, name) for name in names])
        return {
            name: value if code == 1 and isinstance(value, dict) else {}
            for name, (code, _, value) in zip(names, answers)
        }

    def _register(self, master: rosgraph.Master) -> None:
        rospy.loginfo("the master is another one: registering again")
        for name, params in self._params.items():
            for key, value in params.items():
                if not master.hasParam(f"{name}/{key}"):
                    master.setParam(f"{name}/{key}", value)
        for service, service_uri in get_service_manager().get_services():
            master.registerService(service, service_uri, self._uri)
        node = xmlrpc.client.ServerProxy(self._uri)
        for topic, kind in node.getPublications(self._name)[2]:
            master.registerPublisher(topic, kind, self._uri)
        connections = node.getBusInfo(self._name)[2]
        for topic, kind in node.getSubscriptions(self._name)[2]:
            connected = {
                peer for _, peer, way, _, of, *_ in connections if (way, of) == ("i", topic)
            }
            self._register_subscriber(master, node, topic, kind, connected)

    def _register_subscriber(
        self, master: rosgraph.Master, node: Any, topic: str, kind: str, connected: Set[str]
    ) -> None:
        """Registers a subscriber, and tells the node of the publishers that the master knows.

        Those that it is connected to are told again, as the master may not know them yet. It tells
        of one that comes meanwhile, perhaps before its older answer is told, which rospy then
        takes for what is newer: so it is asked until its answer stays the same.
        """
        told: Optional[Set[str]] = None
        while True:
            publishers = connected.union(master.registerSubscriber(topic, kind, self._uri))
            if publishers == told:
                return
            node.publisherUpdate(self._name, topic, sorted(publishers))
            told = publishers
