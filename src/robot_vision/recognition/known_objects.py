"""The objects that a node is to recognize, loaded from the database."""

import itertools
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .. import Mesh, MeshRenderer, ObjectShape
from ..meshes import mesh_extent
from .database import Database, Object
from .found import KnownObject
from .mesh_data import unpack_mesh
from .methods import Method, method_of
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


class _Part(NamedTuple):
    """What was loaded of an object: itself if it has a model, and what there is to warn of."""

    known: Optional[KnownObject]
    lacks: List[str]  # what it was not learned by, or has changed since
    failures: List[str]  # what of it cannot be used


def load_objects(path: str, chosen: Sequence[str], methods: Sequence[str]) -> Loaded:
    """Loads objects, and what was learned of them.

    Args:
        path: The database.
        chosen: Ids and names; none: all objects.
        methods: The names of the methods; none: only tables are looked for, and nothing is loaded.
    """
    if not methods:
        return Loaded([], [], "")
    try:
        with Database(path) as database:
            there, failures = _choose(database, chosen)
            parts = [_load(database, one, methods) for one in there]
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


def _load(database: Database, one: Object, methods: Sequence[str]) -> _Part:
    """Returns an object with those of its models that can be used, which may come from others."""
    models: Dict[str, bytes] = {}
    part = _Part(None, [], [])
    for name in methods:
        try:
            lack = _load_model(database, one, method_of(name), models)
            part.lacks.extend([lack] if lack else [])
        except ValueError as error:
            part.failures.append(f"'{one.name}' is not recognized by {name}: {error}")
    if not models:
        return part
    try:
        return part._replace(known=_known(database, one, models))
    except ValueError as error:
        part.failures.append(f"'{one.name}' is not recognized: {error}")
        return part


def _load_model(database: Database, one: Object, method: Method, models: Dict[str, bytes]) -> str:
    """Adds what a method has learned of an object to its models; returns what it lacks, or ""."""
    model = database.models.of(one.id, method.name)
    if model is None:
        return f"'{one.name}' was not learned by {method.name}: training does it"
    method.check_model(model.data)
    task = task_of(database, one, method, model.parameters)
    models[method.name] = model.data
    if task is None or task.key == model.key:
        return ""
    return f"'{one.name}' has changed since {method.name} has learned it: training does it"


def _known(database: Database, one: Object, models: Dict[str, bytes]) -> KnownObject:
    entry = database.meshes.entry(one.id)
    if entry is None:
        mesh, symmetries = box_around(models), []
    else:
        mesh = unpack_mesh(database.meshes.converted(one.id))
        symmetries = [(tuple(known.axis), known.fold) for known in entry.symmetries]
    made = mesh, MeshRenderer(mesh), ObjectShape(mesh, symmetries), corners_of(mesh)
    return KnownObject(one.id, one.name, *made, models, entry is None)


def corners_of(mesh: Mesh) -> np.ndarray:
    """Returns the corners, (8, 3), m, of the box around a mesh."""
    extent = mesh_extent(mesh)
    signs = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
    return np.asarray(extent.center) + signs * np.asarray(extent.size)
