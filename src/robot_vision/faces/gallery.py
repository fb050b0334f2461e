"""The people whom a face recogniser knows: a folder, with a folder of pictures for each name.

    faces/Anna/1.png
    faces/Anna/2.png
    faces/Zoë/1.png

The pictures are all there is to know, and may be added and removed by hand. The faces in them are
kept in one more file, .faces, which is made anew from them whenever it does not fit to them.
"""

import contextlib
import errno
import os
import stat
import threading
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

import numpy as np

from ..common.files import reason, trying
from ..common.plain_text import printable
from .candidates import Candidates, digest_of
from .face_cache import read_faces, write_faces
from .face_picture import face_of
from .gallery_files import (
    decode,
    entries,
    folder_of,
    inside,
    is_picture,
    names_in,
    picture_files,
    read_picture,
    shown,
    valid_name,
    write_numbered,
)

CACHE = ".faces"
LONGEST_FOLDER = 300  # letters that are told of it
PRIVATE = 0o700  # mode of a gallery that is made: faces are nobody else's business


def _can_be_folder(path: str) -> bool:
    """Whether it is one, or may be made; also if that cannot be found out now."""
    try:
        return stat.S_ISDIR(os.stat(path).st_mode)
    except FileNotFoundError:
        return not os.path.islink(path)
    except OSError as error:
        return error.errno not in (errno.ENAMETOOLONG, errno.ENOTDIR, errno.ELOOP)
    except ValueError:  # there is a \0 in it
        return False


@dataclass
class Added:
    """What has become of pictures that were to be added."""

    pictures: int = 0  # added
    present: int = 0  # were there already
    problems: List[str] = field(default_factory=list)  # what was refused, and why


@dataclass
class Removed:
    """What has become of pictures that were to be removed."""

    pictures: int = 0  # removed
    problems: List[str] = field(default_factory=list)  # what is still there, and why


class Gallery:
    """Names, and the faces in their pictures. Thread-safe; nobody waits for a search of faces.

    Args:
        folder: of the names; need not be there before somebody is added.

    Raises:
        ValueError: it is no folder.
    """

    def __init__(self, folder: str):
        self.folder = os.path.abspath(os.path.expanduser(folder))
        if not _can_be_folder(self.folder):
            raise ValueError(f"gallery is '{printable(folder, LONGEST_FOLDER)}', must be a folder")
        self._lock = threading.Lock()  # guards the faces and the folder
        self._faces: Dict[str, Dict[str, np.ndarray]] = {}  # by name and digest of the picture

    def load(self) -> List[str]:
        """Takes names and faces from the folder.

        Returns:
            What of it could not be used, and why.
        """
        problems: List[str] = []
        cached: Optional[Dict[str, np.ndarray]] = None
        try:
            cached = read_faces(self._cache())
        except (OSError, ValueError) as error:
            problems.append(f"{CACHE} is made anew from the pictures: {reason(error)}")
        with self._lock:
            self._faces = {}
            for name in names_in(self.folder, problems):
                faces = self._load_faces(name, cached or {}, problems)
                if faces:
                    self._faces[name] = faces
            if cached is None or set(cached) != set(self._by_digest()):
                problems += self._save()
        return problems

    def names(self) -> Dict[str, int]:
        """How many pictures there are of whom, in the order of the names."""
        with self._lock:
            return {name: len(self._faces[name]) for name in sorted(self._faces)}

    def training(self) -> Tuple[List[np.ndarray], List[str]]:
        """All faces, and whose each is."""
        faces: List[np.ndarray] = []
        names: List[str] = []
        with self._lock:
            for name, theirs in self._faces.items():
                faces += theirs.values()
                names += [name] * len(theirs)
        return faces, names

    def add(self, name: str, pictures: Mapping[str, np.ndarray]) -> Added:
        """Adds those of a person's pictures that show a face; if one cannot be written, none.

        Args:
            name: of somebody known or new.
            pictures: (height, width, 3) BGR, uint8, by what a problem shall call them.

        Raises:
            ValueError: nobody can have this name.
            OSError: they cannot be written.
        """
        name = valid_name(name)
        candidates = Candidates()
        candidates.offer(pictures)
        return self._keep(name, candidates)

    def import_folder(
        self, folder: str, name: str = "", given_up: Callable[[], Any] = lambda: False
    ) -> Added:
        """Adds the largest face of each picture file, cut out with something around it.

        Args:
            folder: of pictures, which are left as they are.
            name: whose pictures they are. Empty: they are in subfolders, whose names count.
            given_up: asked between two pictures, whether to stop.

        Raises:
            ValueError: nobody can have this name, or the folder is in the gallery, or has no
                subfolders to take names from.
            OSError: the folder cannot be read, or the gallery not be written, or it was given up;
                people before that are added.
        """
        if name:
            return self._import_pictures(name, folder, given_up)
        self._check_source(folder)
        total = Added()
        found = [name for name in entries(folder) if not name.startswith(".")]
        people = [name for name in found if os.path.isdir(os.path.join(folder, name))]
        if not people:
            raise ValueError(
                f"{shown(folder)} must have a folder for each person, as Anna/1.jpg; "
                "to take its own pictures, say whose they are by name"
            )
        nobodys = sum(map(is_picture, found))
        if nobodys:
            total.problems.append(f"{shown(folder)}: {nobodys} pictures in no person's folder")
        for person in people:
            path = os.path.join(folder, person)
            try:
                added = self._import_pictures(person, path, given_up)
            except ValueError as error:
                total.problems.append(f"{shown(path)}: {error}")
                continue
            total.pictures += added.pictures
            total.present += added.present
            total.problems += added.problems
        return total

    def forget(self, name: str) -> Removed:
        """Removes a person's pictures, damaged ones, too; other files of the folder stay.

        Raises:
            ValueError: nobody is called so.
            OSError: the folder cannot be read.
        """
        name = valid_name(name)
        with self._lock:
            folder = self._folder(name)
            if not os.path.isdir(folder) and name not in self._faces:
                raise ValueError(f"nobody is called '{name}'")
            paths = picture_files(folder) if os.path.isdir(folder) else []
            removed = Removed()
            for path in paths:
                try:
                    os.unlink(path)
                    removed.pictures += 1
                except OSError as error:
                    removed.problems.append(f"{shown(path)} cannot be removed: {reason(error)}")
            left = self._load_faces(name, self._by_digest(), []) if removed.problems else {}
            self._faces.pop(name, None)
            if left:
                self._faces[name] = left
            with contextlib.suppress(OSError):  # it holds something else
                os.rmdir(folder)
            removed.problems += self._save_or_remove()
            return removed

    def _load_faces(
        self, name: str, cached: Mapping[str, np.ndarray], problems: List[str]
    ) -> Dict[str, np.ndarray]:
        """The faces of a person by the digests of their pictures."""
        faces: Dict[str, np.ndarray] = {}
        folder = self._folder(name)
        try:
            paths = picture_files(folder)
        except OSError as error:
            problems.append(f"{shown(folder)} is not used: {reason(error)}")
            return {}
        for path in paths:
            try:
                data = read_picture(inside(self.folder, path))
                digest = digest_of(data)
                faces[digest] = cached[digest] if digest in cached else face_of(decode(data))
            except (OSError, ValueError) as error:
                problems.append(f"{shown(path)} is not used: {reason(error)}")
        return faces

    def _import_pictures(self, name: str, folder: str, given_up: Callable[[], Any]) -> Added:
        name = valid_name(name)
        self._check_source(folder)
        candidates = Candidates()
        candidates.read(folder, given_up)
        if not candidates.files and not candidates.problems:
            candidates.problems.append(f"{shown(folder)}: there are no pictures in it")
        return self._keep(name, candidates)

    def _check_source(self, folder: str) -> None:
        """Raises ValueError if a folder to import is the gallery's: its portraits are cut again."""
        root = os.path.realpath(self.folder)
        if os.path.commonpath([root, os.path.realpath(folder)]) == root:
            raise ValueError(f"{shown(folder)} is in the gallery")

    def _keep(self, name: str, candidates: Candidates) -> Added:
        """Adds what is not known yet; if one file cannot be written, none."""
        with self._lock:
            known = self._faces.get(name, {})
            new = {digest: face for digest, face in candidates.faces.items() if digest not in known}
            present = candidates.repeated + len(candidates.faces) - len(new)
            added = Added(len(new), present, candidates.problems)
            if new:
                with trying(self.folder, "made"):
                    os.makedirs(self.folder, PRIVATE, exist_ok=True)
                write_numbered(self._folder(name), [candidates.files[digest] for digest in new])
                self._faces[name] = {**known, **new}
                added.problems += self._save()
            return added

    def _folder(self, name: str) -> str:
        return folder_of(self.folder, name)

    def _cache(self) -> str:
        return inside(self.folder, os.path.join(self.folder, CACHE))

    def _by_digest(self) -> Dict[str, np.ndarray]:
        return {digest: face for faces in self._faces.values() for digest, face in faces.items()}

    def _save(self) -> List[str]:
        """Writes the file of faces; what went wrong, which costs time at the next start only."""
        try:
            write_faces(self._cache(), self._by_digest())
        except (OSError, ValueError) as error:
            return [f"{CACHE} cannot be written, the next start takes longer: {reason(error)}"]
        return []

    def _save_or_remove(self) -> List[str]:
        """Writes the file of faces, for it holds some that have to go, or removes it."""
        problems = self._save()
        if not problems:
            return []
        try:
            os.unlink(os.path.join(self.folder, CACHE))
        except FileNotFoundError:
            return problems
        except OSError as error:
            return [f"{CACHE} still holds the faces, and cannot be removed: {reason(error)}"]
        return problems
