"""The meshes in the database."""

import dataclasses
import json
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

from ...common.plain_text import brief
from .blobs import read_blob, store_blob
from .connection import Connection
from .documents import Mesh, Symmetry, checked_symmetry, now, storable
from .json_values import integer, numbers

COLUMNS = "file_name, original, converted, unit, scale, origin_offset, symmetries, added"


class MeshEntry(NamedTuple):
    """What is known of a mesh without reading it."""

    file_name: str
    converted: str  # sha256 of the mesh in m
    unit: float
    symmetries: List[Symmetry]


class Meshes:
    """The mesh of each object that has one."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def set(self, object_id: str, mesh: Mesh) -> None:
        """Gives an object a mesh, in place of the one that it has, within a transaction."""
        self.delete(object_id)
        original = store_blob(self._connection, mesh.original)
        converted = store_blob(self._connection, mesh.converted)
        offset, symmetries = json.dumps(list(mesh.offset)), json.dumps(to_json(mesh.symmetries))
        self._connection.execute(
            f"INSERT INTO meshes (object_id, {COLUMNS}) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
            (
                *(object_id, storable(mesh.file_name), original, converted),
                *(mesh.unit, mesh.scale, offset, symmetries, mesh.added or now()),
            ),
        )
        files = {storable(name): data for name, data in mesh.files.items()}
        for name, data in files.items():
            values = object_id, name, store_blob(self._connection, data)
            self._connection.execute("INSERT INTO mesh_files VALUES (?, ?, ?)", values)

    def delete(self, object_id: str) -> None:
        """Deletes the mesh of an object, if it has one, within a transaction."""
        self._connection.execute("DELETE FROM meshes WHERE object_id = ?", (object_id,))

    def entry(self, object_id: str) -> Optional[MeshEntry]:
        """Returns what is known of an object's mesh, or None if it has none."""
        row = self._row(object_id)
        if row is None:
            return None
        return MeshEntry(
            row[0], row[2], row[3], from_json(self._connection.document("symmetries", row[6]))
        )

    def converted(self, object_id: str) -> bytes:
        """Returns the mesh in m of an object that has one.

        Raises:
            ValueError: It has none any more, or the mesh is damaged.
        """
        row = self._row(object_id)
        if row is None:
            raise ValueError(f"{self._connection.path} has no mesh of {object_id} any more")
        return read_blob(self._connection, row[2])

    def of(self, object_id: str) -> Optional[Mesh]:
        """Returns all of an object's mesh, or None if it has none."""
        row = self._row(object_id)
        if row is None:
            return None
        files = self._connection.rows(
            "SELECT name, data FROM mesh_files WHERE object_id = ? ORDER BY name", (object_id,)
        )
        file_name, original, converted, unit, scale, offset, symmetries, added = row
        return Mesh(
            file_name,
            read_blob(self._connection, original),
            read_blob(self._connection, converted),
            {name: read_blob(self._connection, digest) for name, digest in files},
            unit,
            scale,
            tuple(numbers(self._connection.values("origin_offset", offset), "origin_offset", 3)),
            from_json(self._connection.document("symmetries", symmetries)),
            added,
        )

    def _row(self, object_id: str) -> Any:
        return self._connection.row(
            f"SELECT {COLUMNS} FROM meshes WHERE object_id = ?", (object_id,)
        )


def to_json(symmetries: Sequence[Symmetry]) -> List[Dict[str, Any]]:
    """Returns symmetries as JSON has them."""
    return [dataclasses.asdict(symmetry) for symmetry in symmetries]


def from_json(values: Any) -> List[Symmetry]:
    """Returns the symmetries that to_json() has made values of.

    Raises:
        ValueError: They are not of this form.
    """
    if not isinstance(values, list) or not all(isinstance(value, dict) for value in values):
        raise ValueError(f"symmetries is {brief(values)}, must be a list of axis and fold")
    return [
        checked_symmetry(Symmetry(tuple(numbers(value, "axis", 3)), integer(value, "fold")))
        for value in values
    ]
