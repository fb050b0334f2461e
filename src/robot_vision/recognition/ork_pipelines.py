"""What the pipelines of an .ork file ask for: a method, objects, a database and parameters."""

from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence

import yaml

from ..common.errors import about
from ..common.plain_text import brief, printable
from ..common.yaml_text import compose_yaml, load_yaml
from .database import Database, Object
from .ork_file import Cell, OrkFile

ALL, MISSING = "all", "missing"
TABLES = "TABLES"  # a pipeline that finds tables, and learns nothing
METHODS = {  # by what is left of a type without Detector or Trainer
    "linemod": "LINEMOD",
    "ppf": "PPF",
    "tod": "TOD",
    "tabletoptable": TABLES,
    "tabletopobject": "LINEMOD",
}
ON_TABLES = "tabletopobject"  # what it recognizes stands on tables
# Parameters of object_recognition_core's pipelines that have no meaning here.
THEIRS = {
    "visualize": "what is found is drawn on ~processed_image",
    "threshold": "the threshold of the live parameters is a probability",
    "use_rgb": "images and depths are used as they come",
    "use_depth": "images and depths are used as they come",
    "th_obj_dist": "objects that claim the same pixels exclude each other",
    "icp_dist_min": "the noise of the depths says what fits",
    "px_match_min": "the threshold of the live parameters decides, a probability",
    "depth_frame_id": "it is that of the images",
    "verbose": "/diagnostics tells what is not found, and the reason",
    "tabletop_object_ids": "object_ids says which objects",
}
THEIR_RENDERER = "renderer_"  # what theirs begin with: ours needs none of them


@dataclass
class Pipeline:
    """A method, and what it is to work on.

    Attributes:
        name: That of the cell.
        method: LINEMOD, PPF, TOD or TABLES.
        objects: Ids, digits that ids begin with, and names; or ALL, or MISSING: those without a
            model.
        db: Which database, as the file says.
        parameters: Those of the method, as the file has them.
        on_tables: Whether the objects are looked for on tables alone.
    """

    name: str
    method: str
    objects: Any
    db: Dict[str, Any]
    parameters: Dict[str, Any]
    on_tables: bool = False


def pipelines_of(file: OrkFile) -> List[Pipeline]:
    """Returns the pipelines of a file, and adds to its warnings what is not used of them.

    Raises:
        ValueError: There is none, or one of them is not what it must be.
    """
    with about(file.path):
        if not file.pipelines:
            raise ValueError("there is no pipeline in it, must be one at least, as pipeline1: ...")
        return [_pipeline(cell, file.warnings) for cell in file.pipelines]


def chosen_objects(database: Database, pipeline: Pipeline) -> List[Object]:
    """Returns the objects that a pipeline is to work on, sorted by name.

    Raises:
        ValueError: One of them is not there.
    """
    if pipeline.objects in (ALL, MISSING):
        there = database.objects.all()
        if pipeline.objects == MISSING:
            known = {entry.object_id for entry in database.models.entries(pipeline.method)}
            there = [one for one in there if one.id not in known]
        return there
    found = {one.id: one for one in map(database.objects.find, pipeline.objects)}
    return sorted(found.values(), key=lambda one: (one.name, one.id))


def object_choice(value: Any, where: str) -> Any:
    """Returns ALL, MISSING, or a list of ids and names, as a file or a command line has them.

    Raises:
        ValueError: It is nothing of this kind.
    """
    if isinstance(value, str) and value not in (ALL, MISSING):
        with about(where):
            value = _texts(compose_yaml(value))
    if isinstance(value, str) and value not in (ALL, MISSING):
        value = [value]
    is_list = isinstance(value, list) and all(isinstance(one, str) for one in value)
    if value not in (ALL, MISSING) and not is_list:
        what = "'all', 'missing' or a list of texts, with what has digits alone in quotes"
        raise ValueError(f"{where} is {brief(value)}, must be {what}")
    return value


def _texts(node: Optional[yaml.Node]) -> Any:
    """Returns the text of a scalar, which may be of digits alone, or a list of those of a list."""
    if isinstance(node, yaml.SequenceNode):
        return [one.value for one in node.value]
    return None if node is None else node.value


def _pipeline(cell: Cell, warnings: List[str]) -> Pipeline:
    parameters = dict(cell.parameters)
    submethod = parameters.pop("json_submethod", {})
    with about(cell.name):
        word = _word(cell.type)
        db = _map(parameters.pop("db", None) or parameters.pop("json_db", None) or {}, "db")
        objects = _objects(parameters)
        if isinstance(submethod, str) and submethod:
            submethod = load_yaml(submethod)
        if isinstance(submethod, dict):
            parameters = {**submethod, **parameters}
    for name in sorted(parameters):
        reason = THEIRS.get(name, "this renderer needs none of them" * _is_renderers(name))
        if reason:
            del parameters[name]
            warnings.append(f"{cell.name}: {name} is not used: {reason}")
    return Pipeline(cell.name, METHODS[word], objects, db, parameters, word == ON_TABLES)


def _word(kind: str) -> str:
    """Returns what is left of a type, by which METHODS has it."""
    word = kind.lower()
    for ending in ("detector", "trainer"):
        word = word[: -len(ending)] if word.endswith(ending) else word
    if word not in METHODS:
        raise ValueError(f"type is '{printable(kind)}', must be one of {known_types()}")
    return word


def known_types() -> str:
    """Returns the types of pipelines that there are, for an error."""
    names: Sequence[str] = ("Linemod", "Ppf", "Tod", "TabletopTable", "TabletopObject")
    return ", ".join(f"{name}Detector" for name in names) + ", or ...Trainer"


def _objects(parameters: Dict[str, Any]) -> Any:
    found = []
    for name in ("object_ids", "json_object_ids", "object_names"):
        value = parameters.pop(name, None)
        if value not in (None, "", []):
            found.append(object_choice(value, name))
    for special in (ALL, MISSING):
        if special in found or not found:
            return special
    return [one for choice in found for one in choice]


def _map(value: Any, what: str) -> Dict[str, Any]:
    if isinstance(value, str):
        with about(what):
            value = load_yaml(value)
    if not isinstance(value, dict):
        raise ValueError(f"{what} is {brief(value)}, must be a map with type, root, collection")
    return {printable(str(key)): one for key, one in value.items()}


def _is_renderers(name: str) -> bool:
    return name.startswith(THEIR_RENDERER)


def unknown_warnings(name: str, parameters: Mapping[str, Any], known: Sequence[str]) -> List[str]:
    """Returns a line for each parameter of a cell that is not known."""
    return [f"{name}: {one} is not known, and not used" for one in parameters if one not in known]
