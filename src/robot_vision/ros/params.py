"""A node's parameters: strictly checked at start, changed live and saved to a file."""

import copy
import difflib
import math
import os
import re
import sys
from typing import Any, Callable, Dict, Optional, TypeVar

import dynamic_reconfigure.server
import rosgraph
import rospy
from std_srvs.srv import Trigger, TriggerResponse

from .. import _transport
from ..common.files import read_text, replace_file
from ..common.plain_text import NAME, brief, is_name, printable
from ..common.ranges import require_range
from .context import current

Params = TypeVar("Params")

# Parameters that the transports and LiveParams read in their own ways, and their defaults.
READ_ELSEWHERE = {"config_file": "", "diagnostic_period": 1.0, "image_transport": "auto"}
OTHER_FILE_HINT = (
    "; ~config_file names the file, as config:=/absolute/path.yaml of the launch files does"
)
MAX_ERROR_LENGTH = 1000  # characters, including the path of a file
TRANSPORTS = ("compressed", "compressedDepth", "theora")
TYPES = {bool: "true or false", int: "an integer", float: "a number", str: "a string"}


def read_param(
    name: str, default: Any, low: float = -math.inf, high: float = math.inf, zero: str = ""
) -> Any:
    """Returns the private parameter `name`, or `default` if it is not set.

    Args:
        name: The name of the parameter, without ~.
        default: The default. Its type is the type that the parameter must have, except that an
            integer is accepted for a float.
        low: The smallest number allowed. Without `low` and `high` any finite number is allowed.
        high: The largest number allowed.
        zero: What the value 0 means, for the error message.

    Raises:
        ValueError: The parameter has another type than the default, or is out of range.
    """
    value = read_any(name, default)
    kind = type(default)
    if kind is float and type(value) is int:
        value = float(value)
    if type(value) is not kind:
        raise ValueError(f"{name} is {brief(value)}, must be {TYPES[kind]}")
    if kind in (int, float):
        require_range(name, value, low, high, zero)
    return value


def read_secret(name: str) -> str:
    """Returns a private parameter whose value is in no log and no error, "" if it is not set.

    Raises:
        ValueError: The parameter is not a string.
    """
    value = read_any(name, "")
    _known()[name] = False  # review_params() shows what has changed.
    if not isinstance(value, str):
        raise ValueError(f"{name} is of type {type(value).__name__}, must be a string")
    return value


def read_name(name: str, default: str) -> str:
    """Returns a private parameter that names a frame, a node or the like.

    Raises:
        ValueError: The parameter is not a string, or it is empty, too long or not printable.
    """
    value = read_param(name, default)
    if not is_name(value):
        raise ValueError(f"{name} is {brief(value)}, must be {NAME}")
    return value


def read_prefix() -> str:
    """Returns ~frame_prefix, which is in front of the names of transforms.

    Raises:
        ValueError: It cannot be a part of a name.
    """
    prefix = read_param("frame_prefix", "")
    if prefix and not is_name(prefix):
        raise ValueError(f"frame_prefix is {brief(prefix)}, must be empty or {NAME}")
    return prefix


def read_any(name: str, default: Any) -> Any:
    """Returns the private parameter `name` of any type, or `default` if it is not set."""
    value = current().get_param("~" + name, default)
    _known()[name] = value != default
    return value


def review_params() -> None:
    """Logs which private parameters differ from their defaults, and which are not known.

    The former, in one line, may be left over from another run. The latter may be misspelt. Maps
    are not counted among them if they have the name of a transport, or are the namespace of
    another node, of a topic or of a service.
    """
    for name, default in READ_ELSEWHERE.items():
        read_any(name, default)
    known = _known()
    there = sorted(current().get_param("~", {}).items())
    changed = [f"{name}: {brief(value)}" for name, value in there if known.get(name)]
    if changed:
        rospy.loginfo("%s: set on the parameter server: %s", current().name, ", ".join(changed))
    for name, value in there:
        path = current().resolve("~" + name)
        if name in known or (isinstance(value, dict) and _belongs_to_others(name, path)):
            continue
        near = difflib.get_close_matches(name, known, 1)
        hint = f", is {near[0]} meant?" if near else ""
        rospy.logwarn("parameter %s is not known%s", path, hint)


class _Known(Dict[str, bool]):
    """The parameters that a node has read, and whether each differs from its default."""


def _known() -> _Known:
    return current().part(_Known)


def _belongs_to_others(name: str, path: str) -> bool:
    """Returns whether a map of parameters may belong to a transport, a node, topic or service."""
    if name in TRANSPORTS:
        return True
    state = rosgraph.Master(rospy.get_name()).getSystemState()
    names = [name for kind in state for topic, nodes in kind for name in (topic, *nodes)]
    return any(f"{name}/".startswith(f"{path}/") for name in names)


def attribute_of(name: str, prefix: str = "") -> str:
    """The core's name of a live parameter: minArea is min_area."""
    words = name[len(prefix) :] if name.startswith(prefix) else name
    return re.sub(r"[A-Z]", lambda letter: "_" + letter[0].lower(), words)


def filled(params: Params, config: Dict[str, Any], prefix: str = "") -> Params:
    """The core's parameters with the live ones of their names in them.

    Args:
        prefix: what live parameters have in front of the core's names.
    """
    for name, value in config.items():
        attribute = attribute_of(name, prefix)
        if hasattr(params, attribute):
            setattr(params, attribute, value)
    return params


class LiveParams:
    """Parameters that dynamic_reconfigure changes and the service ~save_parameters saves.

    Args:
        config_type: The module generated from the .cfg file, whose ranges apply.
        apply: A function that puts the values (by name) to use. It may correct them in place, or
            raise ValueError to refuse them. At start that ends the node. Later the old values
            stay, and a warning gives the reason.
        edit: A function that puts values into the text of the file that ~config_file names:
            edit(path, text, values) returns the new text. By default each value is a line of it.

    Raises:
        ValueError: A parameter has the wrong type, or was refused.
    """

    def __init__(
        self,
        config_type: Any,
        apply: Callable[[Dict[str, Any]], None],
        edit: Optional[Callable[[str, str, Dict[str, Any]], str]] = None,
    ):
        self._type = config_type
        self._apply = apply
        self._edit = edit or _transport.edit_params
        self._accepted: Dict[str, Any] = {}
        for name, default in config_type.defaults.items():
            low, high = self._type.min[name], self._type.max[name]
            current().set_param("~" + name, read_param(name, default, low, high))
        self._server = _Server(config_type, self._change)
        current().service("~save_parameters", Trigger, self._on_save)

    def _change(self, config: Dict[str, Any], _level: int) -> Dict[str, Any]:
        try:
            self._require_ranges(config)
            self._apply(config)
        except ValueError as error:
            if not self._accepted:
                raise
            rospy.logwarn("refused, the parameters stay as they are: %s", error)
            return copy.deepcopy(self._accepted)
        self._accepted = copy.deepcopy(config)
        return config

    def _require_ranges(self, config: Dict[str, Any]) -> None:
        for name, low in self._type.min.items():
            high = self._type.max[name]
            kind = type(self._type.defaults[name])
            # A client may have put a value into the list of another type.
            if type(config[name]) not in ((int, float) if kind is float else (kind,)):
                raise ValueError(
                    f"{name} is {brief(config[name])}, must be of type {kind.__name__}"
                )
            if low != "" and type(config[name]) is not bool:
                require_range(name, config[name], low, high)

    def _on_save(self, _request: Any) -> TriggerResponse:
        accepted = self._accepted  # This object is replaced, never changed.
        try:
            path = read_param("config_file", "")
            if not path:
                raise RuntimeError("~config_file does not name a file")
            # roslaunch and a node resolve a relative path in different folders.
            if not os.path.isabs(path):
                raise RuntimeError(f"~config_file is {brief(path)}, must be an absolute path")
            # As requireOwnLaunch() in C++ finds it; rospy goes by sys.argv as well.
            launched = any(word.startswith("__log:=") for word in sys.argv)
            _transport.require_own_launch(path, launched)
            values = {name: accepted[name] for name in self._type.defaults}
            replace_file(path, self._edit(path, read_text(path), values).encode())
        except (OSError, RuntimeError, ValueError) as error:
            # For instance, the file of an installed package may not be written.
            says = printable(str(error), MAX_ERROR_LENGTH)
            reason = f"{says}{OTHER_FILE_HINT if isinstance(error, OSError) else ''}"
            rospy.logerr("parameters not saved: %s", reason)
            return TriggerResponse(False, reason)
        return TriggerResponse(True, path)


class _Server(dynamic_reconfigure.server.Server):
    def __init__(self, config_type: Any, change: Callable[[Dict[str, Any], int], Dict[str, Any]]):
        context = current()
        self._set = context.bind(super()._set_callback)
        context.closes(self._close)
        super().__init__(config_type, change, context.reconfigure_namespace)

    def _set_callback(self, request: Any) -> Any:
        return self._set(request)

    def _close(self) -> None:
        made = vars(self)  # by the constructor, unless the values were refused
        for name, end in (
            ("set_service", "shutdown"),
            ("update_topic", "unregister"),
            ("descr_topic", "unregister"),
        ):
            if name in made:
                getattr(made[name], end)()

    def _clamp(self, config: Dict[str, Any]) -> None:
        """Keeps values out of range, so that the node refuses them instead of clamping them."""
