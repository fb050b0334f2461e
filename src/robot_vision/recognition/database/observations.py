"""Sessions and their observations in the database."""

import hashlib
import json
from typing import Any, List, Tuple

import numpy as np

from ...common.plain_text import brief
from .blobs import read_blob, store_blob
from .connection import Connection
from .documents import Observation, Session, new_id, now, storable
from .json_values import matrix, numbers

COLUMNS = "id, session_id, frame_number, rgb, depth, mask, matrix, distortion, pose"
OF_OBJECT = (
    "FROM observations JOIN sessions ON sessions.id = session_id WHERE object_id = ? "
    "ORDER BY sessions.added, session_id, frame_number, observations.id"
)


class Observations:
    """The sessions in which objects were looked at, and what was seen."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def add_session(self, session: Session) -> Session:
        """Adds a session within a transaction, and returns it with its id and time."""
        object_id, source = session.object_id, storable(session.source)
        added = Session(object_id, source, session.id or new_id(), session.added or now())
        values = added.id, object_id, source, added.added
        self._connection.execute("INSERT INTO sessions VALUES (?, ?, ?, ?)", values)
        return added

    def add(self, new: Observation) -> None:
        """Adds an observation of a session within a transaction."""
        blobs = [store_blob(self._connection, data) for data in (new.rgb, new.depth, new.mask)]
        numbers = [
            json.dumps(np.asarray(values, float).tolist())
            for values in (new.matrix, new.distortion, new.pose)
        ]
        values = new.id or new_id(), new.session_id, new.frame_number, *blobs, *numbers
        self._connection.execute(
            f"INSERT INTO observations ({COLUMNS}) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)", values
        )

    def sessions(self, object_id: str) -> List[Session]:
        """Returns the sessions of an object, the oldest first."""
        rows = self._connection.rows(
            "SELECT id, object_id, source, added FROM sessions WHERE object_id = ? "
            "ORDER BY added, id",
            (object_id,),
        )
        return [Session(of, source, number, added) for number, of, source, added in rows]

    def count(self, object_id: str) -> int:
        """Returns how many observations there are of an object."""
        query = (
            "SELECT count(*) FROM observations JOIN sessions ON sessions.id = session_id "
            "WHERE object_id = ?"
        )
        return self._connection.rows(query, (object_id,))[0][0]

    def of(self, session_id: str) -> List[Observation]:
        """Returns the observations of a session by their frame numbers."""
        rows = self._connection.rows(
            f"SELECT {COLUMNS} FROM observations WHERE session_id = ? ORDER BY frame_number, id",
            (session_id,),
        )
        return [self._observation(row) for row in rows]

    def poses(self, object_id: str) -> List[Tuple[str, np.ndarray]]:
        """Returns the ids and the poses of all observations of an object, without their images."""
        rows = self._connection.rows(f"SELECT observations.id, pose {OF_OBJECT}", (object_id,))
        return [(number, self._matrix("pose", pose, 4)) for number, pose in rows]

    def one(self, number: str) -> Observation:
        """Returns the observation of this id.

        Raises:
            ValueError: It is not there.
        """
        query = f"SELECT {COLUMNS} FROM observations WHERE id = ?"
        row = self._connection.row(query, (number,))
        if row is None:
            raise ValueError(f"{self._connection.path} has no observation {number[:8]} any more")
        return self._observation(row)

    def digest(self, object_id: str) -> str:
        """Returns a hash of all that was observed of an object; "" if it is nothing.

        Raises:
            ValueError: It is damaged: there is a value that is no text.
        """
        columns = "rgb, depth, mask, matrix, distortion, pose"
        rows = self._connection.rows(f"SELECT {columns} {OF_OBJECT}", (object_id,))
        odd = [value for row in rows for value in row if not isinstance(value, str)]
        if odd:
            path = self._connection.path
            raise ValueError(f"{path} is damaged: an observation has {brief(odd[0])}")
        return hashlib.sha256(json.dumps(rows).encode()).hexdigest() if rows else ""

    def delete_session(self, session_id: str) -> None:
        """Deletes a session and its observations within a transaction, if it is there."""
        self._connection.execute("DELETE FROM sessions WHERE id = ?", (session_id,))

    def _observation(self, row: Any) -> Observation:
        number, session_id, frame_number, rgb, depth, mask, matrix, distortion, pose = row
        rgb, depth, mask = (read_blob(self._connection, one) for one in (rgb, depth, mask))
        matrix, pose = self._matrix("matrix", matrix, 3), self._matrix("pose", pose, 4)
        values = self._connection.values("distortion", distortion)
        distortion = numbers(values, "distortion", None)
        return Observation(
            session_id, frame_number, rgb, depth, mask, matrix, pose, distortion, number
        )

    def _matrix(self, column: str, value: Any, size: int) -> np.ndarray:
        return matrix(self._connection.values(column, value), column, size)
