"""The fields of the requests that a page makes: what each may hold, and what is refused."""

import math
from typing import Any, Dict, Tuple
from typing import Mapping as MappingType

from ..common.plain_text import brief
from ..common.ranges import require_range

REQUIRED = object()  # the default of a field that every request has to have
MAX_TEXT = 256  # letters of a text, unless the field says otherwise
MAX_EXACT = 2**53  # integers up to this one are exact in a browser


class Field:
    """What a field of a request may hold. `default` is its value where a request lacks it."""

    default: Any = REQUIRED

    def check(self, name: str, value: Any) -> Any:
        """Returns the value, maybe of a simpler type; raises ValueError if it is none of these."""
        raise NotImplementedError


class Text(Field):
    """A text of printable letters."""

    def __init__(self, max_length: int = MAX_TEXT, default: Any = REQUIRED):
        self.max_length = max_length
        self.default = default

    def check(self, name: str, value: Any) -> str:
        if isinstance(value, str) and len(value) <= self.max_length and value.isprintable():
            return value
        raise _refusal(name, value, f"a text of at most {self.max_length} printable letters")


class Number(Field):
    """A number within limits: an int if `integer`, else a float."""

    def __init__(self, low: float, high: float, integer: bool = False, default: Any = REQUIRED):
        self.low, self.high = low, high
        self.integer = integer
        self.default = default

    def check(self, name: str, value: Any) -> float:
        kind = "an integer" if self.integer else "a number"
        # JSON does not tell 3 from 3.0, nor do browsers.
        if not _is_number(value) or (self.integer and value != math.floor(value)):
            raise _refusal(name, value, kind)
        require_range(name, value, self.low, self.high)
        return int(value) if self.integer else float(value)


class Flag(Field):
    """True or false."""

    def __init__(self, default: Any = REQUIRED):
        self.default = default

    def check(self, name: str, value: Any) -> bool:
        if isinstance(value, bool):
            return value
        raise _refusal(name, value, "true or false")


class Choice(Field):
    """One of some texts."""

    def __init__(self, *values: str, default: Any = REQUIRED):
        self.values = values
        self.default = default

    def check(self, name: str, value: Any) -> str:
        if isinstance(value, str) and value in self.values:
            return value
        raise _refusal(name, value, f"one of {', '.join(self.values)}")


class Names(Field):
    """A list of texts."""

    def __init__(self, max_count: int, default: Any = REQUIRED):
        self.max_count = max_count
        self.default = default

    def check(self, name: str, value: Any) -> Tuple[str, ...]:
        text = Text()
        if not isinstance(value, list) or len(value) > self.max_count:
            raise _refusal(name, value, f"a list of at most {self.max_count} texts")
        return [text.check(f"{name}[{index}]", entry) for index, entry in enumerate(value)]


class Mapping(Field):
    """Values by name: booleans, finite numbers and texts."""

    def __init__(self, max_count: int, default: Any = REQUIRED):
        self.max_count = max_count
        self.default = default

    def check(self, name: str, value: Any) -> Dict[str, Any]:
        if not isinstance(value, dict) or len(value) > self.max_count:
            raise _refusal(name, value, f"at most {self.max_count} values by name")
        return {
            Text().check(f"a name in {name}", key): self._value(f"{name}.{key}", entry)
            for key, entry in value.items()
        }

    def _value(self, name: str, value: Any) -> Any:
        if isinstance(value, bool) or _is_number(value):
            return value
        if isinstance(value, str) and len(value) <= 4096:
            return value
        raise _refusal(name, value, "true or false, a finite number or a text")


class Region(Field):
    """A rectangle of an image in px: {"x", "y", "width", "height"}."""

    MAX = 65535  # px
    KEYS = ("x", "y", "width", "height")

    def __init__(self, default: Any = REQUIRED):
        self.default = default

    def check(self, name: str, value: Any) -> Dict[str, int]:
        if not isinstance(value, dict) or set(value) != set(self.KEYS):
            raise _refusal(name, value, "x, y, width and height in px")
        number = Number(0, self.MAX, integer=True)
        return {key: number.check(f"{name}.{key}", value[key]) for key in self.KEYS}


def checked(fields: MappingType[str, Field], request: Dict[str, Any]) -> Dict[str, Any]:
    """Returns the values of all fields of a request, with defaults for those that it lacks.

    Raises:
        ValueError: A field is missing, unknown or has a value that it may not have.
    """
    for name in request:
        if name not in fields:
            expected = ", ".join(fields) or "none"
            raise ValueError(f"there is no field {brief(name)}, the fields are: {expected}")
    values = {}
    for name, field in fields.items():
        if name in request:
            values[name] = field.check(name, request[name])
        elif field.default is REQUIRED:
            raise ValueError(f"the field {name} is missing")
        else:
            values[name] = field.default
    return values


def _is_number(value: Any) -> bool:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    return abs(value) <= MAX_EXACT if isinstance(value, int) else math.isfinite(value)


def _refusal(name: str, value: Any, expected: str) -> ValueError:
    return ValueError(f"{name} is {brief(value)}, must be {expected}")
