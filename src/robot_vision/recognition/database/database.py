"""The database of objects."""

import os
from typing import Any, ContextManager

from ...common.plain_text import printable
from .connection import Connection, create
from .meshes import Meshes
from .models import Models
from .objects import Objects
from .observations import Observations


class Database:
    """The objects in a file, with their meshes, observations and models. For one thread.

    What changes it is called within transaction(), which makes all of it, or nothing.

    Args:
        path: The file.
        write: Whether to write to it.
        make: Whether a database that is written to is made if it is not there.

    Raises:
        OSError: The file is not there, or cannot be opened or made.
        ValueError: It is no database of objects, is damaged, or is of a newer version.
    """

    def __init__(self, path: str, write: bool = False, make: bool = True) -> None:
        self.path = path
        if not os.path.lexists(path):
            if not write or not make:
                raise FileNotFoundError(
                    f"there is no database {printable(path, 300)}: object_add.py makes it"
                )
            create(path)
        self._connection = Connection(path, write)
        self.objects = Objects(self._connection)
        self.meshes = Meshes(self._connection)
        self.observations = Observations(self._connection)
        self.models = Models(self._connection)

    def transaction(self, commit: bool = True) -> ContextManager[None]:
        """Within it, the database may be changed; others who want to change it wait.

        Args:
            commit: False: it is a trial, nothing of it stays.

        Raises:
            OSError: Somebody else is writing all the time, or the disk is full. Nothing of what was
                done within is there then.
        """
        return self._connection.transaction(commit)

    def close(self) -> None:
        """Closes the file."""
        self._connection.close()

    def __enter__(self) -> "Database":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()
