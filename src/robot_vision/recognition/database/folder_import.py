"""Objects from a folder that folder_export has written."""

import os
from typing import Any, Callable, Dict, List, Mapping

import numpy as np

from ...common.errors import about
from ...common.plain_text import brief
from .database import Database
from .documents import Mesh, Model, Object, Observation, Session
from .folder_export import (
    CONVERTED,
    FORMAT,
    IMAGES,
    INDEX,
    MESH,
    OBJECT,
    SESSION,
    VERSION,
)
from .folder_files import entries_of, is_file_name, read_data, read_json
from .json_values import integer, matrix, number, numbers, text, texts
from .meshes import from_json
from .objects import ID_LENGTH, is_id


def import_folder(
    database: Database,
    folder: str,
    replace: bool,
    check: Callable[[bytes], Any],
    tell: Callable[[str], None] = lambda line: None,
) -> int:
    """Adds the objects of a folder, within a transaction, and returns how many.

    Args:
        database: The database.
        folder: The folder.
        replace: Whether objects that are there are replaced; else they stay as they are.
        check: A function that raises ValueError if data is no mesh as pack_mesh() packs it.
        tell: A function that is told in a line of each object what becomes of it.

    Raises:
        OSError: A file cannot be read, or the database not be written.
        ValueError: A file is not what it must be.
    """
    index = read_json(folder, INDEX)
    with about(os.path.join(folder, INDEX)):
        if index.get("format") != FORMAT or index.get("version") != VERSION:
            found = brief({key: index.get(key) for key in ("format", "version")})
            raise ValueError(f"it is of {found}, must be '{FORMAT}', {VERSION}")
        ids = texts(index, "objects")
    count = 0
    there = {one.id for one in database.objects.all()}
    for object_id in ids:
        if not is_id(object_id):
            raise ValueError(f"{folder}: an object is {brief(object_id)}, must be an id")
        if object_id in there and not replace:
            tell(f"{object_id} is there already, and stays as it is")
            continue
        if object_id in there:
            database.objects.delete(object_id)
        _import_object(database, os.path.join(folder, object_id), object_id, check)
        tell(f"{object_id} {'replaced' if object_id in there else 'added'}")
        count += 1
    return count


def _import_object(
    database: Database, path: str, object_id: str, check: Callable[[bytes], Any]
) -> None:
    values = read_json(path, OBJECT)
    with about(os.path.join(path, OBJECT)):
        database.objects.add(object_of(values, object_id))
    if os.path.lexists(os.path.join(path, "mesh", MESH)):
        database.meshes.set(object_id, _mesh(os.path.join(path, "mesh"), check))
    for name in entries_of(os.path.join(path, "sessions")):
        _import_session(database, os.path.join(path, "sessions", name), object_id)
    for name in entries_of(os.path.join(path, "models")):
        if name.endswith(".json"):
            database.models.set(_model(os.path.join(path, "models"), name, object_id))


def object_of(values: Mapping[str, Any], object_id: str) -> Object:
    """Returns the object that a document of object_recognition_core describes."""
    return Object(
        text(values, "object_name"),
        text(values, "description", ""),
        texts(values, "tags", []),
        text(values, "author_name", ""),
        text(values, "author_email", ""),
        object_id,
        text(values, "added", ""),
    )


def _mesh(folder: str, check: Callable[[bytes], Any]) -> Mesh:
    values = read_json(folder, MESH)
    converted = read_data(folder, CONVERTED)
    with about(os.path.join(folder, CONVERTED)):
        check(converted)
    with about(os.path.join(folder, MESH)):
        name, files = text(values, "original"), os.path.join(folder, "files")
        others = {other: read_data(files, other) for other in texts(values, "files", [])}
        return Mesh(
            name,
            read_data(files, name),
            converted,
            others,
            number(values, "unit"),
            number(values, "scale"),
            tuple(numbers(values, "offset", 3)),
            from_json(values.get("symmetries", [])),
            text(values, "added", ""),
        )


def _import_session(database: Database, folder: str, object_id: str) -> None:
    values = read_json(folder, SESSION)
    with about(os.path.join(folder, SESSION)):
        source, added = text(values, "bag_id", ""), text(values, "added", "")
        session = Session(object_id, source, _id(values), added)
        session = database.observations.add_session(session)
        frames = values.get("observations")
        if not isinstance(frames, list):
            raise ValueError(f"observations is {brief(frames)}, must be a list")
        for index, frame in enumerate(frames):
            with about(f"observation {index}"):
                observation = _observation(folder, index, frame, session.id)
            database.observations.add(observation)


def _observation(folder: str, index: int, values: Dict[str, Any], session_id: str) -> Observation:
    if not isinstance(values, dict):
        raise ValueError(f"it is {brief(values)}, must be an object of JSON")
    images: List[bytes] = [read_data(folder, f"{index:06d}_{kind}.png") for kind in IMAGES]
    return Observation(
        session_id,
        integer(values, "frame_number"),
        *images,
        matrix(values, "K", 3),
        matrix(values, "pose", 4),
        np.asarray(numbers(values, "D", None), float).tolist(),
        _id(values),
    )


def _id(values: Mapping[str, Any]) -> str:
    """Returns the id of a document, or "" if it has none."""
    found = text(values, "_id", "")
    if found and not is_id(found):
        raise ValueError(f"_id is {brief(found)}, must have {ID_LENGTH} hexadecimal digits")
    return found


def _model(folder: str, name: str, object_id: str) -> Model:
    values = read_json(folder, name)
    with about(os.path.join(folder, name)):
        method, parameters = text(values, "method"), values.get("parameters")
        if not is_file_name(method) or not isinstance(parameters, dict):
            raise ValueError(f"method is {brief(method)}, and parameters {brief(parameters)}")
        data = read_data(folder, f"{method}.bin")
        return Model(
            object_id, method, parameters, text(values, "key"), data, text(values, "added", "")
        )
