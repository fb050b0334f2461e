"""The file of the database, opened by SQLite: who may write to it, and what goes wrong in words."""

import contextlib
import errno
import os
import sqlite3
import time
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple
from urllib.parse import quote

from ...common.errors import about
from ...common.files import make_folder, require_file, trying
from ...common.plain_text import brief, error_text
from ...common.temporary_files import give_name, random_name
from .json_values import parsed
from .schema import APPLICATION, BLOBS, MIGRATIONS, TABLES, VERSION

TIMEOUT = 10.0  # s that one who writes waits for another one
POLL_PERIOD = 0.05  # s between two looks whether the other one has finished
Row = Tuple[Any, ...]


class Connection:
    """An open database. For one thread.

    Args:
        path: The file, which must be there.
        write: Whether to write to it. Readers see what was there when they began, and wait for
            nobody.

    Raises:
        OSError: The file cannot be opened.
        ValueError: It is no database of objects, is damaged, or is of a newer version.
    """

    def __init__(self, path: str, write: bool) -> None:
        self.path = path
        self._write = write
        require_file(path)
        self._database = _opened(path, write)
        try:
            self._prepare()
        except BaseException:
            self._database.close()
            raise

    def execute(self, statement: str, values: Sequence[Any] = ()) -> int:
        """Runs a statement, and returns how many rows it has changed."""
        with translated(self.path):
            return self._database.execute(statement, values).rowcount

    def rows(self, query: str, values: Sequence[Any] = ()) -> List[Row]:
        """Returns what a query finds."""
        with translated(self.path):
            return self._database.execute(query, values).fetchall()

    def row(self, query: str, values: Sequence[Any] = ()) -> Optional[Row]:
        """Returns the first row that a query finds, or None."""
        found = self.rows(query, values)
        return found[0] if found else None

    def document(self, column: str, value: Any) -> Any:
        """Returns what the document of JSON in a column says.

        Raises:
            ValueError: It is none.
        """
        with about(f"{self.path} is damaged: {column} is no JSON"):
            if not isinstance(value, str):
                raise ValueError(f"it is {brief(value)}")
            return parsed(value)

    def values(self, column: str, value: Any) -> Dict[str, Any]:
        """Returns what document() does by the name of the column, as json_values has values."""
        return {column: self.document(column, value)}

    @contextlib.contextmanager
    def transaction(self, commit: bool = True) -> Iterator[None]:
        """What is written within is there as a whole, or not at all.

        Args:
            commit: False: it was a trial, nothing of it stays.

        Raises:
            OSError: Another program writes, and does not finish for TIMEOUT; or the disk is full.
        """
        self._begin()
        try:
            yield
            self._remove_unused_blobs()
            self.execute("COMMIT" if commit else "ROLLBACK")
        except BaseException:
            if self._database.in_transaction:
                self._database.rollback()
            raise

    def close(self) -> None:
        """Closes the file; what was written is then in the file itself, not beside it."""
        if self._write:
            with contextlib.suppress(sqlite3.Error):
                self._database.execute("PRAGMA busy_timeout = 100")
                self._database.executescript("PRAGMA incremental_vacuum")  # execute() frees a page
                self._database.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchall()
        self._database.close()

    def _prepare(self) -> None:
        """Sets the connection up, and brings an older database up to date."""
        self.execute("PRAGMA trusted_schema = OFF")  # The file may come from others.
        self.execute(f"PRAGMA query_only = {'OFF' if self._write else 'ON'}")
        self.execute("PRAGMA foreign_keys = ON")
        if not self._write:
            self.execute("BEGIN")  # What it reads from now on is of one time.
        if self.rows("PRAGMA application_id")[0][0] != APPLICATION:
            raise ValueError(f"{self.path} is no database of objects")
        version = self._version_of_file()
        if version < VERSION and self._write:
            with self.transaction():
                self._migrate()
        elif version < VERSION:
            raise ValueError(
                f"{self.path} is of version {version}, and cannot be brought to {VERSION} while it "
                "may only be read"
            )

    def _version_of_file(self) -> int:
        version = self.rows("PRAGMA user_version")[0][0]
        if not 0 < version <= VERSION:
            raise ValueError(
                f"{self.path} is a database of version {version}, must be of 1 to {VERSION}: a "
                "newer robot_vision has written it"
            )
        return version

    def _migrate(self) -> None:
        for version in range(self._version_of_file() + 1, VERSION + 1):  # Another one may have.
            for statement in MIGRATIONS[version]:
                self.execute(statement)
        self.execute(f"PRAGMA user_version = {VERSION}")

    def _begin(self) -> None:
        if not self._write:
            raise PermissionError(f"{self.path} was opened to be read")
        deadline = time.monotonic() + TIMEOUT
        while True:
            try:
                self.execute("BEGIN IMMEDIATE")
                return
            except BusyError:
                if time.monotonic() > deadline:
                    raise
            time.sleep(POLL_PERIOD)  # Unlike SQLite's own waiting, Ctrl-C ends it.

    def _remove_unused_blobs(self) -> None:
        used = " UNION ALL ".join(f"SELECT {column} FROM {table}" for table, column in BLOBS)
        self.execute(f"DELETE FROM blobs WHERE sha256 NOT IN ({used})")


class BusyError(OSError):
    """Another program writes to the database."""


@contextlib.contextmanager
def translated(path: str) -> Iterator[None]:
    """Makes the errors of SQLite OSErrors and ValueErrors that say what is wrong with which file.

    Only their texts tell them apart in Python 3.8.
    """
    try:
        yield
    except sqlite3.Error as error:
        text = str(error)
        if "locked" in text or "busy" in text:
            raise BusyError(
                f"{path} is being written by another program, for more than {TIMEOUT:g} s"
            ) from None
        if "is full" in text:
            raise OSError(f"{path} cannot be written: {os.strerror(errno.ENOSPC)}") from None
        if "readonly" in text:
            raise PermissionError(f"{path} cannot be written: it may only be read") from None
        if "not a database" in text:
            raise ValueError(f"{path} is no database of objects") from None
        if any(word in text for word in ("malformed", "no such", "corrupt", "not decode")):
            raise ValueError(f"{path} is damaged: {error_text(error)}") from None
        if isinstance(error, sqlite3.IntegrityError):
            raise ValueError(f"{path}: the object is not there any more ({text})") from None
        raise OSError(f"{path} cannot be used: {text}") from None


def create(path: str) -> None:
    """Makes an empty database, with all of it or not at all; one that is there already stays.

    Raises:
        OSError: The file cannot be made.
    """
    make_folder(path)
    temporary = f"{path}.{random_name()}.tmp"
    try:
        with trying(path, "written"):
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
            os.close(os.open(temporary, flags, 0o666))
        with translated(path):
            _make_tables(temporary)
        with trying(path, "written"), contextlib.suppress(FileExistsError):
            give_name(temporary, path)
    finally:
        for rest in ("", "-wal", "-shm", "-journal"):
            with contextlib.suppress(FileNotFoundError):
                os.unlink(temporary + rest)


def _make_tables(path: str) -> None:
    with contextlib.closing(_connect(path, "mode=rw")) as database:
        database.execute("PRAGMA auto_vacuum = INCREMENTAL")
        database.execute("BEGIN")
        for statement in TABLES:
            database.execute(statement)
        database.execute(f"PRAGMA application_id = {APPLICATION}")
        database.execute(f"PRAGMA user_version = {VERSION}")
        database.execute("COMMIT")
        database.execute("PRAGMA journal_mode = WAL").fetchall()


def _opened(path: str, write: bool) -> sqlite3.Connection:
    with translated(path):
        try:
            return _connect(path, "mode=rw")
        except sqlite3.OperationalError:
            # SQLite wants to write beside a file that is only read, too, unless it is told that
            # nobody else writes.
            if write or not os.access(path, os.R_OK) or _has_log(path):
                raise
            return _connect(path, "immutable=1")


def _connect(path: str, mode: str) -> sqlite3.Connection:
    uri = f"file:{quote(os.fsencode(os.path.abspath(path)))}?{mode}"
    database = sqlite3.connect(uri, timeout=1.0, isolation_level=None, uri=True)
    try:
        database.execute("SELECT count(*) FROM sqlite_master").fetchall()  # which opens the file
    except BaseException:
        database.close()
        raise
    return database


def _has_log(path: str) -> bool:
    try:
        return os.path.getsize(path + "-wal") > 0
    except OSError:
        return False
