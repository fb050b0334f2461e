"""The operations parameters, set_parameters and save_parameters: what can be changed live."""

import threading
from typing import Any, Dict, List

from std_srvs.srv import Trigger

from ..common.plain_text import printable
from ..ros.graph_master import graph_name, has_service
from .color_names import colors_at_start
from .fields import Mapping, Text
from .graph_calls import call_node
from .message_topics import SharedTopics
from .operations import Operation
from .parameter_description import parameters_in
from .parameter_node import ParameterNode
from .sessions import Session
from .settings import Settings

SAVE = "save_parameters"
SAVE_TIMEOUT = 10.0  # s, as a disk may be slow
MAX_NODES = 64  # whose parameters a session looks at
MAX_VALUES = 1000  # that are set at once
MAX_MESSAGE = 1000  # characters


class ParameterFeature:
    """Tells the live parameters of nodes, sets them, and pushes what others change."""

    def __init__(self, settings: Settings):
        node = {"node": Text()}
        self.operations = [
            Operation("parameters", self._on_parameters, "view", node),
            Operation("close_parameters", self._on_close, "view", node),
            Operation(
                "set_parameters",
                self._on_set,
                "control",
                {**node, "values": Mapping(MAX_VALUES)},
            ),
            Operation(SAVE, self._on_save, "control", node),
        ]
        self._nodes = SharedTopics(ParameterNode)
        self._lock = threading.Lock()  # guards what follows
        self._looking: Dict[Session, Dict[str, _Looker]] = {}

    def close(self) -> None:
        with self._lock:
            sessions = list(self._looking)
        for session in sessions:
            self._forget(session)

    def _on_parameters(self, session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        name = graph_name(request["node"])
        with self._lock:
            looked_at = self._looking.get(session, {})
            is_new = name not in looked_at
            if is_new and len(looked_at) >= MAX_NODES:
                raise ValueError(f"the page looks at the parameters of {MAX_NODES} nodes already")
        looker = _Looker(session, self._nodes, name) if is_new else looked_at[name]
        try:
            if is_new:
                looker.begin()  # or what changes meanwhile would be neither told nor pushed
            told = looker.node.as_json()
            _add_choices(name, told["groups"])
            told["save"] = has_service(f"{name}/{SAVE}")
        except BaseException:
            if is_new:
                looker.close()
            raise
        if is_new:
            self._keep(session, name, looker)
        return told

    def _keep(self, session: Session, name: str, looker: "_Looker") -> None:
        with self._lock:
            is_first = session not in self._looking
            self._looking.setdefault(session, {})[name] = looker
        if is_first:
            session.on_close(lambda: self._forget(session))

    def _on_close(self, session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        with self._lock:
            looker = self._looking.get(session, {}).pop(request["node"], None)
        if looker:
            looker.close()
        return {}

    def _forget(self, session: Session) -> None:
        with self._lock:
            lookers = list(self._looking.pop(session, {}).values())
        for looker in lookers:
            looker.close()

    def _on_set(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        return set_values(self._nodes, request["node"], request["values"])

    def _on_save(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        answer = call_node(request["node"], SAVE, Trigger, timeout=SAVE_TIMEOUT)
        message = printable(answer.message, MAX_MESSAGE)
        if not answer.success:
            raise ValueError(f"not saved: {message}")
        return {"message": f"saved in {message}" if message.startswith("/") else message}


def set_values(nodes: SharedTopics, name: str, values: Dict[str, Any]) -> Dict[str, Any]:
    """Sets parameters of a node: see ParameterNode.set()."""
    node = nodes.take(graph_name(name))
    try:
        told: Dict[str, Any] = node.set(values)
        return told
    finally:
        nodes.give_back(name)


class _Looker:
    """A session that looks at the parameters of a node."""

    def __init__(self, session: Session, nodes: SharedTopics, name: str):
        self._session = session
        self._nodes = nodes
        self._name = name
        self.node: ParameterNode = nodes.take(name)

    def begin(self) -> None:
        """Pushes all changes from now on."""
        self.node.listen(self._push)

    def close(self) -> None:
        self.node.unlisten(self._push)
        self._nodes.give_back(self._name)

    def _push(self, kind: str, data: Dict[str, Any]) -> None:
        self._session.push(kind, data, self._name)


def _add_choices(node: str, groups: List[Dict[str, Any]]) -> None:
    """Adds choices that only the parameter server knows: the names of colours."""
    for parameter in parameters_in(groups):
        if parameter["name"] == "color" and parameter["type"] == "str" and not parameter["choices"]:
            parameter["choices"] = [
                {"value": name, "name": name, "description": ""} for name in colors_at_start(node)
            ]
