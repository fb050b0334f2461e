"""The colours in hsv_tracker's parameter file, below the top-level key `colors`.

    colors:
      blue: {low: [90, 50, 50], high: [120, 255, 255]}   # a comment
      skin: {space: ycrcb, low: [0, 133, 77], high: [255, 173, 127]}

PyYAML can read such a file, but loses comments and layout when it writes. Therefore it is only
used to find positions in the text. The text is edited there, and the result is read again before
it replaces the file.
"""

import re
from typing import Any, Dict, List, Mapping, Optional, Tuple

import yaml

from ..common.errors import about
from ..common.files import read_text, replace_file
from ..common.yaml_text import compose_yaml, load_yaml
from .colors import AnyRange, as_yaml, limit_names, space_of

NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")


def is_color_name(name: str) -> bool:
    """Returns whether a file can get a new colour of this name: see edit_colors()."""
    return bool(NAME.fullmatch(name)) and load_yaml(name) == name


def save_colors(path: str, colors: Mapping[str, AnyRange]) -> None:
    """Puts colours into a YAML file like edit_colors(), and makes the file if there is none.

    The file is replaced in one step or not at all.

    Raises:
        ValueError: A name cannot be used, or the text of the file cannot be edited.
        OSError: The file cannot be read or written.
    """
    replace_file(path, edit_colors(path, read_text(path), colors).encode())


def edit_colors(path: str, text: str, colors: Mapping[str, AnyRange]) -> str:
    """Returns the text of a file with colours put into it, and everything else unchanged.

    Args:
        path: The path of the file, for error messages.
        text: The YAML text.
        colors: The colours by name. They replace those of the same names. A new name consists of
            letters, digits and _, starts with a letter, and is no word that YAML reads as another
            type, such as yes.

    Raises:
        ValueError: A name cannot be used, or the layout of the text does not allow the edit.
    """
    expected = _parse(path, text)
    old = expected.get("colors") or {}
    if not isinstance(old, dict):
        raise ValueError(f"{path}: not overwritten, for its colors are no map")
    for name in colors:
        if name not in old and not is_color_name(name):
            raise ValueError(f"{path}: not overwritten, for '{name}' is no name for a colour")
    expected["colors"] = {**old, **{name: _entry(old.get(name), colors[name]) for name in colors}}
    for name, color in colors.items():
        text = _edit(text, name, color)
    if not _reads_as(text, expected):
        raise ValueError(
            f"{path}: not overwritten, for it is not laid out like 'colors:', and below it "
            "'name: {low: [h, s, v], high: [h, s, v]}' in each line"
        )
    return text


def _entry(old: Any, color: AnyRange) -> Dict[str, Any]:
    """Returns what must be read for a colour: the new limits, and what else its entry has."""
    others = old if isinstance(old, dict) else {}
    space = space_of(color)
    named = {"space": space} if "space" in others or space != "hsv" else {}
    limits = _named_limits(color)
    if not limits.keys() <= others.keys():
        limits = {"low": list(color.low), "high": list(color.high)}
    return {**others, **named, **limits}


def _named_limits(color: AnyRange) -> Dict[str, int]:
    """Returns the limits by their names in the colour's space, as in config/colors."""
    low, high = limit_names(space_of(color))
    return dict(zip((*low, *high), (*color.low, *color.high)))


def _parse(path: str, text: str) -> Dict[str, Any]:
    with about(f"{path}: not overwritten, for it is no valid YAML"):
        values = load_yaml(text)
    if not isinstance(values, (dict, type(None))):
        raise ValueError(f"{path}: not overwritten, for it is no map of parameters")
    return values or {}


def _reads_as(text: str, expected: Dict[str, Any]) -> bool:
    try:
        return bool(load_yaml(text) == expected)
    except ValueError:
        return False


def _edit(text: str, name: str, color: AnyRange) -> str:
    """Returns the text with the colour replaced or added, or unchanged if there is no place."""
    colors = _value(compose_yaml(text), "colors")
    if colors is None:
        end = _line_end(text)
        start = text if text.endswith("\n") or not text else text + end
        return f"{start}colors:{end}  {name}: {as_yaml(color)}{end}"
    old = _value(colors, name)
    if old is None:
        return _add(text, colors, f"{name}: {as_yaml(color)}")
    values: List[Tuple[yaml.Node, Any]] = [
        (_value(old, name), limit) for name, limit in _named_limits(color).items()
    ]
    if not all(isinstance(node, yaml.ScalarNode) for node, _ in values):
        values = [(_value(old, "low"), list(color.low)), (_value(old, "high"), list(color.high))]
        if not all(isinstance(node, yaml.SequenceNode) and node.flow_style for node, _ in values):
            return text
    space = _value(old, "space")
    if isinstance(space, yaml.ScalarNode):
        values.append((space, space_of(color)))
    # The later one first, so that the positions of the others stay valid.
    for node, value in sorted(values, key=lambda value: -value[0].start_mark.index):
        text = _replace(text, node, str(value))
    if space is None and space_of(color) != "hsv":
        text = _begin(text, old, f"space: {space_of(color)}")
    return text


def _value(node: Optional[yaml.Node], key: str) -> Optional[yaml.Node]:
    """Returns the value of `key`, or None if the node is no map or has no such key."""
    if isinstance(node, yaml.MappingNode):
        for key_node, value in node.value:
            if key_node.value == key:
                return value
    return None


def _add(text: str, colors: yaml.Node, entry: str) -> str:
    """Returns the text with one more entry in a map, or below a key without a value."""
    if isinstance(colors, yaml.MappingNode) and colors.flow_style:
        end = colors.end_mark.index - 1
        return text[:end] + (", " if colors.value else "") + entry + text[end:]
    column, last = 2, colors
    if isinstance(colors, yaml.MappingNode):
        column = colors.value[-1][0].start_mark.column
    # The end mark of a block is where the next one begins; only that of a scalar is its own end.
    while isinstance(last, yaml.CollectionNode) and not last.flow_style:
        last = last.value[-1][1] if isinstance(last, yaml.MappingNode) else last.value[-1]
    end = _line_end(text)
    below = text.find("\n", last.end_mark.index) + 1
    if not below:
        return f"{text}{end}{' ' * column}{entry}{end}"
    return f"{text[:below]}{' ' * column}{entry}{end}{text[below:]}"


def _begin(text: str, entry: yaml.Node, first: str) -> str:
    """Returns the text with one more key before the others of a colour."""
    start = entry.value[0][0].start_mark
    between = ", " if entry.flow_style else _line_end(text) + " " * start.column
    return text[: start.index] + first + between + text[start.index :]


def _line_end(text: str) -> str:
    """Returns the line end that the first line of the text has."""
    return "\r\n" if text.partition("\n")[0].endswith("\r") else "\n"


def _replace(text: str, node: yaml.Node, value: str) -> str:
    """Returns the text with one value replaced; a comment keeps its column if there is room."""
    start, end = node.start_mark.index, node.end_mark.index
    longer = len(value) - (end - start)
    line, newline, below = text[end:].partition("\n")
    line = re.sub(" +(?=#)", lambda gap: " " * max(1, len(gap[0]) - longer), line, count=1)
    return text[:start] + value + line + newline + below
