"""A node's parameters: read strictly, changed live, saved."""

import copy
import difflib
import os
from typing import Any, Callable, Dict, Iterable, Optional, TypeVar

import dynamic_reconfigure.server
import rospy
from std_srvs.srv import Trigger, TriggerResponse

from .. import _transport
from ..files import read_text, replace_file

Params = TypeVar("Params")

# What a node has asked for, and what its transport and LiveParams ask for in their own ways.
_known = {"config_file", "diagnostic_period", "image_transport"}

ELSEWHERE = "; ~config_file names the file, as config:=/absolute/path.yaml of the launch files does"
TYPES = {bool: "true or false", int: "an integer", float: "a number", str: "a string"}


def read_param(name: str, default: Any) -> Any:
    """The private parameter `name`, or `default` if it is not set.

    Raises:
        ValueError: it is of another type than the default; an integer will do for a float.
    """
    value = read_any(name, default)
    kind = type(default)
    if kind is float and type(value) is int:
        value = float(value)
    if type(value) is not kind:
        raise ValueError(f"{name} is {value!r}, must be {TYPES[kind]}")
    return value


def read_any(name: str, default: Any) -> Any:
    """The private parameter `name` of any type, or `default` if it is not set."""
    _known.add(name)
    return rospy.get_param("~" + name, default)


def warn_of_unknown() -> None:
    """Names private parameters that nobody has asked for: they may be misspelt.

    Maps are left out, which are names of other nodes and transports, too.
    """
    for name, value in sorted(rospy.get_param("~", {}).items()):
        if name in _known or isinstance(value, dict):
            continue
        near = difflib.get_close_matches(name, _known, 1)
        hint = f", is {near[0]} meant?" if near else ""
        rospy.logwarn("parameter %s is not known%s", rospy.resolve_name("~" + name), hint)


def filled(params: Params, config: Dict[str, Any], names: Iterable[str]) -> Params:
    """The core's parameters with live ones of the same names in them."""
    for name in names:
        setattr(params, name, config[name])
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
            rospy.set_param("~" + name, read_param(name, default))
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
            if low != "" and type(config[name]) is not bool and not low <= config[name] <= high:
                raise ValueError(f"{name} is {config[name]:g}, must be from {low:g} to {high:g}")

    def _on_save(self, _request: Any) -> TriggerResponse:
        accepted = self._accepted  # it is replaced, never changed
        try:
            path = read_param("config_file", "")
            if not path:
                raise RuntimeError("~config_file does not name a file")
            if not os.path.isabs(
                path
            ):  # roslaunch has read it in its own folder, a node has another
                raise RuntimeError(f"~config_file is '{path}', must be an absolute path")
            values = {name: accepted[name] for name in self._type.defaults}
            replace_file(path, self._edit(path, read_text(path), values).encode())
        except (OSError, RuntimeError, ValueError) as error:
            # Such as the file of an installed package.
            why = f"{error}{ELSEWHERE if isinstance(error, OSError) else ''}"
            rospy.logerr("parameters not saved: %s", why)
            return TriggerResponse(False, why)
        return TriggerResponse(True, path)


class _Server(dynamic_reconfigure.server.Server):
    def _clamp(self, config: Dict[str, Any]) -> None:
        """Leaves values out of range as they are, for the node to refuse instead of moving them."""
