"""A node's parameters, strictly checked at start. live_params.py has those that change later."""

import difflib
import math
from typing import Any, Dict, Iterable

import rosgraph
import rospy

from ..common.plain_text import NAME, brief, is_name
from ..common.ranges import require_range
from .context import current

# Parameters that the transports and LiveParams read in their own ways, and their defaults.
READ_ELSEWHERE = {"config_file": "", "diagnostic_period": 1.0, "image_transport": "auto"}
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
    return check(name, read_any(name, default), default, low, high, zero)


def check(name: str, value: Any, default: Any, low: float, high: float, zero: str = "") -> Any:
    """Returns a value that a parameter has, as read_param() does; raises ValueError as well."""
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
    note_known(name, value, default)
    return value


def present_params(names: Iterable[str]) -> Dict[str, Any]:
    """Returns those of these private parameters that are set. The master is asked once."""
    node, there = current(), current().private_params()
    present = {}
    for name in names:
        if rospy.resolve_name(node.given("~" + name)) != f"{node.name}/{name}":  # it is remapped
            if node.has_param("~" + name):
                present[name] = node.get_param("~" + name)
        elif name in there:
            present[name] = there[name]
    return present


def note_known(name: str, value: Any, default: Any) -> None:
    """Notes for review_params() that a node has read a parameter, and whether it is the default."""
    _known()[name] = value != default


def review_params() -> None:
    """Logs which private parameters differ from their defaults, and which are not known.

    The former, in one line, may be left over from another run. The latter may be misspelt. Maps
    are not counted among them if they have the name of a transport, or are the namespace of
    another node, of a topic or of a service.
    """
    there, known = current().private_params(), _known()
    for name, default in READ_ELSEWHERE.items():
        note_known(name, there.get(name, default), default)
    changed = [
        f"{name}: {brief(value)}" for name, value in sorted(there.items()) if known.get(name)
    ]
    if changed:
        rospy.loginfo("%s: set on the parameter server: %s", current().name, ", ".join(changed))
    for name, value in sorted(there.items()):
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
