"""The named colours of a node: the parameter ~colors, and the one that live parameters show."""

from typing import Any, Dict

import rospy

from .. import HsvRange, validate
from ..common.errors import about
from ..common.plain_text import brief, printable
from ..ros.params import filled, read_any, read_param

LOW = ("h_low", "s_low", "v_low")
HIGH = ("h_high", "s_high", "v_high")
MAX_LIST_LENGTH = 200  # characters of the names in an error
DEFAULT = {"blue": {"low": [90, 50, 50], "high": [120, 255, 255]}}


class NamedColors:
    """The ranges in ~colors by name. The live parameter `color` names the one in h_low .. v_high.

    Raises:
        ValueError: ~colors does not have the form {name: {low: [h, s, v], high: [h, s, v]}}, or
            a value is out of range.
    """

    def __init__(self) -> None:
        self.ranges: Dict[str, HsvRange] = {}
        given = read_any("colors", None)
        if given is None:
            given = _default()
        if not isinstance(given, dict) or not given:
            raise ValueError(
                f"colors is {brief(given)}, must be a map of at least one name to a range"
            )
        for name, entry in given.items():
            self.ranges[str(name)] = _range(str(name), entry)
        self._shown = ""
        self._values: Dict[str, int] = {}  # h_low .. v_high as they were shown last
        for name in (*LOW, *HIGH):  # At start ~colors has precedence over the live parameters.
            if rospy.has_param("~" + name):
                rospy.delete_param("~" + name)

    def update(self, config: Dict[str, Any]) -> None:
        """Takes over the limits that have changed in `config`, and updates the rest of it."""
        name = config["color"] or self._shown or next(iter(self.ranges))
        if name not in self.ranges:
            known = printable(", ".join(self.ranges), MAX_LIST_LENGTH)
            raise ValueError(f"color is {brief(name)}, must be one of {known}")
        values = dict(zip((*LOW, *HIGH), (*self.ranges[name].low, *self.ranges[name].high)))
        changed = {key: config[key] for key, old in self._values.items() if config[key] != old}
        values.update(changed)
        chosen = filled(HsvRange(), values)
        validate(chosen)
        self.ranges[name] = chosen
        config.update(values, color=name)
        self._shown, self._values = name, values


def _default() -> Dict[str, Any]:
    """Returns ~colors where it is not set: one colour with the limits in h_low .. v_high."""
    (name, limits), *_ = DEFAULT.items()
    low = [read_param(key, value) for key, value in zip(LOW, limits["low"])]
    high = [read_param(key, value) for key, value in zip(HIGH, limits["high"])]
    return {name: {"low": low, "high": high}}


def _range(name: str, entry: Any) -> HsvRange:
    if isinstance(entry, dict) and entry.keys() >= {*LOW, *HIGH}:  # from a file in config/colors
        entry = {"low": [entry[key] for key in LOW], "high": [entry[key] for key in HIGH]}
    where = f"colors/{printable(name)}"
    try:
        found = HsvRange(low=tuple(entry["low"]), high=tuple(entry["high"]))
    except (KeyError, TypeError):
        raise ValueError(
            f"{where} is {brief(entry)}, must be {{low: [h, s, v], high: [h, s, v]}}"
        ) from None
    with about(where):
        validate(found)
    return found
