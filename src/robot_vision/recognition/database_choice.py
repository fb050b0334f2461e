"""Which database is meant: a file of ours, also where object_recognition_core had a server."""

import os
from typing import Any, List, Mapping, Tuple
from urllib.parse import unquote, urlsplit

from ..common.plain_text import brief, printable
from .database import default_path

OURS = "sqlite"
THEIR_COLLECTION = "object_recognition"
KNOWN = ("type", "root", "collection", "url")


def chosen_database(given: str, db: Mapping[str, Any]) -> Tuple[str, List[str]]:
    """Returns the path of the database, and what there is to be warned of.

    Args:
        given: A path that comes before all else, or "".
        db: type, root and collection, as .ork files and object_recognition_core's commands have
            them; what it does not have is ours.

    Raises:
        ValueError: A value has another type than text.
    """
    for key, value in db.items():
        if key in KNOWN and not isinstance(value, str):
            raise ValueError(f"{printable(key)} of the database is {brief(value)}, must be text")
    if given:
        return os.path.abspath(os.path.expanduser(given)), []
    kind, root = db.get("type", ""), db.get("root", "") or db.get("url", "")
    is_ours = kind.lower() == OURS or (not kind and root and "://" not in root)
    if is_ours or root.startswith("file://"):
        path = _path_of(root) if root else default_path()
        return os.path.abspath(os.path.expanduser(path)), _of_collection(db, path)
    path = default_path()
    if kind or root:
        server = f"the {printable(kind) or 'server'}{printable(' at ' + root if root else '')}"
        return path, [f"{server} is not used: the database is {path}"]
    return path, _of_collection(db, path)


def _path_of(root: str) -> str:
    return unquote(urlsplit(root).path) if root.startswith("file://") else root


def _of_collection(db: Mapping[str, Any], path: str) -> List[str]:
    collection = db.get("collection", "") or THEIR_COLLECTION
    if collection == THEIR_COLLECTION:
        return []
    return [f"there are no collections, as '{printable(collection)}': all of {path} is used"]
