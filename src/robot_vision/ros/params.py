"""A node's parameters: read strictly, changed live, saved."""

import copy
import difflib
import math
import os
import pathlib
import re
import sys
from typing import Any, Callable, Dict, Optional, TypeVar

import dynamic_reconfigure.server
import rosgraph
import rospy
from std_srvs.srv import Trigger, TriggerResponse

from .. import _transport
from ..common.files import read_text, replace_file
from ..common.plain_text import NAME, is_name, printable, told

Params = TypeVar("Params")

# What its transport and LiveParams ask for in their own ways, and what it is without a parameter.
ASKED_ELSEWHERE = {"config_file": "", "diagnostic_period": 1.0, "image_transport": "raw"}
# What a node has asked for, and whether it is another than the default.
_known: Dict[str, bool] = {}

ELSEWHERE = "; ~config_file names the file, as config:=/absolute/path.yaml of the launch files does"
LONGEST_ERROR = 1000  # letters, the path of a file among them
TRANSPORTS = ("compressed", "compressedDepth", "theora")
TYPES = {bool: "true or false", int: "an integer", float: "a number", str: "a string"}


def read_param(
    name: str, default: Any, low: float = -math.inf, high: float = math.inf, zero: str = ""
) -> Any:
    """The private parameter `name`, or `default` if it is not set.

    Args:
        low: the least that a number can be; without `low` and `high` all will do that are finite.
        high: the most.
        zero: what 0 means, for the error.

    Raises:
        ValueError: it is of another type than the default, or out of range; an integer will do for
            a float.
    """
    value = read_any(name, default)
    kind = type(default)
    if kind is float and type(value) is int:
        value = float(value)
    if type(value) is not kind:
        raise ValueError(f"{name} is {told(value)}, must be {TYPES[kind]}")
    if kind in (int, float):
        _require_range(name, value, low, high, zero)
    return value


def read_name(name: str, default: str) -> str:
    """As read_param, of a frame, node or the like: a line of text that all of ROS can show.

    Raises:
        ValueError: it is no string, empty, too long, or not printable.
    """
    value = read_param(name, default)
    if not is_name(value):
        raise ValueError(f"{name} is {told(value)}, must be {NAME}")
    return value


def read_any(name: str, default: Any) -> Any:
    """The private parameter `name` of any type, or `default` if it is not set."""
    value = rospy.get_param("~" + name, default)
    _known[name] = value != default
    return value


def review_params() -> None:
    """Says which private parameters are not at their defaults, and which nobody has asked for.

    The first, in one line, may have been left by another run; the others may be misspelt. Of these
    maps are left out that are named as a transport, or as the namespace of a node, topic or
    service.
    """
    for name, default in ASKED_ELSEWHERE.items():
        read_any(name, default)
    there = sorted(rospy.get_param("~", {}).items())
    changed = [f"{name}: {told(value)}" for name, value in there if _known.get(name)]
    if changed:
        rospy.loginfo("%s: set on the parameter server: %s", rospy.get_name(), ", ".join(changed))
    for name, value in there:
        path = rospy.resolve_name("~" + name)
        if name in _known or (isinstance(value, dict) and _is_of_others(name, path)):
            continue
        near = difflib.get_close_matches(name, _known, 1)
        hint = f", is {near[0]} meant?" if near else ""
        rospy.logwarn("parameter %s is not known%s", path, hint)


def _is_of_others(name: str, path: str) -> bool:
    """Whether a map of parameters may be of a transport, or of another node, a topic or service."""
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
    """Parameters that change through dynamic_reconfigure and are saved by ~save_parameters.

    Args:
        config_type: the module that is generated from the .cfg file; its ranges are kept.
        apply: puts values (by name) to use; may correct them in place, or raise ValueError to
            refuse them: fatal at start; live, the old values stay and a warning says why.
        edit: puts values into the text of the file that ~config_file names: edit(path, text,
            values) is the new text. None: each is a line of it.

    Raises:
        ValueError: a parameter has the wrong type, or is refused.
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
            rospy.set_param("~" + name, read_param(name, default, low, high))
        self._server = _Server(config_type, self._change)
        rospy.Service("~save_parameters", Trigger, self._on_save)

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
            if low != "" and type(config[name]) is not bool:
                _require_range(name, config[name], low, high)

    def _on_save(self, _request: Any) -> TriggerResponse:
        accepted = self._accepted  # it is replaced, never changed
        try:
            path = read_param("config_file", "")
            if not path:
                raise RuntimeError("~config_file does not name a file")
            # roslaunch has read it in its own folder, a node has another.
            if not os.path.isabs(path):
                raise RuntimeError(f"~config_file is {told(path)}, must be an absolute path")
            _require_own_launch(path)
            values = {name: accepted[name] for name in self._type.defaults}
            replace_file(path, self._edit(path, read_text(path), values).encode())
        except (OSError, RuntimeError, ValueError) as error:
            # Such as the file of an installed package.
            says = printable(str(error), LONGEST_ERROR)
            why = f"{says}{ELSEWHERE if isinstance(error, OSError) else ''}"
            rospy.logerr("parameters not saved: %s", why)
            return TriggerResponse(False, why)
        return TriggerResponse(True, path)


def _require_range(name: str, value: float, low: float, high: float, zero: str = "") -> None:
    """Raises ValueError for a number out of range, as NaN and what is infinite always are."""
    if math.isfinite(value) and low <= value <= high:
        return
    meant = f" ({zero})" if zero else ""
    span = f"from {low:g}{meant} to {high:g}" if math.isfinite(low + high) else "finite"
    raise ValueError(f"{name} is {value:g}, must be {span}")


def _require_own_launch(path: str) -> None:
    """Refuses a file of this package to a node that rosrun has started.

    Then it is not the file of the node's launch file, but has been left on the parameter server by
    one that has ended. roslaunch names the file of the log to each process that it starts.
    """
    launched = any(word.startswith("__log:=") for word in sys.argv)
    if not launched and _is_of_this_package(path):
        raise RuntimeError(
            f"~config_file is '{path}', a file of the package, to which only what roslaunch starts "
            "saves; name another one: _config_file:=/absolute/path.yaml"
        )


def _is_of_this_package(path: str) -> bool:
    """Whatever copy of the package it is: the sources, or an installed one."""
    for folder in pathlib.Path(os.path.realpath(path)).parents:
        manifest = folder / "package.xml"
        if manifest.is_file():
            return "<name>robot_vision</name>" in manifest.read_text(encoding="utf-8")
    return False


class _Server(dynamic_reconfigure.server.Server):
    def _clamp(self, config: Dict[str, Any]) -> None:
        """Leaves values out of range as they are, for the node to refuse instead of moving them."""
