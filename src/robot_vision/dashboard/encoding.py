"""JSON as browsers read it."""

import json
import math
from typing import Any


def to_json(data: Any) -> str:
    """Returns data as JSON: what NumPy has as plain numbers and lists, NaN and infinity as null.

    Raises:
        TypeError: JSON cannot hold something in it.
    """
    try:
        return json.dumps(data, allow_nan=False, separators=(",", ":"), default=_plain)
    except ValueError:  # A number is not finite, which JSON cannot say.
        return json.dumps(_finite(data), allow_nan=False, separators=(",", ":"), default=_plain)


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        return _finite(value.tolist())
    raise TypeError(f"{type(value).__name__} cannot be told as JSON")


def _finite(data: Any) -> Any:
    if isinstance(data, float):
        return data if math.isfinite(data) else None
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_finite(value) for value in data]
    return data
