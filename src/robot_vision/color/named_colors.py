"""The named colours of a node: the parameter ~colors, and the one that live parameters show."""

from typing import Any, Dict, Tuple

import rospy

from .. import ColorRange, HsvRange, color_channels, convert_range, validate
from ..common.plain_text import brief, printable
from ..ros.configs import HsvTrackerConfig
from ..ros.context import current
from ..ros.params import present_params, read_any, read_param
from .color_entries import range_of
from .color_file import is_color_name

# The live limits in HSV have names of their own, and those in all other spaces are numbered.
LOW = ("h_low", "s_low", "v_low")
HIGH = ("h_high", "s_high", "v_high")
NUMBERED_LOW = ("low_1", "low_2", "low_3")
NUMBERED_HIGH = ("high_1", "high_2", "high_3")
SPACE = "space"
ADD = "+"  # before the name of a colour that is to have the limits given with it
NEW_NAME = "letters, digits and _, a letter first, that YAML reads as a text"
# What live parameters show of one colour; ~colors has that of all.
SHOWN = ("color", SPACE, *LOW, *HIGH, *NUMBERED_LOW, *NUMBERED_HIGH)
MAX_LIST_LENGTH = 200  # characters of the names in an error
DEFAULT = {"blue": {"low": list(HsvRange().low), "high": list(HsvRange().high)}}


class NamedColors:
    """The ranges in ~colors by name. The live parameter `color` names the one that is shown.

    ~more_colors has further ones of the same form, which replace those of the same names.

    `space` is that of the range, whose limits are h_low .. v_high in HSV, and low_1 .. high_3 in
    the other spaces. In a new space the limits begin with those that hold all colours of the old
    ones. A colour keeps its limits in each space, for when it comes back to it.

    Raises:
        ValueError: One of them does not have the form {name: {low: [h, s, v], high: [h, s, v]}},
            or a value is out of range.
    """

    def __init__(self) -> None:
        named, more = read_any("colors", None), read_any("more_colors", {})
        given = _default() if named is None else named
        if not isinstance(given, dict) or not given:
            raise ValueError(
                f"colors is {brief(given)}, must be a map of at least one name to a range"
            )
        if not isinstance(more, dict):
            raise ValueError(f"more_colors is {brief(more)}, must be a map of names to ranges")
        self._named: Dict[str, Any] = {}  # as ~colors has them
        self.ranges: Dict[str, ColorRange] = {}
        # Entries are replaced as a whole: one may have limits in lists, and the other named ones.
        for parameter, entries in (("colors", given), ("more_colors", more)):
            for name, entry in entries.items():
                self._named[str(name)] = entry
                self.ranges[str(name)] = range_of(parameter, str(name), entry)
        self._shown = ""
        self._values: Dict[str, Any] = {}  # of SHOWN but the colour, as they were shown last
        self._left: Dict[Tuple[str, str], ColorRange] = {}  # by the name and the space
        self._drop_live("~colors has all limits" if named is not None else "")
        if more:
            self._tell_names()

    def update(self, config: Dict[str, Any]) -> None:
        """Takes over the limits that have changed in `config`, and updates the rest of it.

        A `color` that begins with ADD is that of the name behind it: it gets all limits in
        `config`, and is added if there is none of this name.
        """
        name = config["color"] or self._shown or next(iter(self.ranges))
        is_given = name.startswith(ADD) and name not in self.ranges
        name = name[len(ADD) :] if is_given else name
        old = self.ranges.get(name)
        self._require_name(name, is_given)
        chosen = _range_in(config) if is_given else self._changed_range(name, config)
        validate(chosen)
        if old is None:
            self._announce(name, chosen)
        elif chosen.space != old.space:
            self._left[name, old.space] = old
        self.ranges[name] = chosen
        low, high = _live_names(chosen.space)
        limits = zip((*low, *high), (*chosen.low, *chosen.high))
        config.update(limits, color=name, space=chosen.space)
        self._shown, self._values = name, {key: config[key] for key in SHOWN[1:]}

    def _require_name(self, name: str, is_given: bool) -> None:
        """Raises ValueError for the name of a colour that is not there, and cannot be added."""
        if name in self.ranges or (is_given and is_color_name(name)):
            return
        if is_given:
            raise ValueError(f"color is {brief(ADD + name)}, must be {ADD} and {NEW_NAME}")
        known = printable(", ".join(self.ranges), MAX_LIST_LENGTH)
        raise ValueError(f"color is {brief(name)}, must be one of {known}; {ADD}name adds one")

    def _changed_range(self, name: str, config: Dict[str, Any]) -> ColorRange:
        """Returns the range of a colour with the limits that differ from those shown last."""
        changed = {key: config[key] for key, old in self._values.items() if config[key] != old}
        old = self.ranges[name]
        space = changed.pop(SPACE, old.space)
        _require_own(space, changed)
        chosen = old if space == old.space else self._in_space(name, space)
        low, high = _live_names(space)
        return ColorRange(
            space,
            tuple(changed.get(key, value) for key, value in zip(low, chosen.low)),
            tuple(changed.get(key, value) for key, value in zip(high, chosen.high)),
        )

    def _announce(self, name: str, chosen: ColorRange) -> None:
        """Adds a colour to ~colors."""
        entry = {"low": list(chosen.low), "high": list(chosen.high), SPACE: chosen.space}
        self._named[name] = entry
        self._tell_names()

    def _tell_names(self) -> None:
        """Sets ~colors to all colours, because others look there for the names."""
        current().set_param("~colors", self._named)

    def _drop_live(self, reason: str) -> None:
        """Takes live parameters from the server at start, and tells which have had no effect.

        Args:
            reason: Why they have none; "" if the limits of the space have one.
        """
        there = present_params(SHOWN)
        first = next(iter(self.ranges.values()))
        shown = self.ranges.get(str(there.pop("color", "")), first)
        low, high = _live_names(shown.space)
        used = {
            **HsvTrackerConfig.defaults,
            **dict(zip((*low, *high), (*shown.low, *shown.high))),
            SPACE: shown.space,
        }
        ignored = [f"{name} {brief(there[name])}" for name in there if there[name] != used[name]]
        if ignored:
            reason = reason or _limits_of(shown.space)
            rospy.logwarn("without effect: %s, because %s", ", ".join(ignored), reason)
        for name in there:
            current().delete_param("~" + name)

    def _in_space(self, name: str, space: str) -> ColorRange:
        """Returns the limits that a colour had in a space; else those that hold all of it."""
        left = self._left.get((name, space))
        return left or convert_range(self.ranges[name], space)


def _live_names(space: str) -> Tuple[Tuple[str, ...], Tuple[str, ...]]:
    """Returns the names of the live parameters that are the low and the high limits in a space."""
    return (LOW, HIGH) if space == "hsv" else (NUMBERED_LOW, NUMBERED_HIGH)


def _range_in(config: Dict[str, Any]) -> ColorRange:
    """Returns the range that live parameters have."""
    low, high = _live_names(config[SPACE])
    limits = (tuple(config[key] for key in names) for names in (low, high))
    return ColorRange(config[SPACE], *limits)


def _require_own(space: str, changed: Dict[str, Any]) -> None:
    """Raises ValueError for a limit that is none in this space, and for a space that is none."""
    limits = _limits_of(space)
    low, high = _live_names(space)
    for name, value in changed.items():
        if name not in (*low, *high):
            raise ValueError(f"{name} is {value}, must not be set while {limits}")


def _limits_of(space: str) -> str:
    """Returns which live parameters are the limits in a space, in words.

    Raises:
        ValueError: There is no such space.
    """
    channels = ", ".join(meaning for _, meaning, _ in color_channels(space))
    low, high = _live_names(space)
    return f"space is {space}, whose limits are {low[0]} to {high[-1]} ({channels})"


def _default() -> Dict[str, Any]:
    """Returns ~colors where it is not set: one colour with the limits of the live parameters."""
    (name, limits), *_ = DEFAULT.items()
    space = read_param(SPACE, "hsv")
    low, high = limits["low"], limits["high"]
    if space != "hsv":
        low, high = [0, 0, 0], [largest for _, _, largest in color_channels(space)]
    names = _live_names(space)
    low = [read_param(key, value) for key, value in zip(names[0], low)]
    high = [read_param(key, value) for key, value in zip(names[1], high)]
    return {name: {"space": space, "low": low, "high": high}}
