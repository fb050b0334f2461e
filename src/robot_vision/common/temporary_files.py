"""The steps in which files are written: aside under another name first, and then to their own."""

import contextlib
import errno
import os
import secrets
import stat
from typing import Iterator, Optional, Tuple

RANDOM = "[0-9a-f]{16}"  # regular expression of what random_name() returns


def replaced_file(path: str) -> Tuple[str, Optional[os.stat_result]]:
    """Returns the path with all links resolved, and the file's status or None if it is missing."""
    try:
        old = os.stat(path)
    except FileNotFoundError:
        if os.path.islink(path):
            raise OSError(errno.ENOENT, "it is a symbolic link that leads nowhere") from None
        return os.path.realpath(path), None
    if not stat.S_ISREG(old.st_mode):
        raise no_file()
    return os.path.realpath(path), old


def give_name(temporary: str, path: str) -> None:
    """Gives a written file its final name.

    Raises:
        FileExistsError: The name is taken.
    """
    try:
        os.link(temporary, path)  # Unlike a rename, this fails if the name is taken.
    except FileExistsError:
        raise
    except OSError:  # USB sticks have no hard links. There an empty file reserves the name.
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666))
        try:
            os.replace(temporary, path)
        except BaseException:
            os.unlink(path)
            raise


def no_file() -> OSError:
    """Returns the error of a path that is a folder, a pipe or a device."""
    return OSError(errno.EINVAL, "it is no file")


def random_name() -> str:
    """Returns a part of a name that no file has yet, unlike a process id, which may come again."""
    return secrets.token_hex(8)


@contextlib.contextmanager
def written_aside(path: str, data: bytes, old: Optional[os.stat_result] = None) -> Iterator[str]:
    """Writes a file and syncs it to the disk; at the end it is removed unless it was renamed.

    Args:
        path: The path of the new file.
        data: The content.
        old: The status of the file whose mode and owner it takes over; None takes the umask's mode.
    """
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
    try:
        # A private file must be private from the beginning.
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
    """Gives a file the mode and the owner of another one; only root may give files to others."""
    new = os.fstat(file)
    if (new.st_uid, new.st_gid) != (old.st_uid, old.st_gid):
        for owner in (old.st_uid, -1):
            with contextlib.suppress(PermissionError):
                os.fchown(file, owner, old.st_gid)
                break
    os.fchmod(file, stat.S_IMODE(old.st_mode))
