"""The .ork files of object_recognition_core: YAML of cells, sources, pipelines and sinks."""

import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping

from ..common.errors import about
from ..common.files import MAX_TEXT, read_file
from ..common.package_path import package_path
from ..common.plain_text import brief, printable
from ..common.yaml_text import load_yaml

# What a cell has besides its parameters; older files have other names for it.
KEYS = ("type", "module", "subtype", "inputs", "outputs", "parameters")
OLD_KEYS = ("method", "submethod", "package", "sources", "sinks", "voters")
KINDS = ("source", "pipeline", "sink", "voter")
KINDS_BY_TYPE = {"detector": "pipeline", "trainer": "pipeline", "publisher": "sink"}


@dataclass
class Cell:
    """A part of a pipeline.

    Attributes:
        name: As the file has it, as pipeline1.
        type: What it does, as LinemodDetector.
        parameters: Its parameters, which may stand beside the type, too.
    """

    name: str
    type: str
    parameters: Dict[str, Any]


@dataclass
class OrkFile:
    """The cells of a file by their kinds, and what there is to be warned of."""

    path: str
    sources: List[Cell] = field(default_factory=list)
    pipelines: List[Cell] = field(default_factory=list)
    sinks: List[Cell] = field(default_factory=list)
    warnings: List[str] = field(default_factory=list)


def read_ork(path: str) -> OrkFile:
    """Reads an .ork file.

    A name without a folder may be that of a file in config of this package.

    Raises:
        OSError: The file cannot be read.
        ValueError: It is not of this form.
    """
    path = _found(path)
    data = read_file(path, MAX_TEXT)
    with about(path):
        values = load_yaml(data.decode())
        if not isinstance(values, dict) or not values:
            raise ValueError(f"it is {brief(values)}, must be cells by name, as pipeline1: ...")
        made = OrkFile(path)
        for name, value in values.items():
            _add(made, printable(str(name)), value)
    return made


def _found(path: str) -> str:
    if os.path.dirname(path) or os.path.lexists(path):
        return path
    ours = package_path("config", path)
    return ours if os.path.exists(ours) else path


def _add(made: OrkFile, name: str, value: Any) -> None:
    if not isinstance(value, dict):
        raise ValueError(f"{name} is {brief(value)}, must be a cell: a map with type, parameters")
    kind = _kind(name, value)
    cells = {"source": made.sources, "pipeline": made.pipelines, "sink": made.sinks}.get(kind)
    if cells is None:
        text = "cells that vote are not needed" if kind == "voter" else "what it is cannot be told"
        made.warnings.append(f"{name} is not used: {text}")
        return
    cells.append(Cell(name, _type(name, value), _parameters(name, value)))


def _kind(name: str, value: Mapping[Any, Any]) -> str:
    by_name = [kind for kind in KINDS if name.lower().startswith(kind)]
    if by_name:
        return by_name[0]
    kind = str(value.get("type", "")).lower()
    return next((known for word, known in KINDS_BY_TYPE.items() if kind.endswith(word)), "")


def _type(name: str, value: Mapping[Any, Any]) -> str:
    kind = value.get("type", value.get("method", ""))
    if not isinstance(kind, str) or not kind:
        raise ValueError(f"{name}: type is {brief(kind)}, must be a name, as LinemodDetector")
    return kind


def _parameters(name: str, value: Mapping[Any, Any]) -> Dict[str, Any]:
    parameters = value.get("parameters") or {}
    if not isinstance(parameters, dict):
        raise ValueError(f"{name}: parameters is {brief(parameters)}, must be a map")
    beside = {key: one for key, one in value.items() if key not in KEYS + OLD_KEYS}
    return {printable(str(key)): one for key, one in {**beside, **parameters}.items()}
