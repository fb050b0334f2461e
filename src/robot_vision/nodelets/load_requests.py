"""What a request to load a node says, checked."""

import re
from typing import Any, Dict, List, NamedTuple

import rosgraph.names

from ..common.plain_text import MAX_NAME_LENGTH, brief

MAX_REMAPPINGS = 1000
_TYPE = re.compile(r"[A-Za-z]\w*(/\w[\w.:]*)+")  # also names of classes, as old lookup names are


class LoadRequest(NamedTuple):
    """A node that is to be loaded.

    Attributes:
        name: Its name, which begins with a slash.
        type: As nodelet has them, package/name.
        remappings: Names by names, both resolved.
        arguments: Words of its command line.
        bond_id: The id of a bond with who loads it, or "".
    """

    name: str
    type: str
    remappings: Dict[str, str]
    arguments: List[str]
    bond_id: str


def checked(request: Any, manager: str) -> LoadRequest:
    """Returns what a nodelet/NodeletLoad request says.

    Args:
        request: The request.
        manager: The name of the manager, in whose namespace a relative name is.

    Raises:
        ValueError: A part of it cannot be used; the message names it, and what it must be.
    """
    name = resolved_name(request.name, manager)
    if name == manager:
        raise ValueError(f"name is {brief(name)}, must be another one than the manager's")
    if not (len(request.type) <= MAX_NAME_LENGTH and _TYPE.fullmatch(request.type)):
        raise ValueError(f"type is {brief(request.type)}, must be like robot_vision/hsv_tracker")
    if not (len(request.bond_id) <= MAX_NAME_LENGTH and request.bond_id.isprintable()):
        raise ValueError(f"bond_id is {brief(request.bond_id)}, must be the id of a bond")
    return LoadRequest(
        name, request.type, _remappings(request, name), list(request.my_argv), request.bond_id
    )


def resolved_name(name: str, manager: str) -> str:
    """Returns the name of a node with its namespace; raises ValueError if it can be of none."""
    _require_name("name", name)
    resolved = rosgraph.names.resolve_name(name, manager)
    if resolved.strip("/") == "":
        raise ValueError(f"name is {brief(name)}, must be the name of a node")
    return resolved.rstrip("/")


def _remappings(request: Any, name: str) -> Dict[str, str]:
    sources, targets = request.remap_source_args, request.remap_target_args
    if len(sources) != len(targets) or len(sources) > MAX_REMAPPINGS:
        raise ValueError(
            f"remap_source_args and remap_target_args are {len(sources)} and {len(targets)} names, "
            f"must be as many, at most {MAX_REMAPPINGS}"
        )
    resolved = {}
    for source, target in zip(sources, targets):
        if source.startswith("__"):  # as __name, which are no names of topics
            continue
        _require_name("remap_source_args", source)
        _require_name("remap_target_args", target)
        resolve = rosgraph.names.resolve_name
        resolved[resolve(source, name)] = resolve(target, name)
    return resolved


def _require_name(what: str, name: str) -> None:
    legal = 0 < len(name) <= MAX_NAME_LENGTH and rosgraph.names.is_legal_name(name)
    if not legal:
        raise ValueError(
            f"{what} is {brief(name)}, must be a name of at most {MAX_NAME_LENGTH} letters, "
            "digits, _ and /"
        )
