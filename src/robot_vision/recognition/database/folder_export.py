"""The database as a folder: JSON files as the documents of object_recognition_core, and data.

database.json
<id of an object>/object.json
<id of an object>/mesh/mesh.json, with the files of the mesh
<id of an object>/sessions/<id>/session.json, with PNG files for each frame
<id of an object>/models/<method>.json and <method>.bin
"""

import os
from typing import Callable, Sequence

from ...common.errors import about
from .database import Database
from .documents import Mesh, Object, Observation
from .folder_files import new_folder, write_data, write_json
from .meshes import to_json

FORMAT = "robot_vision objects"
VERSION = 1
INDEX, OBJECT, MESH, SESSION = "database.json", "object.json", "mesh.json", "session.json"
CONVERTED = "converted.npz"  # beside the files of a mesh, in a folder of its own
IMAGES = ("rgb", "depth", "mask")


def export_folder(
    database: Database,
    objects: Sequence[Object],
    folder: str,
    with_models: bool = True,
    tell: Callable[[str], None] = lambda line: None,
) -> None:
    """Writes objects into a new folder, which appears when all of it is written.

    Raises:
        OSError: The folder is there already, or cannot be written.
        ValueError: The database is damaged.
    """
    with new_folder(folder) as made:
        for one in objects:
            with about(f"'{one.name}'"):
                _write_object(database, one, os.path.join(made, one.id), with_models)
            tell(f"{one.id} {one.name}")
        index = {"format": FORMAT, "version": VERSION, "objects": [one.id for one in objects]}
        write_json(index, made, INDEX)


def _write_object(database: Database, one: Object, path: str, with_models: bool) -> None:
    write_json(_object(one), path, OBJECT)
    mesh = database.meshes.of(one.id)
    if mesh is not None:
        _write_mesh(os.path.join(path, "mesh"), one.id, mesh)
    _write_sessions(database, one.id, path)
    if with_models:
        _write_models(database, one.id, os.path.join(path, "models"))


def _object(one: Object) -> object:
    return {
        "Type": "Object",
        "_id": one.id,
        "object_name": one.name,
        "description": one.description,
        "tags": one.tags,
        "author_name": one.author,
        "author_email": one.email,
        "added": one.added,
    }


def _write_mesh(folder: str, object_id: str, mesh: Mesh) -> None:
    document = {
        "Type": "Mesh",
        "object_id": object_id,
        "original": mesh.file_name,
        "files": sorted(mesh.files),
        "unit": mesh.unit,
        "scale": mesh.scale,
        "offset": list(mesh.offset),
        "symmetries": to_json(mesh.symmetries),
        "added": mesh.added,
    }
    write_json(document, folder, MESH)
    for name, data in {mesh.file_name: mesh.original, **mesh.files}.items():
        write_data(data, folder, "files", name)
    write_data(mesh.converted, folder, CONVERTED)


def _write_sessions(database: Database, object_id: str, path: str) -> None:
    for session in database.observations.sessions(object_id):
        frames = [
            _write_observation(path, session.id, number, one)
            for number, one in enumerate(database.observations.of(session.id))
        ]
        document = {
            "Type": "Session",
            "_id": session.id,
            "object_id": object_id,
            "bag_id": session.source,
            "added": session.added,
            "observations": frames,
        }
        write_json(document, path, "sessions", session.id, SESSION)


def _write_observation(path: str, session_id: str, number: int, one: Observation) -> object:
    for kind in IMAGES:
        name = f"{number:06d}_{kind}.png"
        write_data(getattr(one, kind), path, "sessions", session_id, name)
    return {
        "Type": "Observation",
        "_id": one.id,
        "frame_number": one.frame_number,
        "K": one.matrix.tolist(),
        "D": list(one.distortion),
        "pose": one.pose.tolist(),
    }


def _write_models(database: Database, object_id: str, folder: str) -> None:
    for entry in database.models.entries_of(object_id):
        model = database.models.of(object_id, entry.method)
        document = {
            "Type": "Model",
            "object_id": object_id,
            "method": model.method,
            "parameters": model.parameters,
            "key": model.key,
            "added": model.added,
        }
        write_json(document, folder, f"{model.method}.json")
        write_data(model.data, folder, f"{model.method}.bin")
