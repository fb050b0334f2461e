"""The operation graph: which nodes and topics there are, how the nodes are, what to look at."""

import contextlib
import threading
import time
from typing import Any, Dict, List, Optional, Set, Tuple

import rospy

from ..common.plain_text import error_text
from ..common.throttle import Throttle
from ..ros.graph_master import MasterCalls, parsed
from .graph_state import (
    State,
    is_image,
    of_nodes,
    parameter_nodes,
    state_of,
    with_nodelets,
)
from .graph_status import Status, Statuses
from .graph_views import Views
from .operations import Operation
from .sessions import Session
from .settings import Settings

PERIOD = 1.0  # s between two looks at the graph
EMPTY = State({}, {}, {}, {}, set())


class GraphFeature:
    """Pushes the graph to the sessions that have asked for it, when something has changed.

    A thread of its own asks the master once a second while somebody looks, and listens to
    /diagnostics. Statuses change each second and are a small part, so that of a graph which is
    otherwise the same they are pushed alone.
    """

    def __init__(self, settings: Settings):
        self.operations = [Operation("graph", self._on_graph, "view")]
        self._known = KnownGraph()
        self._lock = threading.Lock()  # guards the two below
        self._sessions: Set[Session] = set()
        self._newest: Optional[Dict[str, Any]] = None
        self._changed = threading.Event()  # somebody came or went, or all ends
        self._closed = False
        self._throttle = Throttle()
        self._thread = threading.Thread(target=self._run, name="graph", daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._closed = True
        self._changed.set()
        self._thread.join(PERIOD)

    def _on_graph(self, session: Session, _request: Dict[str, Any]) -> Dict[str, Any]:
        with self._lock:
            is_new = session not in self._sessions
            self._sessions.add(session)
            if self._newest is not None:
                session.push("graph", self._newest)
        if is_new:
            session.on_close(lambda: self._forget(session))
            self._changed.set()
        return {}

    def _forget(self, session: Session) -> None:
        with self._lock:
            self._sessions.discard(session)
        self._changed.set()

    def _run(self) -> None:
        while not self._closed:
            with self._lock:
                wanted = bool(self._sessions)
                if not wanted:
                    self._newest = None
            if wanted:
                self._look()
                self._changed.wait(PERIOD)
            else:
                self._known.rest()
                self._changed.wait()
            self._changed.clear()
        self._known.rest()

    def _look(self) -> None:
        try:
            graph = self._known.look()
        except Exception as error:  # A strange graph must not end the thread.
            if self._throttle.due() and not rospy.core.is_shutdown_requested():
                rospy.logerr("the graph cannot be shown: %s", error_text(error))
            return
        statuses = _statuses(graph)
        with self._lock:  # also while it is pushed, or a session could get an older one afterwards
            before, self._newest = self._newest, graph
            if before is None or _lasting(before) != _lasting(graph):
                kind, data = "graph", graph
            elif _statuses(before) != statuses:
                kind, data = "statuses", statuses
            else:
                return
            for session in self._sessions:
                session.push(kind, data)


def _lasting(graph: Dict[str, Any]) -> Dict[str, Any]:
    """Returns a graph without what changes all the time."""
    return {**graph, "time": 0, "nodes": [{**node, "status": None} for node in graph["nodes"]]}


def _statuses(graph: Dict[str, Any]) -> Dict[str, Any]:
    return {node["name"]: node["status"] for node in graph["nodes"] if node["status"]}


class KnownGraph:
    """What is known of the graph: the master's answers, statuses and images that were used."""

    def __init__(self) -> None:
        self._master = MasterCalls()
        self._statuses = Statuses()
        self._views = Views()
        self._answers: Tuple[bytes, bytes] = (b"", b"")  # of the master, as they came last
        self._state = EMPTY

    def rest(self) -> None:
        """Ends all that costs something until the next look."""
        self._statuses.listen(False)
        self._master.close()

    def look(self) -> Dict[str, Any]:
        """Returns the graph as the page gets it.

        If the master does not answer, the last one is returned, and "problem" says so.
        """
        problem = ""
        try:
            self._ask()
            self._statuses.listen(True)
        except OSError as error:
            problem = error_text(error)
        now = time.monotonic()
        statuses = self._statuses.newest(now)
        tuned = parameter_nodes(self._state)
        state = with_nodelets(self._state, {*statuses, *tuned})
        return {
            "time": time.time(),
            "problem": problem,
            "nodes": _nodes(state, tuned, statuses, now),
            "topics": _topics(state),
            "views": self._views.of(state, statuses),
        }

    def _ask(self) -> None:
        """Asks the master; what it answered before is not read again."""
        answers = self._master.raw("getSystemState"), self._master.raw("getTopicTypes")
        if answers == self._answers:
            return
        system, types = (parsed(answer)[2] for answer in answers)
        with contextlib.suppress(TypeError, ValueError):  # not a list of what it must hold
            self._state = state_of(system, types)
        self._answers = answers


def _nodes(
    state: State, tuned: Set[str], statuses: Dict[str, Status], now: float
) -> List[Dict[str, Any]]:
    publishes, subscribes = of_nodes(state.publishers), of_nodes(state.subscribers)
    services: Dict[str, List[str]] = {}
    for service, node in sorted(state.services.items()):
        services.setdefault(node, []).append(service)
    return [
        {
            "name": node,
            "package_node": node in statuses,
            "publishes": publishes.get(node, []),
            "subscribes": subscribes.get(node, []),
            "parameters": node in tuned,
            "services": services.get(node, []),
            "status": statuses[node].as_json(now) if node in statuses else None,
        }
        for node in sorted(state.nodes)
    ]


def _topics(state: State) -> List[Dict[str, Any]]:
    return [
        {
            "name": topic,
            "type": state.types.get(topic, ""),
            "publishers": sorted(state.publishers.get(topic, ())),
            "subscribers": sorted(state.subscribers.get(topic, ())),
            "image": is_image(topic, state.types, state.publishers),
        }
        for topic in state.topics
    ]
