"""Writing small files that belong together: all of them or none.

No file system replaces two files at once. What can fail is done before the first of them gets its
name, and what has been done is undone if another one fails; only a process that is killed between
two renames leaves some of the new ones.
"""

import contextlib
import itertools
import os
from typing import List, Mapping, NamedTuple, Optional

from .files import MAX_IMAGE, read_file, replace_file, trying
from .temporary_files import give_name, random_name, replaced_file, written_aside


class _Ready(NamedTuple):
    """A file that is written, but does not have its name yet."""

    temporary: str
    target: str
    before: Optional[bytes] = None  # the content of what it is going to replace


def replace_files(files: Mapping[str, bytes]) -> None:
    """Writes or replaces files, each as replace_file() does.

    Args:
        files: The content of each path.

    Raises:
        OSError: One of them cannot be written; all are as they were.
    """
    with contextlib.ExitStack() as stack:
        ready = []
        for path, data in files.items():
            with trying(path, "written"):
                target, old = replaced_file(path)
                before = read_file(target, MAX_IMAGE) if old else None
                aside = written_aside(f"{target}.{random_name()}.tmp", data, old)
                ready.append(_Ready(stack.enter_context(aside), target, before))
        try:
            for path, file in zip(files, ready):
                with trying(path, "written"):
                    os.replace(file.temporary, file.target)
        except BaseException:
            for file in ready:
                _restore(file)
            raise


def add_files(files: Mapping[str, bytes]) -> List[str]:
    """Writes new files under free names; no other file is overwritten.

    Args:
        files: The content of each path.

    Returns:
        The paths of the files. If one of the names is taken, -1, -2, ... is put before the suffix
        of all of them.

    Raises:
        OSError: One of them cannot be written; there is none of them.
    """
    with contextlib.ExitStack() as stack:
        temporaries = []
        for path, data in files.items():
            folder, name = os.path.split(path)
            hidden = os.path.join(folder, f".{name}.{random_name()}.tmp")
            with trying(path, "written"):
                temporaries.append(stack.enter_context(written_aside(hidden, data)))
        for number in itertools.count():
            ready = [_Ready(*names) for names in zip(temporaries, _numbered(files, number))]
            with contextlib.suppress(FileExistsError):
                _name_all(ready)
                break
    return [file.target for file in ready]


def _numbered(paths: Mapping[str, bytes], number: int) -> List[str]:
    suffix = f"-{number}" if number else ""
    return [stem + suffix + ending for stem, ending in map(os.path.splitext, paths)]


def _name_all(ready: List[_Ready]) -> None:
    """Gives files their names; if one is taken or fails, none has it."""
    try:
        for file in ready:
            with trying(file.target, "written"):
                give_name(file.temporary, file.target)
    except BaseException:
        for file in ready:
            _take_name(file)
        raise


def _take_name(file: _Ready) -> None:
    """Undoes what give_name() may have done."""
    if not os.path.lexists(file.temporary):  # It was renamed, because there are no hard links.
        os.replace(file.target, file.temporary)
    elif os.path.exists(file.target) and os.path.samefile(file.temporary, file.target):
        os.unlink(file.target)


def _restore(file: _Ready) -> None:
    """Undoes what os.replace() may have done."""
    if os.path.lexists(file.temporary):  # It has not replaced anything.
        return
    if file.before is None:
        os.unlink(file.target)
    else:
        replace_file(file.target, file.before)
