"""The one folder of bags: names that can be in it, and what is there."""

import contextlib
import datetime
import errno
import os
import re
import shutil
import stat
import threading
import time
from typing import Any, BinaryIO, Dict, Iterator, List, Tuple

from ..common.files import trying
from ..common.plain_text import brief
from .bag_summary import summary_of
from .encoding import to_json

BAG_NAME = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9_.-]*\.bag", re.ASCII)
SUFFIX, UNFINISHED = ".bag", ".active"
MAX_NAME = 100  # characters, with the ending
MAX_LISTED = 1000  # bags, the newest
MAX_CONTENTS = 512 << 10  # bytes of the topics of all bags in the list, as JSON
READING_TIME = 2.0  # s, for which bags are read at a time; the next time others are read
NOT_READ = "not read yet"
NOT_LISTED = "its topics are not listed: with those of newer bags they are too many"


def require_bag_name(name: str) -> str:
    """Returns the name of a bag. There is no other way from a name to a file of the folder.

    Raises:
        ValueError: It could be anything else than a file in the folder.
    """
    if not (len(name) <= MAX_NAME and BAG_NAME.fullmatch(name)):
        raise ValueError(
            f"the name of a bag is {brief(name)}, must be letters, digits, - _ . with .bag at its "
            f"end, and have at most {MAX_NAME} characters"
        )
    return name


def stem_of(wanted: str) -> str:
    """Returns what a bag can be named that somebody wants to name so; without a name, the time."""
    stem = re.sub(r"[^A-Za-z0-9_.-]+", "_", wanted.strip(), flags=re.ASCII)
    stem = re.sub(r"\.bag$", "", stem).lstrip(".-")[: MAX_NAME - len(SUFFIX)].strip("_.")
    return stem or datetime.datetime.now().strftime("%Y-%m-%d-%H-%M-%S")


class BagFolder:
    """The bags of a folder, which is made when the first is recorded.

    Args:
        path: The folder. It may be a link, but nothing in it is followed that is one.
    """

    def __init__(self, path: str):
        self.path = os.path.realpath(os.path.expanduser(path))
        self._lock = threading.Lock()  # guards _contents
        self._contents: Dict[Tuple[int, ...], Dict[str, Any]] = {}  # by inode, size and time

    def make(self) -> None:
        """Makes the folder; raises OSError if it cannot be made."""
        with trying(self.path, "made"):
            os.makedirs(self.path, exist_ok=True)

    def free_space(self) -> int:
        """Returns how many bytes can be written; of a folder that is not there, above it."""
        path = self.path
        while not os.path.isdir(path) and os.path.dirname(path) != path:
            path = os.path.dirname(path)
        return shutil.disk_usage(path).free

    def free_name(self, wanted: str) -> str:
        """Returns the name of a new bag, which no bag has yet, not even an unfinished one."""
        stem, number = stem_of(wanted), 0
        while True:
            ending = (f"-{number}" if number else "") + SUFFIX
            name = stem[: MAX_NAME - len(ending)] + ending
            paths = (os.path.join(self.path, name + end) for end in ("", UNFINISHED))
            if not any(map(os.path.lexists, paths)):
                return require_bag_name(name)
            number += 1

    def open(self, name: str, unfinished: bool = False) -> BinaryIO:
        """Opens a bag for reading, without a buffer if it is an unfinished one.

        Raises:
            ValueError: No bag can be named so.
            OSError: It is not there, or is no regular file of the folder itself.
        """
        require_bag_name(name)
        with trying(name, "read"), self._folder() as folder:
            flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
            file = os.open(name + UNFINISHED * unfinished, flags, dir_fd=folder)
            if not stat.S_ISREG(os.fstat(file).st_mode):
                os.close(file)
                raise OSError(errno.EINVAL, "it is no file")
            return os.fdopen(file, "rb", buffering=0 if unfinished else -1)

    def delete(self, name: str, unfinished: bool = False) -> None:
        """Deletes a bag; raises as open()."""
        self.open(name, unfinished).close()
        with trying(name, "deleted"), self._folder() as folder:
            os.unlink(name + UNFINISHED * unfinished, dir_fd=folder)

    def bags(self) -> List[Dict[str, Any]]:
        """Returns name, size (bytes), changed (s), start (s), duration (s), topics and problem.

        The newest comes first. Of a bag that cannot be read, or that comes after MAX_CONTENTS of
        topics, `topics` is None, and `problem` says the reason.
        """
        end = time.monotonic() + READING_TIME
        with self._lock:
            found = [self._described(name, end) for name in self._names(SUFFIX)]
        bags, size = [bag for bag in found if bag], 0
        for bag in bags:
            if size <= MAX_CONTENTS:
                size += len(to_json(bag["topics"]))
            if size > MAX_CONTENTS and bag["topics"]:
                bag.update(topics=None, problem=NOT_LISTED)
        return bags

    def unfinished(self) -> List[str]:
        """Returns the names of bags that somebody writes to, or whose recording was killed."""
        return [name[: -len(UNFINISHED)] for name in self._names(SUFFIX + UNFINISHED)]

    def _names(self, suffix: str) -> List[str]:
        """Returns the names of regular files with this ending, the newest first."""
        found: List[Tuple[float, str]] = []
        with contextlib.suppress(OSError), os.scandir(self.path) as entries:
            for entry in entries:
                plain = entry.name[: len(entry.name) - len(suffix)] + SUFFIX
                if not entry.name.endswith(suffix) or not BAG_NAME.fullmatch(plain):
                    continue
                with contextlib.suppress(OSError):  # It may be gone by now.
                    if entry.is_file(follow_symlinks=False) and len(plain) <= MAX_NAME:
                        found.append((entry.stat(follow_symlinks=False).st_mtime, entry.name))
        return [name for _, name in sorted(found, reverse=True)[:MAX_LISTED]]

    def _described(self, name: str, end: float) -> Dict[str, Any]:
        """Returns what is known of a bag, or {} if it has gone."""
        try:
            with self.open(name) as file:
                status = os.fstat(file.fileno())
                content = self._content(file, status, end)
        except OSError:
            return {}
        return {"name": name, "size": status.st_size, "changed": status.st_mtime, **content}

    def _content(self, file: BinaryIO, status: os.stat_result, end: float) -> Dict[str, Any]:
        """Returns what is in a bag, which is read once as long as the file does not change."""
        key = status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns
        known = self._contents.get(key)
        if known is None:
            known = {"start": 0.0, "duration": 0.0, "topics": None, "problem": NOT_READ}
            if time.monotonic() > end:
                return known
            try:
                known.update(summary_of(file), problem="")
            except ValueError as error:
                known["problem"] = str(error)
            while len(self._contents) >= MAX_LISTED:
                del self._contents[next(iter(self._contents))]
            self._contents[key] = known
        return known

    @contextlib.contextmanager
    def _folder(self) -> Iterator[int]:
        folder = os.open(self.path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            yield folder
        finally:
            os.close(folder)
