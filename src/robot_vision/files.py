"""Text that is edited, and files that are written in one step or not at all."""

import contextlib
import itertools
import os
import secrets
import stat
from typing import Iterator, Optional


@contextlib.contextmanager
def trying(path: str, what: str) -> Iterator[None]:
    """Lets an OSError say "<path> cannot be <what>: ..." instead of a number; its type stays."""
    try:
        yield
    except OSError as error:
        if error.strerror is None:  # it says so already
            raise
        raise type(error)(f"{path} cannot be {what}: {error.strerror}") from error


def reason(error: Exception) -> str:
    """What an error says, without the path that is named beside it."""
    return getattr(error.__cause__ or error, "strerror", None) or str(error)


def read_text(path: str) -> str:
    """A file's text with its line ends as they are; empty if there is no such file.

    Raises:
        ValueError: it is not UTF-8.
        OSError: it cannot be read.
    """
    if not os.path.lexists(path):
        return ""
    with trying(path, "read"), open(path, encoding="utf-8", newline="") as file:
        try:
            return file.read()
        except UnicodeDecodeError as error:
            raise ValueError(f"{path}: not overwritten, for it is no text: {error}") from None


def replace_file(path: str, data: bytes) -> None:
    """Writes a file, or replaces it; a reader sees the old or the new one, never a part.

    An old file keeps its permissions; of a symbolic link the file it leads to is replaced.

    Raises:
        OSError: it cannot be written; an old file is as it was.
    """
    with trying(path, "written"):
        _replace(os.path.realpath(path), data)


def _replace(path: str, data: bytes) -> None:
    mode = stat.S_IMODE(os.stat(path).st_mode) if os.path.exists(path) else None
    # In the same folder, or the rename is not atomic.
    temporary = f"{path}.{_random()}.tmp"
    _write_new(temporary, data, mode)
    try:
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def create_file(path: str, data: bytes) -> None:
    """Writes a new file; a reader sees an empty or the whole one, and no other is overwritten.

    Unlike add_file() it needs no hard links, which USB sticks do not have.

    Raises:
        FileExistsError: there is one of this name.
        OSError: it cannot be written.
    """
    with trying(path, "written"):
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666))
    try:
        replace_file(path, data)
    except BaseException:
        os.unlink(path)
        raise


def add_file(folder: str, stem: str, suffix: str, data: bytes) -> str:
    """Writes a new file, whole from the moment it is there; no other file is ever overwritten.

    Returns:
        Its path: stem and suffix, with -1, -2, ... between them if that name is taken.

    Raises:
        OSError: it cannot be written, or the file system has no hard links.
    """
    with trying(os.path.join(folder, stem + suffix), "written"):
        return _add(folder, stem, suffix, data)


def _add(folder: str, stem: str, suffix: str, data: bytes) -> str:
    temporary = os.path.join(folder, f".{stem}.{_random()}.tmp")
    _write_new(temporary, data)
    try:
        for number in itertools.count():
            path = os.path.join(folder, stem + (f"-{number}" if number else "") + suffix)
            try:
                os.link(temporary, path)  # unlike a rename, it fails if the name is taken
                return path
            except FileExistsError:
                continue
    finally:
        os.unlink(temporary)


def _random() -> str:
    """Part of a name that no file has; a number of the process may be in one that it left."""
    return secrets.token_hex(8)


def _write_new(path: str, data: bytes, mode: Optional[int] = None) -> None:
    """Writes a file that is not there yet, down to the disk; the default mode is the umask's."""
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
    with open(os.open(path, flags, 0o666), "wb") as file:
        try:
            if mode is not None:
                os.fchmod(file.fileno(), mode)
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        except BaseException:
            os.unlink(path)
            raise
