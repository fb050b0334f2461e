"""Files that are read with care, and written in one step or not at all.

Only regular files are read and replaced: a pipe may block and a device never end, and one that is
replaced by a file is gone for everybody.
"""

import contextlib
import errno
import itertools
import os
import secrets
import stat
from typing import Iterator, Optional, Tuple

MAX_TEXT = 1 << 20  # bytes, of a file of parameters
MAX_IMAGE = 256 << 20  # bytes, of an image file
CHUNK = 1 << 20  # bytes that are read at a time
ROS_HOME_NEEDED = "ROS_HOME names a folder that this user may write to"


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


def read_file(path: str, max_size: int) -> bytes:
    """A file's bytes, of which there must not be more than `max_size`.

    Raises:
        OSError: it is no regular file, too large, or cannot be read.
    """
    with trying(path, "read"):
        file = _open_regular(path)
        try:
            return _read_all(file, max_size)
        finally:
            os.close(file)


def require_file(path: str) -> None:
    """Raises OSError if a path is none of a regular file, for libraries that would wait for it."""
    with trying(path, "read"):
        os.close(_open_regular(path))


def _open_regular(path: str) -> int:
    if not stat.S_ISREG(os.stat(path).st_mode):  # to open some devices starts something
        raise _no_file()
    # It may be another by now, and without O_NONBLOCK a pipe waits for its other end.
    file = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        raise _no_file()
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
    """A file's text with its line ends as they are; empty if there is no such file.

    Raises:
        ValueError: it is not UTF-8.
        OSError: it cannot be read.
    """
    if not os.path.lexists(path):
        return ""
    try:
        return read_file(path, MAX_TEXT).decode()
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not overwritten, for it is no text: {error}") from None


def require_replaceable(path: str, replace: bool, new_folders: bool = False) -> None:
    """Raises OSError if a file cannot be written, which is better known before the work than after.

    Args:
        replace: whether it may be there already.
        new_folders: whether its folder need not be there, for make_folder() makes it.
    """
    with trying(path, "written"):
        target, _ = _replaced(path)
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
    """Makes the folder of a file and those above it, unless they are there.

    Raises:
        OSError: it cannot be made.
    """
    folder = os.path.dirname(os.path.realpath(path))
    with trying(folder, "made"):
        os.makedirs(folder, exist_ok=True)


def replace_file(path: str, data: bytes) -> None:
    """Writes a file, or replaces it; a reader sees the old or the new one, never a part.

    An old file keeps its permissions and, as far as this user may give it away, its owner; of a
    symbolic link the file it leads to is replaced.

    Raises:
        OSError: it cannot be written, or is no regular file; an old file is as it was.
    """
    with trying(path, "written"):
        target, old = _replaced(path)
        # In the same folder, or the rename is not atomic.
        with _temporary(f"{target}.{_random()}.tmp", data, old) as temporary:
            os.replace(temporary, target)


def _replaced(path: str) -> Tuple[str, Optional[os.stat_result]]:
    """The path of what is replaced, where links lead to, and its status; None: there is none."""
    try:
        old = os.stat(path)
    except FileNotFoundError:
        if os.path.islink(path):
            raise OSError(errno.ENOENT, "it is a symbolic link that leads nowhere") from None
        return os.path.realpath(path), None
    if not stat.S_ISREG(old.st_mode):
        raise _no_file()
    return os.path.realpath(path), old


def create_file(path: str, data: bytes) -> None:
    """Writes a new file, whole from the moment it is there; no other is overwritten.

    Raises:
        FileExistsError: there is one of this name.
        OSError: it cannot be written.
    """
    with trying(path, "written"):
        if os.path.lexists(path):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST))
        with _temporary(f"{path}.{_random()}.tmp", data) as temporary:
            _name(temporary, path)


def add_file(folder: str, stem: str, suffix: str, data: bytes) -> str:
    """Writes a new file, whole from the moment it is there; no other file is ever overwritten.

    Returns:
        Its path: stem and suffix, with -1, -2, ... between them if that name is taken.

    Raises:
        OSError: it cannot be written.
    """
    free, hidden = (os.path.join(folder, name) for name in (stem + suffix, f".{stem}.{_random()}"))
    with trying(free, "written"), _temporary(hidden + ".tmp", data) as temporary:
        for number in itertools.count():
            path = os.path.join(folder, stem + (f"-{number}" if number else "") + suffix)
            with contextlib.suppress(FileExistsError):
                _name(temporary, path)
                break
    return path


def _name(temporary: str, path: str) -> None:
    """Gives a file that is written a name, which must be free.

    Raises:
        FileExistsError: it is taken.
    """
    try:
        os.link(temporary, path)  # unlike a rename, it fails if the name is taken
    except FileExistsError:
        raise
    except OSError:  # USB sticks have no hard links: there an empty file takes the name first
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666))
        try:
            os.replace(temporary, path)
        except BaseException:
            os.unlink(path)
            raise


def _no_file() -> OSError:
    return OSError(errno.EINVAL, "it is no file")


def _random() -> str:
    """Part of a name that no file has; a number of the process may be in one that it left."""
    return secrets.token_hex(8)


@contextlib.contextmanager
def _temporary(path: str, data: bytes, old: Optional[os.stat_result] = None) -> Iterator[str]:
    """A new file, written down to the disk, that is gone in the end unless it was renamed.

    Args:
        old: whose mode and owner it has; None: the umask's mode.
    """
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
    try:
        # What is private stays so from the beginning.
        with open(os.open(path, flags, 0o600 if old else 0o666), "wb") as file:
            if old:
                _take_over(file.fileno(), old)
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        yield path
    finally:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(path)


def _take_over(file: int, old: os.stat_result) -> None:
    """Gives a file mode and owner of another; only root may give files to others."""
    new = os.fstat(file)
    if (new.st_uid, new.st_gid) != (old.st_uid, old.st_gid):
        for owner in (old.st_uid, -1):
            with contextlib.suppress(PermissionError):
                os.fchown(file, owner, old.st_gid)
                break
    os.fchmod(file, stat.S_IMODE(old.st_mode))
