"""Keeps a node known to a master that is started anew, and so knows of nothing."""

import contextlib
import http.client
import threading
import xmlrpc.client
from typing import Optional

import rosgraph
import rospy
from rospy.impl.registration import get_service_manager

PERIOD = 5.0  # s between two looks at the master


class Registration:
    """Registers the topics of a node of this process again when the master has forgotten it.

    Connections that there are stay. Of the process's rospy node the services are registered again,
    too; roscpp's cannot be asked for.

    Args:
        node: absolute name of the rospy node of this process, or of a roscpp node.
    """

    def __init__(self, node: str):
        self._node = node
        self._uri: Optional[str] = None  # of the node, from when the master still knew it
        self._master_pid: Optional[int] = None  # of the master that knows the node's topics
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
        master = rosgraph.Master(self._node)
        pid = master.getPid()
        # Another master may know the node already, by a topic that it has registered since.
        forgotten = self._master_pid is not None and pid != self._master_pid
        try:
            self._uri = master.lookupNode(self._node)
        except rosgraph.MasterError:
            forgotten = True
        if forgotten and self._uri and not self._ended.is_set():
            self._register(master, self._uri)
        self._master_pid = pid

    def _register(self, master: rosgraph.Master, uri: str) -> None:
        node = xmlrpc.client.ServerProxy(uri)
        for topic, kind in node.getPublications(self._node)[2]:
            master.registerPublisher(topic, kind, uri)
        connections = node.getBusInfo(self._node)[2]
        for topic, kind in node.getSubscriptions(self._node)[2]:
            publishers = set(master.registerSubscriber(topic, kind, uri))
            # The node drops the connections to publishers that it is not told of.
            publishers.update(
                peer for _, peer, way, _, name, *_ in connections if (way, name) == ("i", topic)
            )
            node.publisherUpdate(self._node, topic, sorted(publishers))
        if self._node == rospy.get_name():
            for service, service_uri in get_service_manager().get_services():
                master.registerService(service, service_uri, uri)
