"""The names of a network's classes: of the model itself, of a file, or of a known data set.

A file has one name in each line, as darknet's .names files; or it is YAML with a list or a map
`names`, as Ultralytics' data files and the parameter files of darknet_ros have it.
"""

import os
from typing import Any, List, Mapping, Sequence

from ..common.errors import about
from ..common.files import MAX_TEXT, read_file
from ..common.plain_text import printable
from ..common.yaml_text import load_yaml
from .head import Head
from .known_names import KNOWN_NAMES
from .metadata import MAX_CLASSES, class_names, names_of

YAML_SUFFIXES = (".yaml", ".yml")
MAX_LENGTH = 100  # letters of a name


def names_for(
    metadata: Mapping[str, str], head: Head, given: Sequence[List[str]], source: str = ""
) -> List[str]:
    """Returns a name for each class.

    Args:
        metadata: The model's.
        head: How the outputs of the network are read.
        given: What given_names() returned: the list of the right length counts. None: the names of
            the model, or else class 0, class 1, ...
        source: Where those are from.

    Raises:
        ValueError: There are not as many names as the network has classes.
    """
    whose = source if given else "the model's metadata"
    choices = given or [class_names(metadata)]
    names = next((one for one in choices if len(one) == head.classes), choices[0])
    if not names:
        return [f"class {number}" for number in range(head.classes)]
    if len(names) != head.classes:
        raise ValueError(
            f"{whose} has {_counted(len(names), 'name')}, but the network has "
            f"{_counted(head.classes, 'class')}"
        )
    return [printable(name, MAX_LENGTH) for name in names]


def given_names(source: str) -> List[List[str]]:
    """Returns the lists of names that the user's parameter may stand for, the usual one first.

    Args:
        source: A file, coco, voc, or nothing.

    Raises:
        OSError: The file cannot be read.
        ValueError: It has no names.
    """
    if not source:
        return []
    return KNOWN_NAMES.get(source) or [read_names(source)]


def read_names(path: str) -> List[str]:
    """Returns the names in a file.

    Raises:
        OSError: The file cannot be read.
        ValueError: It has no names.
    """
    content = read_file(path, MAX_TEXT)
    with about(path):
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise ValueError("it is no text in UTF-8") from None
        if os.path.splitext(path)[1].lower() in YAML_SUFFIXES:
            names = names_of(_find(load_yaml(text)))
        else:
            lines = (line.strip() for line in text.splitlines())
            names = [line for line in lines if line and not line.startswith("#")]
        if not 0 < len(names) <= MAX_CLASSES:
            raise ValueError(
                f"it has {len(names)} names of classes, must have 1 to {MAX_CLASSES}: one in each "
                "line, or in YAML a list or map `names`"
            )
    return names


def _find(values: Any) -> Any:
    """Returns what `names` is in a map, or in a map inside of it, the first that is found."""
    if not isinstance(values, dict):
        return values
    if "names" in values:
        return values["names"]
    inner = (_find(value) for value in values.values() if isinstance(value, dict))
    return next((found for found in inner if found is not None), None)


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}{'es' if what[-1] == 's' else 's'}"
