"""Values of JSON documents that others may have written."""

import json
from typing import Any, List, Mapping, Optional

import numpy as np

from ...common.plain_text import brief
from .documents import storable

MAX_NUMBER = 1e9


def parsed(document: str) -> Any:
    """Returns what a document says; raises ValueError if it is none, or is nested too deeply."""
    try:
        return json.loads(document)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def text(values: Mapping[str, Any], key: str, default: Optional[str] = None) -> str:
    """Returns a text; without a default it has to be there."""
    value = values.get(key, default)
    if not _is_text(value):
        raise ValueError(f"{key} is {brief(value)}, must be a text")
    return value


def texts(values: Mapping[str, Any], key: str, default: Optional[List[str]] = None) -> List[str]:
    """Returns a list of texts; without a default it has to be there."""
    value = values.get(key, default)
    if not isinstance(value, list) or not all(map(_is_text, value)):
        raise ValueError(f"{key} is {brief(value)}, must be a list of texts")
    return value


def number(values: Mapping[str, Any], key: str) -> float:
    """Returns a finite number."""
    return _number(values.get(key), key)


def integer(values: Mapping[str, Any], key: str) -> int:
    """Returns a whole number."""
    value = values.get(key)
    if not isinstance(value, int) or isinstance(value, bool) or abs(value) > MAX_NUMBER:
        raise ValueError(f"{key} is {brief(value)}, must be a whole number to {MAX_NUMBER:g}")
    return value


def numbers(values: Mapping[str, Any], key: str, count: Optional[int]) -> List[float]:
    """Returns a list of finite numbers, `count` of them unless that is None."""
    value = values.get(key)
    if not isinstance(value, list) or (count is not None and len(value) != count):
        raise ValueError(f"{key} is {brief(value)}, must be a list of {count or 'finite'} numbers")
    return [_number(one, key) for one in value]


def matrix(values: Mapping[str, Any], key: str, size: int) -> np.ndarray:
    """Returns a square matrix of finite numbers, given as rows or as all numbers in a row."""
    value = values.get(key)
    rows = value if isinstance(value, list) else []
    flat = [one for row in rows for one in (row if isinstance(row, list) else [row])]
    if len(flat) != size * size:
        raise ValueError(f"{key} is {brief(value)}, must be {size} rows of {size} numbers")
    return np.array([_number(one, key) for one in flat]).reshape(size, size)


def _is_text(value: Any) -> bool:
    """Returns whether a value is a text without halves of letters, which JSON can have."""
    return isinstance(value, str) and storable(value) == value


def _number(value: Any, key: str) -> float:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not is_number or not abs(value) <= MAX_NUMBER:  # nor for NaN
        raise ValueError(f"{key} is {brief(value)}, must be a number to {MAX_NUMBER:g}")
    return float(value)
