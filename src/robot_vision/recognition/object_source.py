"""Where the node gets its objects from: the database, which may change at any time."""

import os
import threading
import time
from typing import Callable, List, Optional, Sequence, Tuple

import rospy

from ..common.plain_text import brief
from ..ros.params import read_param
from .database import Database, default_path
from .found import are_same
from .known_objects import Loaded, load_objects
from .recognition_report import RecognitionReport
from .recognition_settings import Settings
from .recognizer import Recognizer

CHECK_PERIOD = 1.0  # s between two looks whether the database has changed


class ObjectSource:
    """Makes a Recognizer of the objects in ~database, and anew when these or its settings change.

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
        self._of = settings()  # what the recognizer was made with
        self._loaded = Loaded([], [], "")  # what it was made of
        self._stamp: Tuple[int, ...] = ()  # of the file that this is of
        self._looked = time.monotonic()  # s
        _require_database(self.path)
        done, text = self.reload()
        if read_param("needs_models", False) and not done:
            raise ValueError(text)

    def recognizer(self) -> Optional[Recognizer]:
        """Returns what recognizes the objects; None if there are none, of which the report tells.

        The thread of the images calls it.
        """
        with self._lock:
            settings = self._settings()
            if settings.objects != self._of.objects or self._has_changed():
                self._load(settings)
            elif settings.params != self._of.params:
                self._make(settings)
            return self._recognizer

    def reload(self) -> Tuple[bool, str]:
        """Loads the objects; returns whether there are any, and which, or the reason."""
        with self._lock:
            return self._load(self._settings())

    def _has_changed(self) -> bool:
        """Returns whether the database has changed, at which it looks now and then."""
        now = time.monotonic()
        if now - self._looked < CHECK_PERIOD:
            return False
        self._looked = now
        return _stamp_of(self.path) != self._stamp

    def _load(self, settings: Settings) -> Tuple[bool, str]:
        # The file may change meanwhile. What cannot be read is a problem of the file as it is now.
        stamp = _stamp_of(self.path)
        before = self._loaded.objects
        self._loaded = load_objects(self.path, settings.objects, self._methods, before)
        self._stamp = stamp
        problem = self._make(settings)
        if problem or not self._loaded.objects:
            return False, problem or "methods names none"
        names = ", ".join(one.name for one in self._loaded.objects)
        if not are_same(self._loaded.objects, before):
            rospy.loginfo("%d objects of %s: %s", len(self._loaded.objects), self.path, names)
        return True, names

    def _make(self, settings: Settings) -> str:
        """Makes the recognizer of what was loaded, and returns the reason if there is none."""
        before, self._of, self._recognizer = self._recognizer, settings, None
        problem = self._loaded.problem
        if self._loaded.objects:
            try:
                objects = self._loaded.objects
                self._recognizer = Recognizer(objects, settings.params, before)
            except ValueError as error:
                problem = str(error)
        self._report.set_problem(problem, self._loaded.lacks)
        return problem


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
    """Returns numbers that are others after somebody has written to a database.

    Who only reads it makes an empty log beside it, and removes that.
    """
    stamp: List[int] = []
    for name in (path, path + "-wal"):
        try:
            status = os.stat(name)
            size = status.st_size
            stamp += [status.st_ino, size, status.st_mtime_ns] if size else [0, 0, 0]
        except OSError:
            stamp += [0, 0, 0]
    return tuple(stamp)
