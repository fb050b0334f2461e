"""Where the node gets its objects from: the database, which may change at any time."""

import os
import threading
import time
from typing import Callable, List, Optional, Sequence, Tuple

import rospy

from ..common.plain_text import brief
from ..ros.params import read_param
from .database import Database, default_path
from .known_objects import load_objects
from .recognition_report import RecognitionReport
from .recognition_settings import Settings
from .recognizer import Recognizer

CHECK_PERIOD = 1.0  # s between two looks whether the database has changed


class ObjectSource:
    """Makes a Recognizer of the objects in ~database, and anew when these or the settings change.

    Args:
        methods: The names of the methods that have learned the objects.
        settings: A function that returns the present settings.
        report: What is told of objects that cannot be used.

    Raises:
        ValueError: ~database is not an absolute path, or is no database; or with ~needs_models,
            there is nothing that could be recognized.
    """

    def __init__(
        self, methods: Sequence[str], settings: Callable[[], Settings], report: RecognitionReport
    ) -> None:
        self.path = _read_path()
        self._methods = methods
        self._settings = settings
        self._report = report
        self._lock = threading.Lock()  # guards all below: ~reload comes in a thread of its own
        self._recognizer: Optional[Recognizer] = None
        self._of: Optional[Settings] = None  # what the recognizer was made with
        self._stamp: Tuple[int, ...] = ()  # of the file that it was made of
        self._looked = time.monotonic()  # s
        _require_database(self.path)
        done, text = self.reload()
        if read_param("needs_models", False) and not done:
            raise ValueError(text)

    def recognizer(self) -> Optional[Recognizer]:
        """Returns what recognizes the objects; None if there are none, of which the report tells.

        The thread of the images calls it.
        """
        now = time.monotonic()
        with self._lock:
            if self._settings() is not self._of or now - self._looked >= CHECK_PERIOD:
                self._looked = now
                if self._settings() is not self._of or _stamp_of(self.path) != self._stamp:
                    self._make()
            return self._recognizer

    def reload(self) -> Tuple[bool, str]:
        """Loads the objects; returns whether there are any, and which, or the reason."""
        with self._lock:
            return self._make()

    def _make(self) -> Tuple[bool, str]:
        settings = self._settings()
        self._stamp, self._of, self._recognizer = _stamp_of(self.path), settings, None
        loaded = load_objects(self.path, settings.objects, self._methods)
        problem = loaded.problem
        if not problem:
            try:
                self._recognizer = Recognizer(loaded.objects, settings.params)
            except ValueError as error:
                problem = str(error)
        self._report.set_problem(problem, loaded.lacks)
        if problem:
            return False, problem
        names = ", ".join(one.name for one in loaded.objects)
        rospy.loginfo("%d objects of %s: %s", len(loaded.objects), self.path, names)
        return True, names


def _require_database(path: str) -> None:
    """Raises ValueError if there is something at the path that is no database."""
    if os.path.lexists(path):
        try:
            with Database(path) as database:
                database.objects.all()
        except OSError as error:
            raise ValueError(str(error)) from None


def _read_path() -> str:
    path = read_param("database", "") or default_path()
    expanded = os.path.expanduser(path)
    if not os.path.isabs(expanded):  # roslaunch and a node resolve it in different folders.
        raise ValueError(f"database is {brief(path)}, must be an absolute path")
    return expanded


def _stamp_of(path: str) -> Tuple[int, ...]:
    """Returns numbers that are others after somebody has written to a database."""
    stamp: List[int] = []
    for name in (path, path + "-wal"):
        try:
            status = os.stat(name)
            stamp += [status.st_ino, status.st_size, status.st_mtime_ns]
        except OSError:
            stamp += [0, 0, 0]
    return tuple(stamp)
