"""What a node says of its live parameters, put into the form that the page gets.

Nodes say it in dynamic_reconfigure's messages, whose texts are data here: nothing is evaluated.
"""

import ast
import math
import re
from typing import Any, Dict, List, Tuple

from ..common.plain_text import printable

MAX_PARAMETERS = 2000  # of a node
MAX_GROUPS = 200
MAX_CHOICES = 500  # of a parameter
# Characters. Python 3.8 makes objects of a sum by recursion: one of 100,000 terms ends the process.
MAX_EDIT_METHOD = 1 << 16
MAX_DESCRIPTION = 1000  # characters
MAX_NAME = 255  # characters
MAX_UNIT = 20  # characters; what is longer in parentheses is no unit
MAX_VALUE = 4096  # characters of a text
# A description's end as "side of the Gaussian blur (px, odd)" has it.
UNIT = re.compile(r" ?\(([^()]*)\)$")
INT_MIN, INT_MAX = -(2**31), 2**31 - 1  # mean no limit
MAX_FINITE = 1e300  # a number from there on means no limit
TYPES = {"bool": bool, "int": int, "double": float, "str": str}


def values_of(config: Any) -> Dict[str, Any]:
    """Returns the values of a dynamic_reconfigure/Config by name."""
    return {
        entry.name: entry.value
        for entry in (*config.bools, *config.ints, *config.strs, *config.doubles)
    }


def types_of(description: Any) -> Dict[str, str]:
    """Returns bool, int, double or str for each parameter of a ConfigDescription."""
    entries = [entry for group in description.groups for entry in group.parameters]
    return {entry.name: entry.type for entry in entries[:MAX_PARAMETERS] if entry.type in TYPES}


def split_unit(description: str) -> Tuple[str, str]:
    """Returns a description without the unit in parentheses at its end, and the unit or ""."""
    found = UNIT.search(description)
    if not found or len(found[1]) > MAX_UNIT:
        return description, ""
    return description[: found.start()], found[1]


def groups_of(description: Any) -> List[Dict[str, Any]]:
    """Returns the groups of a ConfigDescription, those inside of others in their "groups"."""
    limits = tuple(map(values_of, (description.min, description.max, description.dflt)))
    known = types_of(description)
    entries = description.groups[:MAX_GROUPS]
    made = [
        {
            "name": printable(group.name, MAX_NAME),
            "parameters": [
                _parameter(entry, limits) for entry in group.parameters if entry.name in known
            ],
            "groups": [],
        }
        for group in entries
    ]
    top = []
    places = {group.id: place for place, group in reversed(list(enumerate(entries)))}
    for place, group in enumerate(entries):
        above = places.get(group.parent)
        # One that says it is in itself, or in one behind it, would never be seen.
        inside = above is not None and above < place
        (made[above]["groups"] if inside else top).append(made[place])
    return top


def _parameter(entry: Any, limits: Tuple[Dict[str, Any], ...]) -> Dict[str, Any]:
    low, high, default = (values.get(entry.name) for values in limits)
    description, unit = split_unit(printable(entry.description, MAX_DESCRIPTION))
    return {
        "name": entry.name,
        "type": entry.type,
        "min": _limit(entry.type, low),
        "max": _limit(entry.type, high),
        "default": default,
        "description": description,
        "unit": unit,
        "choices": choices_of(entry.edit_method, entry.type),
    }


def _limit(kind: str, value: Any) -> Any:
    """Returns a limit, or None if it means that there is none."""
    if kind not in ("int", "double") or not isinstance(value, (int, float)):
        return None
    if not math.isfinite(value) or abs(value) >= MAX_FINITE:
        return None
    return None if kind == "int" and value in (INT_MIN, INT_MAX) else value


def choices_of(edit_method: str, kind: str) -> List[Dict[str, Any]]:
    """Returns the values of an enumeration with their names and descriptions; else none.

    Args:
        edit_method: The source code of {"enum": [{"name": ..., "value": ...}, ...]}.
        kind: The type of the parameter.
    """
    if not edit_method or len(edit_method) > MAX_EDIT_METHOD:
        return []
    try:
        found = ast.literal_eval(edit_method)
        entries = found["enum"]
        choices = [_choice(entry, TYPES[kind]) for entry in entries[:MAX_CHOICES]]
    except (ValueError, SyntaxError, TypeError, KeyError, MemoryError, RecursionError):
        return []
    return choices


def _choice(entry: Any, kind: Any) -> Dict[str, Any]:
    name = printable(str(entry["name"]), MAX_NAME)
    text = printable(str(entry.get("description", "")), MAX_DESCRIPTION)
    value = entry["value"]
    if type(value) is not kind and not (kind is float and type(value) is int):
        raise ValueError("the value is of another type")
    return {"value": value, "name": name, "description": text or name}


def parameters_in(groups: List[Dict[str, Any]]) -> List[Dict[str, Any]]:
    """Returns the parameters of all groups."""
    found = []
    for group in groups:
        found += group["parameters"]
        found += parameters_in(group["groups"])
    return found
