"""What methods have learned of objects, and what they have done so far."""

import json
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

from ...common.plain_text import brief
from .blobs import read_blob, store_blob
from .connection import Connection
from .documents import Model, now

COLUMNS = "object_id, method, parameters, key, data, added"
MAX_STATES = 20  # of interrupted trainings


class ModelEntry(NamedTuple):
    """What is known of a model without reading it."""

    object_id: str
    method: str
    parameters: Dict[str, Any]
    key: str
    added: str


class Models:
    """The model of each object by each method that has learned it."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def set(self, model: Model) -> None:
        """Stores a model within a transaction, in place of the one of the same method.

        What was stored of its training is deleted.
        """
        parameters = json.dumps(model.parameters, sort_keys=True)
        values = (model.object_id, model.method, parameters, model.key)
        self._connection.execute(
            f"INSERT OR REPLACE INTO models ({COLUMNS}) VALUES (?, ?, ?, ?, ?, ?)",
            (*values, store_blob(self._connection, model.data), model.added or now()),
        )
        self._connection.execute("DELETE FROM training WHERE key = ?", (model.key,))

    def entries(self, method: str) -> List[ModelEntry]:
        """Returns what is known of all models of a method, without reading them."""
        return self._entries("method = ?", method)

    def entries_of(self, object_id: str) -> List[ModelEntry]:
        """Returns what is known of an object's models, without reading them."""
        return self._entries("object_id = ?", object_id)

    def entry(self, object_id: str, method: str) -> Optional[ModelEntry]:
        """Returns what is known of a model without reading it, or None if there is none."""
        entries = self._entries("object_id = ? AND method = ?", object_id, method)
        return entries[0] if entries else None

    def of(self, object_id: str, method: str) -> Optional[Model]:
        """Returns what a method has learned of an object, or None."""
        return self._model("object_id = ? AND method = ?", (object_id, method))

    def with_key(self, key: str) -> Optional[Model]:
        """Returns a model that was made of what has this hash, of whatever object, or None."""
        return self._model("key = ?", (key,))

    def delete(self, object_id: str, method: str) -> None:
        """Deletes a model within a transaction, if it is there."""
        where = "DELETE FROM models WHERE object_id = ? AND method = ?"
        self._connection.execute(where, (object_id, method))

    def set_state(self, key: str, done: int, state: bytes) -> None:
        """Stores within a transaction what a training has done, in place of what was stored.

        Of trainings that nobody goes on with, as their objects have changed, the newest are kept.
        """
        values = key, done, store_blob(self._connection, state)
        self._connection.execute("INSERT OR REPLACE INTO training VALUES (?, ?, ?)", values)
        newest = "SELECT rowid FROM training ORDER BY rowid DESC LIMIT ?"
        self._connection.execute(
            f"DELETE FROM training WHERE rowid NOT IN ({newest})", (MAX_STATES,)
        )

    def state(self, key: str) -> Optional[Tuple[int, bytes]]:
        """Returns what a training has done, and how many views that are, or None."""
        row = self._connection.row("SELECT done, state FROM training WHERE key = ?", (key,))
        return (row[0], read_blob(self._connection, row[1])) if row else None

    def _entries(self, condition: str, *values: str) -> List[ModelEntry]:
        rows = self._connection.rows(
            "SELECT object_id, method, parameters, key, added FROM models "
            f"WHERE {condition} ORDER BY object_id, method",
            values,
        )
        return [
            ModelEntry(of, method, self._parameters(parameters), key, added)
            for of, method, parameters, key, added in rows
        ]

    def _model(self, condition: str, values: Tuple[str, ...]) -> Optional[Model]:
        row = self._connection.row(
            f"SELECT {COLUMNS} FROM models WHERE {condition} ORDER BY object_id", values
        )
        if row is None:
            return None
        object_id, method, parameters, key, data, added = row
        data = read_blob(self._connection, data)
        return Model(object_id, method, self._parameters(parameters), key, data, added)

    def _parameters(self, text: str) -> Dict[str, Any]:
        values = self._connection.document("parameters", text)
        if not isinstance(values, dict):
            raise ValueError(f"{self._connection.path} is damaged: parameters is {brief(values)}")
        return values
