"""The entries of ~colors and ~more_colors: ranges of colours in YAML."""

import re
from typing import Any, Tuple

from .. import ColorRange, color_channels, validate
from ..common.errors import about
from ..common.plain_text import brief, printable
from .colors import limit_names


def range_of(parameter: str, name: str, entry: Any) -> ColorRange:
    """Returns the range of an entry of ~colors or ~more_colors.

    Args:
        parameter: Which of them, for errors.
        name: The name of the colour, likewise.
        entry: {low: [h, s, v], high: [h, s, v]}, {space: ...} with it, or with named limits.

    Raises:
        ValueError: It has another form, or a value is out of range.
    """
    where = f"{parameter}/{printable(name)}"
    space = entry.get("space", "hsv") if isinstance(entry, dict) else "hsv"
    if not isinstance(space, str):
        raise ValueError(f"{where}: space is {brief(space)}, must be a string")
    with about(where):
        names = limit_names(space)
        entry = _in_lists(entry, names)
    try:
        found = ColorRange(space, tuple(entry["low"]), tuple(entry["high"]))
    except (KeyError, TypeError):
        letters = ", ".join(channel for channel, _, _ in color_channels(space))
        named = "" if space == "hsv" else f"space: {space}, "
        raise ValueError(
            f"{where} is {brief(entry)}, must be {{{named}low: [{letters}], high: [{letters}]}}"
        ) from None
    with about(where):
        validate(found)
    return found


def _in_lists(entry: Any, names: Tuple[Tuple[str, ...], Tuple[str, ...]]) -> Any:
    """Returns an entry whose limits are named, as in config/colors, with lists of them.

    Raises:
        ValueError: There are limits of another space, or limits in lists, too.
    """
    if not isinstance(entry, dict):
        return entry
    limits = {key for key in map(str, entry) if re.search("(^|_)(low|high)$", key)}
    if limits <= {"low", "high"}:
        return entry
    low, high = names
    expected = (*low, *high)
    for key in sorted(limits ^ {*expected}):
        state = "is there" if key in limits else "is missing"
        raise ValueError(f"{printable(key)} {state}, must be {', '.join(expected)}")
    return {"low": [entry[key] for key in low], "high": [entry[key] for key in high]}
