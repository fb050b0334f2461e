"""The objects that a node is to recognize, loaded from the database."""

import dataclasses
import itertools
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .. import Mesh, ObjectShape
from ..meshes import mesh_extent
from .database import Database, Object
from .database.meshes import MeshEntry, to_json
from .database.models import ModelEntry
from .found import KnownObject
from .mesh_data import unpack_mesh
from .methods import method_of
from .texture_method import box_around
from .training_run import task_of


class Loaded(NamedTuple):
    """What was loaded.

    Attributes:
        objects: Those with a model.
        lacks: What there is to warn of, in lines.
        problem: The reason why there is no object, or "".
    """

    objects: List[KnownObject]
    lacks: List[str]
    problem: str


@dataclasses.dataclass
class _Part:
    """What was loaded of an object: itself if it has a model, and what there is to warn of."""

    known: Optional[KnownObject] = None
    can_be_learned: bool = False  # by one of the methods, as it has a mesh or observations
    lacks: List[str] = dataclasses.field(default_factory=list)  # not learned, or changed since
    failures: List[str] = dataclasses.field(default_factory=list)  # what of it cannot be used


def load_objects(
    path: str,
    chosen: Sequence[str],
    methods: Sequence[str],
    before: Sequence[KnownObject] = (),
) -> Loaded:
    """Loads objects, and what was learned of them.

    Args:
        path: The database.
        chosen: Ids and names; none: all objects.
        methods: The names of the methods; none: only tables are looked for, and nothing is loaded.
        before: What was loaded before, of which those are taken that have not changed.
    """
    if not methods:
        return Loaded([], [], "")
    try:
        with Database(path) as database:
            there, failures = _choose(database, chosen)
            known = {one.id: one for one in before}
            parts = [_load(database, one, methods, known.get(one.id)) for one in there]
    except (OSError, ValueError) as error:
        return Loaded([], [], str(error))
    objects = [part.known for part in parts if part.known is not None]
    failures += [line for part in parts for line in part.failures]
    lacks = failures + [line for part in parts for line in part.lacks]
    problem = ""
    if not there and failures:
        problem = failures[0]
    elif not there:
        problem = f"no objects in {path}: object_add.py adds them"
    elif not objects and failures:
        problem = f"no object in {path} can be used: {failures[0]}"
    elif not objects and not any(part.can_be_learned for part in parts):
        problem = f"no object in {path} has a mesh to learn it by: mesh_add.py adds them"
    elif not objects:
        problem = f"no object in {path} was learned by {' or '.join(methods)}: training does it"
    return Loaded(objects, [] if problem else lacks, problem)


def _choose(database: Database, chosen: Sequence[str]) -> Tuple[List[Object], List[str]]:
    """Returns the objects with these ids and names, each once, and why some are not there."""
    if not chosen:
        return database.objects.all(), []
    there: Dict[str, Object] = {}
    failures = []
    for text in chosen:
        try:
            one = database.objects.find(text)
        except ValueError as error:
            failures.append(str(error))
        else:
            there[one.id] = one
    return list(there.values()), failures


def _load(
    database: Database, one: Object, methods: Sequence[str], before: Optional[KnownObject]
) -> _Part:
    """Returns an object with those of its models that can be used, which may come from others."""
    part = _Part()
    entries = _entries(database, one, methods, part)
    try:
        mesh = database.meshes.entry(one.id)
        made_of = _made_of(one, mesh, entries)
        if before is not None and before.made_of == made_of:
            part.known = before
            return part
        models = _models(database, one, entries, part)
        if models:
            made_of = made_of if len(models) == len(entries) else ()
            part.known = _known(database, one, mesh, models, made_of)
    except ValueError as error:
        part.failures.append(f"'{one.name}' is not recognized: {error}")
    return part


def _entries(
    database: Database, one: Object, methods: Sequence[str], part: _Part
) -> List[ModelEntry]:
    """Returns what methods have learned of an object, and adds what there is to tell of it.

    What was learned by a mesh that is no more is left out.
    """
    entries = []
    for name in methods:
        try:
            entry = database.models.entry(one.id, name)
            task = task_of(database, one, method_of(name), entry.parameters if entry else {})
        except ValueError as error:
            part.failures.append(_unusable(one, name, error))
            continue
        if task is None:
            continue
        part.can_be_learned = True
        if entry is None:
            part.lacks.append(f"'{one.name}' was not learned by {name}: training does it")
            continue
        if task.key != entry.key:
            changed = f"'{one.name}' has changed since {name} has learned it: training does it"
            part.lacks.append(changed)
        entries.append(entry)
    if not part.can_be_learned and not part.failures:
        part.lacks.append(
            f"'{one.name}' has no mesh to learn it by: mesh_add.py {one.id[:8]} FILE adds it"
        )
    return entries


def _models(
    database: Database, one: Object, entries: Sequence[ModelEntry], part: _Part
) -> Dict[str, bytes]:
    """Returns those of an object's models that can be used, and adds why others cannot."""
    models: Dict[str, bytes] = {}
    for entry in entries:
        try:
            model = database.models.of(one.id, entry.method)
            if model is not None:
                method_of(entry.method).check_model(model.data)
                models[entry.method] = model.data
        except ValueError as error:
            part.failures.append(_unusable(one, entry.method, error))
    return models


def _unusable(one: Object, method: str, error: ValueError) -> str:
    return f"'{one.name}' is not recognized by {method}: {error}"


def _made_of(
    one: Object, mesh: Optional[MeshEntry], entries: Sequence[ModelEntry]
) -> Tuple[Any, ...]:
    """Returns the names and hashes of all that a KnownObject is made of."""
    models = tuple((entry.method, entry.key) for entry in entries)
    shape = None if mesh is None else (mesh.converted, str(to_json(mesh.symmetries)))
    return one.name, models, shape


def _known(
    database: Database,
    one: Object,
    entry: Optional[MeshEntry],
    models: Dict[str, bytes],
    made_of: Tuple[Any, ...],
) -> KnownObject:
    if entry is None:
        mesh, symmetries = box_around(models), []
    else:
        mesh = unpack_mesh(database.meshes.converted(one.id))
        symmetries = [(tuple(known.axis), known.fold) for known in entry.symmetries]
    shape = ObjectShape(mesh, symmetries)
    corners = corners_of(mesh)
    return KnownObject(one.id, one.name, mesh, shape, corners, models, entry is None, made_of)


def corners_of(mesh: Mesh) -> np.ndarray:
    """Returns the corners, (8, 3), m, of the box around a mesh."""
    extent = mesh_extent(mesh)
    signs = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
    return np.asarray(extent.center) + signs * np.asarray(extent.size)
