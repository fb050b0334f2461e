"""Keeps nodes known to a master that is started anew, and so knows of nothing."""

import contextlib
import http.client
import threading
import xmlrpc.client
from typing import Dict, Optional, Sequence

import rosgraph
import rospy
from rospy.impl.registration import get_service_manager

PERIOD = 5.0  # s between two looks at the master


class Registration:
    """Registers the topics of nodes of this process again when the master has forgotten them.

    Connections that there are stay. Of the process's rospy node the services are registered again,
    too; roscpp's cannot be asked for.

    Args:
        nodes: absolute names: the rospy node of this process, and roscpp nodes.
    """

    def __init__(self, nodes: Sequence[str]):
        self._uris: Dict[str, str] = dict.fromkeys(nodes, "")  # from when the master knew them
        self._master_pid: Optional[int] = None  # of the master that knows their topics
        self._ended = threading.Event()
        threading.Thread(target=self._run, name="registration", daemon=True).start()

    def end(self) -> None:
        """To be called before the node unregisters itself; does not wait."""
        self._ended.set()

    def _run(self) -> None:
        away = (OSError, rosgraph.MasterException, http.client.HTTPException, xmlrpc.client.Error)
        while True:
            with contextlib.suppress(*away):  # the master may be
                self._check()
            if self._ended.wait(PERIOD):
                return

    def _check(self) -> None:
        master = rosgraph.Master(rospy.get_name())
        pid = master.getPid()
        # Another master may know a node already, by a topic that it has registered since.
        replaced = self._master_pid is not None and pid != self._master_pid
        for name, uri in self._uris.items():
            forgotten = replaced
            try:
                self._uris[name] = master.lookupNode(name)
            except rosgraph.MasterError:
                forgotten = True
            if forgotten and uri and not self._ended.is_set():
                self._register(rosgraph.Master(name), name, uri)
        self._master_pid = pid

    @staticmethod
    def _register(master: rosgraph.Master, name: str, uri: str) -> None:
        node = xmlrpc.client.ServerProxy(uri)
        for topic, kind in node.getPublications(name)[2]:
            master.registerPublisher(topic, kind, uri)
        connections = node.getBusInfo(name)[2]
        for topic, kind in node.getSubscriptions(name)[2]:
            publishers = set(master.registerSubscriber(topic, kind, uri))
            # The node drops the connections to publishers that it is not told of.
            publishers.update(
                peer for _, peer, way, _, of, *_ in connections if (way, of) == ("i", topic)
            )
            node.publisherUpdate(name, topic, sorted(publishers))
        if name == rospy.get_name():
            for service, service_uri in get_service_manager().get_services():
                master.registerService(service, service_uri, uri)
