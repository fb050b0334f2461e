"""The objects in the database."""

from typing import Any, List, Tuple

from ...common.errors import about
from ...common.plain_text import NAME, brief, is_name, printable
from .connection import Connection
from .documents import Object, new_id, now, storable

COLUMNS = "id, name, description, author, email, added"
ID_LENGTH = 32  # hexadecimal digits
MIN_PREFIX = 3  # digits of an id that may stand for it
MAX_TEXT = 10000  # letters of a description
MAX_SHOWN = 5  # objects that an error lists


class Objects:
    """The objects in the database, found by their ids, names and tags."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def add(self, new: Object) -> Object:
        """Adds an object within a transaction, and returns it with its id and time.

        Raises:
            ValueError: The object cannot be one, or its id is taken.
        """
        checked = checked_object(new)
        if self._connection.row("SELECT id FROM objects WHERE id = ?", (checked.id,)):
            raise ValueError(f"there is an object {checked.id} already")
        values = (checked.id, checked.name, checked.description)
        self._connection.execute(
            f"INSERT INTO objects ({COLUMNS}) VALUES (?, ?, ?, ?, ?, ?)",
            (*values, checked.author, checked.email, checked.added),
        )
        for tag in checked.tags:
            self._connection.execute("INSERT INTO tags VALUES (?, ?)", (checked.id, tag))
        return checked

    def delete(self, object_id: str) -> None:
        """Deletes an object and all that is of it within a transaction."""
        self._connection.execute("DELETE FROM objects WHERE id = ?", (object_id,))

    def all(self) -> List[Object]:
        """Returns all objects, sorted by name."""
        return self._where("", ())

    def named(self, name: str) -> List[Object]:
        """Returns the objects of this name."""
        return self._where("WHERE name = ?", (name,))

    def tagged(self, tag: str) -> List[Object]:
        """Returns the objects with this tag."""
        return self._where("WHERE id IN (SELECT object_id FROM tags WHERE tag = ?)", (tag,))

    def find(self, text: str) -> Object:
        """Returns the object that is meant: by its id, its name, or the first digits of its id.

        Raises:
            ValueError: There is none, or more than one.
        """
        found = self._meant(text) if _can_be_stored(text) else []
        if len(found) == 1:
            return found[0]
        shown = f"'{printable(text)}'"
        if not found:
            raise ValueError(f"there is no object {shown} in {self._connection.path}")
        several = ", ".join(one.id for one in found[:MAX_SHOWN]) + ", ..." * (
            len(found) > MAX_SHOWN
        )
        raise ValueError(f"{shown} may be one of {len(found)} objects: {several}")

    def _meant(self, text: str) -> List[Object]:
        found = self._where("WHERE id = ?", (text.lower(),)) or self.named(text)
        if found or len(text) < MIN_PREFIX:
            return found
        prefix = text.lower()
        return self._where("WHERE substr(id, 1, length(?)) = ?", (prefix, prefix))

    def _where(self, condition: str, values: Tuple[Any, ...]) -> List[Object]:
        rows = self._connection.rows(
            f"SELECT {COLUMNS} FROM objects {condition} ORDER BY name, added, id", values
        )
        found = [
            Object(name, description, self._tags(object_id), author, email, object_id, added)
            for object_id, name, description, author, email, added in rows
        ]
        with about(f"{self._connection.path} is damaged"):  # It may come from others.
            return [checked_object(one) for one in found]

    def _tags(self, object_id: str) -> List[str]:
        query = "SELECT tag FROM tags WHERE object_id = ? ORDER BY rowid"
        return [tag for (tag,) in self._connection.rows(query, (object_id,))]


def checked_object(new: Object) -> Object:
    """Returns an object that can be added: with an id, a time, and a name without white space.

    Raises:
        ValueError: A value cannot be one; the message says which.
    """
    name = checked_name(new.name, "the name of an object")
    tags = list(dict.fromkeys(checked_name(tag, "a tag") for tag in new.tags if tag != ""))
    for what in ("description", "author", "email", "added"):
        text = getattr(new, what)
        if not isinstance(text, str) or len(text) > MAX_TEXT or not _can_be_stored(text):
            raise ValueError(f"the {what} is {brief(text)}, must be text of {MAX_TEXT} letters")
    object_id = new.id or new_id()
    if not is_id(object_id):
        raise ValueError(f"an id is {brief(new.id)}, must have {ID_LENGTH} hexadecimal digits")
    others = new.description, tags, new.author, new.email
    return Object(name, *others, object_id, new.added or now())


def checked_name(value: Any, what: str) -> str:
    """Returns a name without white space around it.

    Raises:
        ValueError: It is no name.
    """
    if not isinstance(value, str) or not is_name(value.strip()):
        raise ValueError(f"{what} is {brief(value)}, must be {NAME}")
    return value.strip()


def is_id(text: str) -> bool:
    """Returns whether a text is an id as ours and those of CouchDB are."""
    return (
        isinstance(text, str) and len(text) == ID_LENGTH and not set(text) - set("0123456789abcdef")
    )


def _can_be_stored(text: str) -> bool:
    return storable(text) == text and "\0" not in text
