"""Folders that appear with all of their files, and JSON files that others may have written."""

import contextlib
import errno
import json
import os
import shutil
from typing import Any, Dict, Iterator

from ...common.errors import about
from ...common.files import read_file, trying
from ...common.plain_text import brief
from ...common.temporary_files import random_name
from .json_values import parsed

MAX_JSON = 64 << 20  # bytes, the largest JSON file: the poses of a large scene
MAX_DATA = 1 << 30  # bytes, the largest other file


@contextlib.contextmanager
def new_folder(path: str) -> Iterator[str]:
    """Gives a folder to write into, which gets the name `path` at the end, or is removed.

    Raises:
        FileExistsError: There is something of this name.
        OSError: The folder cannot be made.
    """
    path = os.path.abspath(path)
    if os.path.lexists(path):
        raise FileExistsError(f"{path} is there already")
    temporary = f"{path}.{random_name()}.tmp"
    try:
        with trying(path, "made"):
            os.makedirs(temporary)
        yield temporary
        with trying(path, "made"):
            os.rename(temporary, path)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def write_data(data: bytes, folder: str, *names: str) -> None:
    """Writes a file below a folder that new_folder() has given, with the folders above it.

    Args:
        data: What the file has.
        folder: The folder.
        names: Those of the folders below it and of the file, of which a database may have any.

    Raises:
        OSError: The file cannot be written.
        ValueError: A name leads elsewhere.
    """
    name = os.path.join(folder, *map(_file_name, names))
    with trying(name, "written"):
        os.makedirs(os.path.dirname(name), exist_ok=True)
        with open(name, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())  # The folder gets its name only when all is on the disk.


def write_json(value: Any, folder: str, *names: str) -> None:
    """Writes a JSON file likewise."""
    write_data((json.dumps(value, indent=1, ensure_ascii=False) + "\n").encode(), folder, *names)


def read_json(*path: str, max_size: int = MAX_JSON) -> Dict[str, Any]:
    """Reads a JSON file with an object, of at most `max_size` bytes.

    Raises:
        OSError: The file cannot be read, or is larger.
        ValueError: It is something else.
    """
    name = os.path.join(*path)
    data = read_file(name, max_size)
    with about(name):
        value = parsed(data.decode())
        if not isinstance(value, dict):
            raise ValueError(f"it is {brief(value)}, must be an object of JSON")
    return value


def read_data(*path: str) -> bytes:
    """Reads a file that a JSON file names, beside which it has to be.

    Raises:
        OSError: The file cannot be read.
        ValueError: The name leads elsewhere.
    """
    *folders, name = path
    return read_file(os.path.join(*folders, _file_name(name)), MAX_DATA)


def _file_name(name: str) -> str:
    if not is_file_name(name):
        raise ValueError(f"a file is {brief(name)}, must be a name without a folder")
    return name


def is_file_name(name: Any) -> bool:
    """Returns whether a text is the name of a file in the same folder."""
    is_text = isinstance(name, str) and 0 < len(name.encode(errors="replace")) <= 255
    return is_text and name not in (".", "..") and not set(name) & {"/", "\\", "\0"}


def entries_of(folder: str) -> Iterator[str]:
    """Returns the names in a folder, sorted; none if there is no such folder."""
    if not os.path.lexists(folder):
        return iter(())
    with trying(folder, "read"):
        if not os.path.isdir(folder):
            raise OSError(errno.ENOTDIR, "it is no folder")
        return iter(sorted(os.listdir(folder)))
