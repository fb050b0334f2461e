"""What a page can ask for: operations with a name, a role and fields."""

import json
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Iterable, Mapping, Tuple

from ..common.plain_text import brief
from .fields import MAX_EXACT, Field, checked

MAX_DIGITS = 40  # of an integer: longer ones are read in quadratic time
RESERVED = {"op", "id"}  # what each request has: its operation, and its number
ROLES = ("view", "control")  # each may do what those before it may


@dataclass(frozen=True)
class Operation:
    """An operation that a page can ask for.

    Attributes:
        name: Its name.
        run: run(session, fields) is called in a worker thread, with exactly the fields below. It
            may block for some seconds, and returns what JSON can hold. ValueError, OSError and the
            errors of rospy are told to the page; others are logged and told as internal errors.
        role: "view" or "control".
        fields: The fields of its requests by name.
        beside: Whether the session's next requests need not wait for it.
    """

    name: str
    run: Callable[[Any, Dict[str, Any]], Any]
    role: str = "control"
    fields: Mapping[str, Field] = field(default_factory=dict)
    beside: bool = False


class OperationTable:
    """All operations by name.

    Args:
        operations: The operations.

    Raises:
        ValueError: Two have the same name, or one has a role that does not exist, or a field whose
            name each request has already.
    """

    def __init__(self, operations: Iterable[Operation]):
        self._operations: Dict[str, Operation] = {}
        for operation in operations:
            if operation.name in self._operations:
                raise ValueError(f"there are two operations {operation.name}")
            if operation.role not in ROLES:
                raise ValueError(f"the operation {operation.name} has the role {operation.role}")
            for name in RESERVED.intersection(operation.fields):
                raise ValueError(f"the operation {operation.name} has the field {name}")
            self._operations[operation.name] = operation

    def find(self, name: Any, role: str, request: Dict[str, Any]) -> Tuple[Operation, Dict]:
        """Returns the operation of a request and the values of its fields.

        Raises:
            ValueError: There is no such operation, this role may not ask for it, or a field is
                wrong.
        """
        operation = self._operations.get(name) if isinstance(name, str) else None
        if operation is None:
            raise ValueError(f"there is no operation {brief(name)}")
        if not may(role, operation.role):
            raise ValueError(
                f"{operation.name} needs the role control: open the address with the other token"
            )
        return operation, checked(operation.fields, request)


def may(role: str, needed: str) -> bool:
    """Returns whether a role, "" for none, includes another one."""
    return role in ROLES and ROLES.index(role) >= ROLES.index(needed)


def parse_request(text: str) -> Dict[str, Any]:
    """Returns the JSON object in a message of a page.

    Raises:
        ValueError: It is none, it is nested too deeply, or it has numbers that JSON does not have.
    """
    try:
        request = _decoder.decode(text)
    except RecursionError:
        raise ValueError("the message is nested too deeply") from None
    except json.JSONDecodeError as error:
        raise ValueError(f"the message is no JSON: {error}") from None
    if not isinstance(request, dict):
        raise ValueError("the message is no JSON object")
    return request


def request_number(request: Dict[str, Any]) -> int:
    """Takes the "id" out of a request and returns it; raises ValueError if it has none."""
    number = request.pop("id", None)
    if type(number) is not int or not 0 <= number <= MAX_EXACT:
        raise ValueError(f"id is {brief(number)}, must be an integer from 0 to 2^53")
    return number


def _no_constant(name: str) -> float:
    raise ValueError(f"the message has the number {name}, must have finite ones")


def _short_integer(digits: str) -> int:
    if len(digits) > MAX_DIGITS:
        raise ValueError(f"the message has an integer of more than {MAX_DIGITS} digits")
    return int(digits)


# Pages acknowledge each frame: it is not made anew for each message.
_decoder = json.JSONDecoder(parse_constant=_no_constant, parse_int=_short_integer)
