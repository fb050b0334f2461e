"""Values that are set: their types, and whether a node has taken them."""

import math
from typing import Any, Dict, Mapping, Tuple

from ..common.plain_text import brief
from .parameter_description import TYPES

TOLERANCE = 1e-6  # relative difference of numbers that are the same
MEANS = {"bool": "true or false", "int": "an integer", "double": "a number", "str": "a text"}
MAX_INT = 2**31 - 1


def typed(
    values: Mapping[str, Any], types: Mapping[str, str]
) -> Tuple[Dict[str, Any], Dict[str, str]]:
    """Returns values with the types of the parameters, and which have none that fits, and why."""
    wanted: Dict[str, Any] = {}
    refused: Dict[str, str] = {}
    for name, value in values.items():
        kind = types.get(name)
        if kind is None:
            refused[name] = "the node has no such parameter"
        elif kind == "double" and type(value) in (int, float):
            wanted[name] = float(value)
        elif kind == "int" and type(value) is float and value.is_integer():
            wanted[name] = int(value)
        elif type(value) is TYPES[kind]:
            wanted[name] = value
        else:
            refused[name] = f"{name} is {brief(value)}, must be {MEANS[kind]}"
        if kind == "int" and abs(wanted.get(name, 0)) > MAX_INT:
            refused[name] = f"{name} is {wanted.pop(name)}, must be an integer of 32 bits"
    return wanted, refused


def same(wanted: Any, value: Any) -> bool:
    """Returns whether a node has the value that it was given."""
    if isinstance(wanted, float) and isinstance(value, float):
        return math.isclose(wanted, value, rel_tol=TOLERANCE, abs_tol=1e-12)
    return type(wanted) is type(value) and wanted == value
