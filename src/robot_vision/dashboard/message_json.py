"""Messages of any type as what JSON can hold.

Numbers that are not finite are null. Times and durations are seconds. uint8[] and char[] are
base64. What is too long is cut, and "_cut" beside it has its whole length by its name:
{"outline": [...], "_cut": {"outline": 10000}}.

| what | limit |
|---|---|
| an array | MAX_ITEMS |
| all arrays of messages, times or texts together | MAX_OBJECTS |
| all arrays of numbers together, and of messages that are numbers, as points | MAX_VALUES |
| uint8[] and char[] | MAX_BYTES; longer ones are null |
| a text | MAX_TEXT characters |
"""

import base64
import functools
import math
import operator
from typing import Any, Callable, Dict, List, Tuple, Type

import genpy
import roslib.message

MAX_ITEMS = 3072  # three channels of a histogram with 1024 bins
MAX_OBJECTS = 5000
MAX_VALUES = 50000
MAX_BYTES = 4096
MAX_TEXT = 4096
CUT = "_cut"
INTEGERS = {f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)} | {"byte", "char"}
REALS = {"float32", "float64"}
NUMBERS = INTEGERS | REALS | {"bool"}
TIMES = {"time", "duration"}
BYTES = {"uint8", "char"}  # whose arrays rospy has as bytes

Convert = Callable[[Any, "_Budget"], Any]


def to_plain(message: Any) -> Dict[str, Any]:
    """Returns a message as what JSON can hold: see above."""
    return _plan_of(type(message)).convert(message, _Budget())


def stamp_of(message: Any) -> float:
    """Returns the time in a message's header in s; 0 if it has none."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    return stamp.to_sec() if isinstance(stamp, genpy.Time) else 0.0


class CutError(Exception):
    """Raised with what is left of a value that was too long, and the length that it had."""

    def __init__(self, left: Any, length: int):
        super().__init__()
        self.left, self.length = left, length


class _Budget:
    """What a message may still hold in all."""

    def __init__(self) -> None:
        self.objects = MAX_OBJECTS
        self.values = MAX_VALUES


class _Plan:
    """How messages of one type are converted. What is converted to itself costs next to nothing."""

    def __init__(self, kind: Type[Any]):
        names: List[str] = list(kind.__slots__)
        self._names = names
        self._get = operator.attrgetter(*names) if names else lambda _: ()
        self._single = len(names) == 1
        self._converts: List[Tuple[str, Convert]] = [
            (name, convert)
            for name, convert in zip(names, map(_converter, kind._slot_types))
            if convert is not _same
        ]
        # How many numbers a message has, if it has nothing else.
        self.numbers = len(names) if NUMBERS.issuperset(kind._slot_types) else 0

    def convert(self, message: Any, budget: _Budget) -> Dict[str, Any]:
        values = self._get(message)
        made = {self._names[0]: values} if self._single else dict(zip(self._names, values))
        cut: Dict[str, int] = {}
        for name, convert in self._converts:
            try:
                made[name] = convert(made[name], budget)
            except CutError as error:
                made[name] = error.left
                cut[name] = error.length
        if cut:
            made[CUT] = cut
        return made


@functools.lru_cache(maxsize=1000)
def _plan_of(kind: Type[Any]) -> _Plan:
    return _Plan(kind)


def _plan_named(kind: str) -> _Plan:
    found = roslib.message.get_message_class("std_msgs/Header" if kind == "Header" else kind)
    if found is None:
        raise ValueError(f"the type {kind} is not installed here")
    return _plan_of(found)


def _converter(kind: str) -> Convert:
    """Returns the function that converts a value of a type, as message definitions name it."""
    if kind.endswith("]"):
        return _array_converter(kind[: kind.index("[")])
    if kind in REALS:
        return _real
    if kind in NUMBERS:
        return _same
    if kind in TIMES:
        return _time
    return _text if kind == "string" else _plan_named(kind).convert


def _array_converter(item: str) -> Convert:
    if item in BYTES:
        return _bytes
    if item in NUMBERS:
        return _reals if item in REALS else _integers
    if item in TIMES or item == "string":
        return functools.partial(_objects, _converter(item))
    plan = _plan_named(item)
    return (
        functools.partial(_points, plan)
        if plan.numbers
        else functools.partial(_objects, plan.convert)
    )


def _same(value: Any, _budget: _Budget) -> Any:
    return value


def _real(value: float, _budget: _Budget) -> Any:
    return value if math.isfinite(value) else None


def _time(value: Any, _budget: _Budget) -> float:
    return float(value.secs + value.nsecs * 1e-9)


def _text(value: Any, _budget: _Budget) -> str:
    text = value.decode(errors="replace") if isinstance(value, bytes) else value
    if len(text) > MAX_TEXT:
        raise CutError(text[:MAX_TEXT], len(text))
    return text


def _bytes(value: Any, _budget: _Budget) -> str:
    if len(value) > MAX_BYTES:
        raise CutError(None, len(value))
    return base64.b64encode(bytes(value)).decode()


def _reals(values: Any, budget: _Budget) -> List[Any]:
    taken = _taken(values, budget)
    # A sum is finite only if all numbers are; it may overflow though they are.
    if not math.isfinite(sum(taken)):
        taken = [value if math.isfinite(value) else None for value in taken]
    return _or_cut(taken, values)


def _integers(values: Any, budget: _Budget) -> List[Any]:
    return _or_cut(_taken(values, budget), values)


def _taken(values: Any, budget: _Budget) -> List[Any]:
    taken = list(values[: min(MAX_ITEMS, budget.values)])
    budget.values -= len(taken)
    return taken


def _points(plan: _Plan, values: Any, budget: _Budget) -> List[Any]:
    """Converts an array of messages with numbers only, which count as these numbers."""
    taken = values[: min(MAX_ITEMS, budget.values // plan.numbers)]
    budget.values -= plan.numbers * len(taken)
    return _or_cut([plan.convert(value, budget) for value in taken], values)


def _objects(convert: Convert, values: Any, budget: _Budget) -> List[Any]:
    """Converts an array of messages, times or texts."""
    made: List[Any] = []
    for value in values[:MAX_ITEMS]:
        if budget.objects <= 0:
            break
        budget.objects -= 1
        try:
            made.append(convert(value, budget))
        except CutError as error:  # a text
            made.append(error.left)
    return _or_cut(made, values)


def _or_cut(made: List[Any], values: Any) -> List[Any]:
    if len(made) < len(values):
        raise CutError(made, len(values))
    return made
