"""Reading files safely, and writing them in one step or not at all.

Only regular files are read and replaced. A pipe may block and a device may never end, and a file
that took the place of a pipe or a device would break it for everybody.
"""

import contextlib
import errno
import itertools
import os
import stat
from typing import Iterator

from .errors import about
from .temporary_files import give_name, no_file, random_name, replaced_file, written_aside

MAX_TEXT = 1 << 20  # bytes, largest parameter file
MAX_IMAGE = 256 << 20  # bytes, largest image file
CHUNK = 1 << 20  # bytes that are read at a time
ROS_HOME_NEEDED = "ROS_HOME names a folder that this user may write to"


@contextlib.contextmanager
def trying(path: str, what: str) -> Iterator[None]:
    """Makes an OSError say "<path> cannot be <what>: <reason>"; the type of the error stays."""
    try:
        yield
    except OSError as error:
        if error.strerror is None:  # The message already names the path.
            raise
        raise type(error)(f"{path} cannot be {what}: {error.strerror}") from error


def reason(error: Exception) -> str:
    """Returns the reason that an error gives, without the path that its message starts with."""
    return getattr(error.__cause__ or error, "strerror", None) or str(error)


def read_file(path: str, max_size: int) -> bytes:
    """Returns the bytes of a file of at most `max_size` bytes.

    Raises:
        OSError: The path is not a regular file, or the file is too large or cannot be read.
    """
    with trying(path, "read"), open(_open_regular(path), "rb", buffering=0) as file:
        return _read_all(file.fileno(), max_size)


def require_file(path: str) -> None:
    """Raises OSError unless the path is a regular file; some libraries would wait for others."""
    with trying(path, "read"):
        os.close(_open_regular(path))


def _open_regular(path: str) -> int:
    if not stat.S_ISREG(os.stat(path).st_mode):  # Opening some devices has side effects.
        raise no_file()
    # The path may lead elsewhere by now, and opening a pipe without O_NONBLOCK waits for a writer.
    file = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        raise no_file()
    return file


def _read_all(file: int, max_size: int) -> bytes:
    size = os.fstat(file).st_size
    chunks = []
    read = 0
    while max(size, read) <= max_size:
        chunk = os.read(file, CHUNK)
        if not chunk:
            return b"".join(chunks)
        chunks.append(chunk)
        read += len(chunk)
    has = f"{max(size, read) >> 20} MB"
    raise OSError(errno.EFBIG, f"it has {has}, must have at most {max_size >> 20}")


def read_text(path: str) -> str:
    """Returns the text of a file with its line ends unchanged, or "" if there is no such file.

    Raises:
        ValueError: The file is not UTF-8.
        OSError: The file cannot be read.
    """
    if not os.path.lexists(path):
        return ""
    with about(f"{path}: not overwritten, for it is no text"):
        return read_file(path, MAX_TEXT).decode()


def require_replaceable(path: str, replace: bool, new_folders: bool = False) -> None:
    """Raises OSError if a file cannot be written, so that a command knows it before its work.

    Args:
        path: The file.
        replace: Whether the file may exist already.
        new_folders: Whether the folder may be missing, because make_folder() will make it.
    """
    with trying(path, "written"):
        target, _ = replaced_file(path)
        folder = os.path.dirname(target)
        while new_folders and not os.path.lexists(folder):
            folder = os.path.dirname(folder)
        if not os.path.isdir(folder):
            raise OSError(errno.ENOTDIR, f"{folder} is no folder")
        if not os.access(folder, os.W_OK | os.X_OK):
            raise OSError(errno.EACCES, f"{folder} may not be written to")
    if os.path.lexists(path) and not replace:
        raise FileExistsError(f"{path} is there already; --force replaces it")


def make_folder(path: str) -> None:
    """Makes the folder of a file, and the folders above it, where they do not exist.

    Raises:
        OSError: The folder cannot be made.
    """
    folder = os.path.dirname(os.path.realpath(path))
    with trying(folder, "made"):
        os.makedirs(folder, exist_ok=True)


def replace_file(path: str, data: bytes) -> None:
    """Writes or replaces a file; a reader sees the old or the new content, never a part of it.

    An existing file keeps its permissions and, as far as this user may give it away, its owner. If
    the path is a symbolic link, the file that the link leads to is replaced.

    Raises:
        OSError: The file cannot be written or is not a regular file; an existing one is unchanged.
    """
    with trying(path, "written"):
        target, old = replaced_file(path)
        # A rename is atomic only within one folder.
        with written_aside(f"{target}.{random_name()}.tmp", data, old) as temporary:
            os.replace(temporary, target)


def create_file(path: str, data: bytes) -> None:
    """Writes a new file, which appears with its whole content; no other file is overwritten.

    Raises:
        FileExistsError: There is a file of this name.
        OSError: The file cannot be written.
    """
    with trying(path, "written"), written_aside(f"{path}.{random_name()}.tmp", data) as temporary:
        give_name(temporary, path)


def add_file(folder: str, stem: str, suffix: str, data: bytes) -> str:
    """Writes a file under a free name; it appears with its whole content, and overwrites no other.

    Returns:
        The path of the file. If <stem><suffix> is taken, -1, -2, ... is put between the two.

    Raises:
        OSError: The file cannot be written.
    """
    free, hidden = (os.path.join(folder, name) for name in (stem + suffix, "." + stem))
    with trying(free, "written"), written_aside(f"{hidden}.{random_name()}.tmp", data) as temporary:
        for number in itertools.count():
            path = os.path.join(folder, stem + (f"-{number}" if number else "") + suffix)
            with contextlib.suppress(FileExistsError):
                give_name(temporary, path)
                break
    return path
