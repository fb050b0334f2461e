"""Reading YAML that people wrote, within limits on its depth, its size and its numbers.

YAML aliases can stand for one another, so that a few lines mean more values than there are atoms.
Here each alias counts as all the values that it stands for.
"""

from typing import Any, Dict, Optional

import yaml

MAX_DEPTH = 20
MAX_VALUES = 20000  # including those that aliases stand for
MAX_NUMBER = 100  # characters of a scalar that is no string: numbers are read in quadratic time
STRING = "tag:yaml.org,2002:str"
MAX_MESSAGE = 200  # characters of an error message


def load_yaml(text: str) -> Any:
    """Returns the values of a YAML text.

    Raises:
        ValueError: The text is not YAML, or exceeds a limit. The message has one line and says
            where.
    """
    return _read(text, lambda loader: loader.get_single_data())


def compose_yaml(text: str) -> Optional[yaml.Node]:
    """Returns the YAML nodes of a text with their positions in it, or None if it is empty.

    Raises:
        ValueError: The text is not YAML, or exceeds a limit. The message has one line and says
            where.
    """
    return _read(text, lambda loader: loader.get_single_node())


def _read(text: str, of: Any) -> Any:
    try:
        return of(_BoundedLoader(text))
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        where = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise ValueError(where + _one_line(str(error.problem or error.context))) from None
    except Exception as error:  # for instance of an impossible date, or a number without digits
        raise ValueError(_one_line(str(error))) from None


class _BoundedLoader(yaml.SafeLoader):
    def __init__(self, text: str):
        super().__init__(text)
        self._depth = 0
        self._values = 0  # so far
        self._values_of: Dict[Optional[str], int] = {}  # by anchor, of the nodes that are complete

    def compose_node(self, parent: Optional[yaml.Node], index: Any) -> yaml.Node:
        event = self.peek_event()
        before = self._values
        self._depth += 1
        self._require(self._depth <= MAX_DEPTH, f"nested deeper than {MAX_DEPTH} levels", event)
        node = super().compose_node(parent, index)
        self._depth -= 1
        if isinstance(event, yaml.AliasEvent):
            self._require(event.anchor in self._values_of, "an alias of what it is part of", event)
            self._values += self._values_of[event.anchor]
        else:
            self._values += 1
            self._values_of[event.anchor] = self._values - before
        self._require(self._values <= MAX_VALUES, f"more than {MAX_VALUES} values", event)
        return node

    def compose_scalar_node(self, anchor: Any) -> yaml.Node:
        node = super().compose_scalar_node(anchor)
        is_short = node.tag == STRING or len(node.value) <= MAX_NUMBER
        self._require(is_short, f"no string, and longer than {MAX_NUMBER} characters", node)
        return node

    def _require(self, ok: bool, problem: str, place: Any) -> None:
        if not ok:
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=place.start_mark)


def _one_line(text: str) -> str:
    return " ".join(text.split())[:MAX_MESSAGE]
