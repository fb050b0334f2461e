"""The objects that a node is to recognize, loaded from the database."""

import itertools
from typing import Any, Dict, List, NamedTuple, Sequence

import numpy as np

from .. import Mesh, MeshRenderer, ObjectShape
from ..common.errors import about
from ..meshes import mesh_extent
from .database import Database, Object
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


def load_objects(path: str, chosen: Sequence[str], methods: Sequence[str]) -> Loaded:
    """Loads objects, and what was learned of them.

    Args:
        path: The database.
        chosen: Ids and names; none: all objects.
        methods: The names of the methods.
    """
    try:
        with Database(path) as database:
            there = list(map(database.objects.find, chosen)) if chosen else database.objects.all()
            loaded = [_load(database, one, methods) for one in there]
    except (OSError, ValueError) as error:
        return Loaded([], [], str(error))
    objects = [known for known, _ in loaded if known.models]
    lacks = [lack for _, of_one in loaded for lack in of_one]
    problem = ""
    if not there:
        problem = f"no objects in {path}: object_add.py adds them"
    elif not objects:
        problem = f"no object in {path} was learned by {' or '.join(methods)}: training does it"
    return Loaded(objects, [] if problem else lacks, problem)


def _load(database: Database, one: Object, methods: Sequence[str]) -> Any:
    """Returns an object with its models, and what it lacks."""
    models: Dict[str, bytes] = {}
    lacks: List[str] = []
    for method in methods:
        model = database.models.of(one.id, method)
        if model is None:
            lacks.append(f"'{one.name}' was not learned by {method}: training does it")
            continue
        models[method] = model.data
        task = task_of(database, one, method_of(method), model.parameters)
        if task is not None and task.key != model.key:
            lacks.append(
                f"'{one.name}' has changed since {method} has learned it: training does it"
            )
    if not models:
        return KnownObject(one.id, one.name, None, None, None, None, models), lacks
    entry = database.meshes.entry(one.id)
    with about(f"'{one.name}'"):
        if entry is None:
            mesh, symmetries = box_around(models), []
        else:
            mesh = unpack_mesh(database.meshes.converted(one.id))
            symmetries = [(tuple(known.axis), known.fold) for known in entry.symmetries]
        shape = ObjectShape(mesh, symmetries)
    known = (mesh, MeshRenderer(mesh), shape, corners_of(mesh), models, entry is None)
    return KnownObject(one.id, one.name, *known), lacks


def corners_of(mesh: Mesh) -> np.ndarray:
    """Returns the corners, (8, 3), m, of the box around a mesh."""
    extent = mesh_extent(mesh)
    signs = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
    return np.asarray(extent.center) + signs * np.asarray(extent.size)
