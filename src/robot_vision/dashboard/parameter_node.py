"""The live parameters of one node, by the topics and the service of dynamic_reconfigure."""

import collections
import contextlib
import re
import threading
import time
from typing import Any, Callable, Deque, Dict, List, Mapping, Optional, Set, Tuple

from dynamic_reconfigure.encoding import encode_config
from dynamic_reconfigure.msg import Config, ConfigDescription
from dynamic_reconfigure.srv import Reconfigure
from rosgraph_msgs.msg import Log

from ..common.plain_text import brief
from ..ros.listeners import IMAGES
from .graph_calls import call_node
from .log_lines import LogLine, LogTopic
from .message_topics import RawMessage, RawTopic
from .parameter_description import groups_of, types_of, values_of
from .parameter_values import same, typed

DESCRIPTION_TIMEOUT = 5.0  # s until a node has told its parameters
REASON_TIMEOUT = 0.5  # s that a node has to say in the log why it refused a value
MAX_LINES = 50  # of the log that are kept for that
# What nodes of this package say before the reason.
REFUSED = re.compile(r"(\S+: )?(refused, )?the (parameters|controls) stay as they are: ")
Listener = Callable[[str, Dict[str, Any]], Any]  # gets the kind of a push, and its data


class ParameterNode:
    """Knows the parameters of a node while somebody looks at them, and sets them.

    Args:
        name: The name of the node.

    Raises:
        ValueError, OSError: It is no name, or the master does not answer.
    """

    def __init__(self, name: str):
        self.name = name
        self._changed = threading.Condition()  # guards all below
        self._description: Optional[Any] = None
        self._values: Optional[Dict[str, Any]] = None
        self._speakers: Set[str] = {name, name + IMAGES}  # the nodes that log for it
        self._lines: Deque[Tuple[float, LogLine]] = collections.deque(maxlen=MAX_LINES)
        self._listeners: List[Listener] = []
        self._topics: List[RawTopic] = []
        try:
            # The log comes first: a reason may be the answer to the first value that is set.
            self._topics.append(LogTopic(self._on_line))
            self._topics.append(RawTopic(f"{name}/parameter_descriptions", self._on_description))
            self._topics.append(RawTopic(f"{name}/parameter_updates", self._on_values))
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        for topic in self._topics:
            topic.close()

    def listen(self, listener: Listener) -> None:
        """Has a function called with all that changes from now on."""
        with self._changed:
            self._listeners.append(listener)

    def unlisten(self, listener: Listener) -> None:
        with self._changed, contextlib.suppress(ValueError):
            self._listeners.remove(listener)

    def as_json(self) -> Dict[str, Any]:
        """Returns groups and values, as the page gets them.

        Raises:
            OSError: The node has not told them in time.
        """
        with self._changed:
            self._wait_for_description()
            return self._told()

    def types(self) -> Dict[str, str]:
        """Returns bool, int, double or str for each parameter.

        Raises:
            OSError: The node has not told them in time.
        """
        with self._changed:
            self._wait_for_description()
            return types_of(self._description)

    def set(self, values: Mapping[str, Any]) -> Dict[str, Any]:
        """Sets values; returns those that the node has then, and which it refused, and why.

        Raises:
            OSError: The node does not answer in time.
        """
        wanted, refused = typed(values, self.types())
        if not wanted:
            with self._changed:
                return {"values": dict(self._values or {}), "refused": refused}
        begin = time.monotonic()
        answer = call_node(self.name, "set_parameters", Reconfigure, encode_config(wanted))
        now = values_of(answer.config)
        kept = [name for name, value in wanted.items() if not same(value, now.get(name))]
        refused.update(self._reasons(kept, now, begin))
        return {"values": now, "refused": refused}

    def _wait_for_description(self) -> None:
        def has_come() -> bool:
            return self._description is not None and self._values is not None

        if not self._changed.wait_for(has_come, DESCRIPTION_TIMEOUT):
            raise OSError(
                f"{self.name} has not told its parameters within {DESCRIPTION_TIMEOUT:g} s: "
                "it has none that can be changed live, or hangs"
            )

    def _reasons(self, names: List[str], values: Dict[str, Any], begin: float) -> Dict[str, str]:
        """Returns why the node did not take values: what it logs, else what it has kept."""
        if not names:
            return {}
        with self._changed:
            self._changed.wait_for(lambda: self._said(names[0], begin), REASON_TIMEOUT)
            said = {name: self._said(name, begin) for name in names}
        return {
            name: said[name] or f"the node keeps {name} = {brief(values.get(name))}"
            for name in names
        }

    def _said(self, name: str, begin: float) -> str:
        """Returns the line of the log that is about a parameter, or about all that were set."""
        warnings = [
            line.text
            for received, line in self._lines
            if received >= begin and line.level >= Log.WARN and line.node in self._speakers
        ]
        about = [text for text in warnings if re.search(rf"\b{re.escape(name)}\b", text)]
        refusing = [text for text in warnings if REFUSED.match(text)]
        found = next(iter([*about, *refusing]), "")
        return REFUSED.sub("", found, 1)

    def _told(self) -> Dict[str, Any]:
        """Returns what the node has told. The lock must be held."""
        values = dict(self._values or {})
        return {"node": self.name, "groups": groups_of(self._description), "values": values}

    def _on_line(self, line: LogLine) -> None:
        with self._changed:
            if line.level >= Log.WARN:
                self._lines.append((time.monotonic(), line))
                self._changed.notify_all()

    def _on_description(self, raw: RawMessage) -> None:
        message = raw.decoded()
        if not isinstance(message, ConfigDescription):
            return
        with self._changed:
            is_new = self._description not in (None, message)  # the node was started as another one
            self._description = message
            self._changed.notify_all()
            listeners, data = list(self._listeners) if is_new else [], self._told()
        for listener in listeners:
            listener("parameters", data)

    def _on_values(self, raw: RawMessage) -> None:
        message = raw.decoded()
        if not isinstance(message, Config):
            return
        with self._changed:
            self._values = values_of(message)
            self._speakers.add(raw.publisher)  # of a nodelet that is its manager
            self._changed.notify_all()
            listeners = list(self._listeners)
            data = {"node": self.name, "values": dict(self._values)}
        for listener in listeners:
            listener("values", data)
