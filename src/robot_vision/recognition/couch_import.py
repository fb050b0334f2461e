"""Objects from the CouchDB of object_recognition_core, as its _all_docs gives them in a file.

    curl 'http://localhost:5984/object_recognition/_all_docs?include_docs=true&attachments=true'

An object keeps its id. Its mesh is the attachment original.* of its model of the method `mesh`, or
mesh.stl beside it. What was learned is left out: only object_recognition_core can use it.
"""

import base64
import os
import tempfile
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Tuple

from ..common.errors import about
from ..common.plain_text import brief, printable
from .database import Database, Object
from .database.folder_files import MAX_DATA, is_file_name, read_json
from .database.folder_import import object_of
from .database.objects import checked_object, is_id
from .mesh_intake import Intake, take_mesh

MESH_METHOD = "mesh"


class _Attachment(NamedTuple):
    """A file of a document."""

    name: str
    data: Any  # base64, or None if it was left out


def import_couch(
    database: Database,
    path: str,
    replace: bool,
    tell: Callable[[str], None] = lambda line: None,
    warn: Callable[[str], None] = lambda line: None,
) -> int:
    """Adds the objects of a file, within a transaction, and returns how many.

    Args:
        database: The database.
        path: The file.
        replace: Whether objects that are there are replaced; else they stay as they are.
        tell: A function that is told in lines what becomes of the objects.
        warn: A function that is told in lines what is left out, as it cannot be taken.

    Raises:
        OSError: The file cannot be read, or the database not be written.
        ValueError: The file is not what it must be.
    """
    values = read_json(path, max_size=MAX_DATA)  # It has the data of all meshes.
    with about(path):
        documents = _documents(values)
        objects = {one["_id"]: one for one in documents if one.get("Type") == "Object"}
        meshes = _meshes(documents)
    count = 0
    there = {one.id for one in database.objects.all()}
    for object_id, values in objects.items():
        if object_id in there and not replace:
            tell(f"{object_id} is there already, and stays as it is")
            continue
        try:
            added = _checked(values, object_id)
        except ValueError as error:
            warn(f"object {printable(object_id)} is left out: {error}")
            continue
        mesh, lack = _mesh_of(meshes.get(object_id))
        if lack:
            stays = (
                "the object stays as it is"
                if object_id in there
                else "mesh_add.py can add another one"
            )
            warn(f"the mesh of {object_id} is left out, {stays}: {lack}")
        if lack and object_id in there:
            continue
        if object_id in there:
            database.objects.delete(object_id)
        database.objects.add(added)
        if mesh:
            for note in mesh.notes:
                tell(f"{object_id}: {note}")
            database.meshes.set(object_id, mesh.stored)
        tell(f"{object_id} added: '{added.name}'")
        count += 1
    return count


def _checked(values: Dict[str, Any], object_id: str) -> Object:
    """Returns the object of a document.

    Raises:
        ValueError: It can be none.
    """
    if not is_id(object_id):
        raise ValueError("its id must have 32 hexadecimal digits")
    return checked_object(object_of(values, object_id))


def _documents(values: Mapping[str, Any]) -> List[Dict[str, Any]]:
    rows = values.get("rows")
    if not isinstance(rows, list):
        raise ValueError(f"rows is {brief(rows)}, must be a list, as _all_docs of CouchDB has it")
    found = [row.get("doc") for row in rows if isinstance(row, dict)]
    documents = [one for one in found if isinstance(one, dict) and isinstance(one.get("_id"), str)]
    if rows and not documents:
        raise ValueError("it has no documents: is include_docs=true missing?")
    return documents


def _meshes(documents: List[Dict[str, Any]]) -> Dict[str, _Attachment]:
    """Returns the files of meshes, by the ids of their objects."""
    found = {}
    for one in documents:
        attached, object_id = one.get("_attachments"), one.get("object_id")
        is_mesh = one.get("method", one.get("ModelType")) == MESH_METHOD
        if not is_mesh or not isinstance(attached, dict) or not isinstance(object_id, str):
            continue
        names = sorted(name for name in attached if is_file_name(name))
        originals = [name for name in names if name.startswith("original.")]
        for name in [*originals, *(name for name in names if name.startswith("mesh."))]:
            content = attached[name]
            data = content.get("data") if isinstance(content, dict) else None
            found[object_id] = _Attachment(name, data)
            break
    if found and all(one.data is None for one in found.values()):
        raise ValueError("the meshes have no data: is attachments=true missing?")
    return found


def _mesh_of(attached: Optional[_Attachment]) -> Tuple[Optional[Intake], str]:
    """Returns the mesh of a file, or why it cannot be taken."""
    if attached is None:
        return None, ""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, attached.name)
        try:
            with open(path, "wb") as file:
                file.write(_content(attached.data))
            return take_mesh(path), ""
        except (OSError, ValueError) as error:
            return None, str(error).replace(folder + os.sep, "")


def _content(data: Any) -> bytes:
    if not isinstance(data, str):
        raise ValueError(f"its data is {brief(data)}, must be text")
    try:
        return base64.b64decode(data, validate=True)
    except ValueError as error:
        raise ValueError(f"its data cannot be read: {error}") from None
