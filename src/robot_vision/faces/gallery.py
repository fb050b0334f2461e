"""The gallery of people whom a face recogniser knows: a folder with a folder for each name.

    faces/Anna/1.png
    faces/Anna/2.png
    faces/Zoë/1.png

The image files are all that has to be kept, and may be added and removed by hand. One more file,
.faces, caches the faces in them, and is made again whenever it does not fit them.
"""

import contextlib
import errno
import os
import re
import stat
import threading
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

import numpy as np

from ..common.files import read_file, reason, trying
from ..common.image_files import upright
from ..common.plain_text import printable
from .candidates import Candidates, digest_of
from .face_cache import read_faces, write_faces
from .face_images import face_of
from .gallery_files import (
    MAX_FILE,
    entries,
    folder_of,
    image_paths,
    inside,
    is_image_file,
    left_over,
    names_in,
    shown,
    valid_name,
    write_numbered,
)

CACHE = ".faces"
MAX_FOLDER_LENGTH = 300  # characters of a folder in an error
PRIVATE = 0o700  # mode of a new gallery: its faces are private


def _can_be_folder(path: str) -> bool:
    """Returns whether a path is, or can become, a folder; also if that is not known now."""
    try:
        return stat.S_ISDIR(os.stat(path).st_mode)
    except FileNotFoundError:
        return not os.path.islink(path)
    except OSError as error:
        return error.errno not in (errno.ENAMETOOLONG, errno.ENOTDIR, errno.ELOOP)
    except ValueError:  # The path has a \0.
        return False


def _removed(path: str, problems: List[str]) -> bool:
    """Returns whether a file could be removed; adds the reason to `problems` if not."""
    try:
        os.unlink(path)
    except OSError as error:
        problems.append(f"{shown(path)} cannot be removed: {reason(error)}")
        return False
    return True


@dataclass
class Added:
    """The result of adding images."""

    pictures: int = 0  # number of images added
    present: int = 0  # number of images that were there already
    problems: List[str] = field(default_factory=list)  # what was refused, and the reason


@dataclass
class Removed:
    """The result of removing images."""

    pictures: int = 0  # number of images removed
    problems: List[str] = field(default_factory=list)  # what could not be removed, and the reason


class Gallery:
    """The names in a gallery, and the faces in their images.

    It is thread-safe, and nobody has to wait while the faces of new images are searched.

    Args:
        folder: The folder of the gallery, which need not exist before the first person is added.

    Raises:
        ValueError: The path is not a folder.
    """

    def __init__(self, folder: str):
        self.folder = os.path.abspath(os.path.expanduser(folder))
        if not _can_be_folder(self.folder):
            raise ValueError(
                f"gallery is '{printable(folder, MAX_FOLDER_LENGTH)}', must be a folder"
            )
        self._lock = threading.Lock()  # guards the faces and the folder
        self._faces: Dict[str, Dict[str, np.ndarray]] = {}  # by name, then digest of the image

    def load(self) -> List[str]:
        """Loads names and faces from the folder.

        Returns:
            The problems: what could not be used, and the reason.
        """
        problems: List[str] = []
        cached: Optional[Dict[str, np.ndarray]] = None
        try:
            cached = read_faces(self._cache())
        except (OSError, ValueError) as error:
            problems.append(f"{CACHE} is made anew from the images: {reason(error)}")
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
        """Returns the number of images by name, sorted by name."""
        with self._lock:
            return {name: len(self._faces[name]) for name in sorted(self._faces)}

    def training(self) -> Tuple[List[np.ndarray], List[str]]:
        """Returns all faces, and the name of each."""
        faces: List[np.ndarray] = []
        names: List[str] = []
        with self._lock:
            for name, theirs in self._faces.items():
                faces += theirs.values()
                names += [name] * len(theirs)
        return faces, names

    def add(self, name: str, images: Mapping[str, np.ndarray]) -> Added:
        """Adds the images of a person that show a face; if one cannot be written, adds none.

        Args:
            name: A known or a new name.
            images: Images, (height, width, 3) BGR, uint8, by the names for error messages.

        Raises:
            ValueError: The name is not allowed.
            OSError: The images cannot be written.
        """
        name = valid_name(name)
        candidates = Candidates()
        candidates.offer(images)
        return self._keep(name, candidates)

    def import_folder(
        self, folder: str, name: str = "", given_up: Callable[[], Any] = lambda: False
    ) -> Added:
        """Adds a portrait of the largest face in each image file of a folder.

        Args:
            folder: The folder, whose files are not changed.
            name: The name of the person in the images. If it is empty, the folder has a subfolder
                for each person, named after that person.
            given_up: A function that is asked before each image whether to stop.

        Raises:
            ValueError: The name is not allowed, or the folder is inside the gallery, or it has no
                subfolders although no name is given.
            OSError: The folder cannot be read; or a name is given, and the gallery cannot be
                written.
            InterruptedError: `given_up` returned a true value; people who were complete by then
                have been added.
        """
        if name:
            return self._import_images(name, folder, given_up)
        self._check_source(folder)
        total = Added()
        found = [name for name in entries(folder) if not name.startswith(".")]
        people = [name for name in found if os.path.isdir(os.path.join(folder, name))]
        if not people:
            raise ValueError(
                f"{shown(folder)} must have a folder for each person, as Anna/1.jpg; "
                "to take its own images, say whose they are by name"
            )
        nobodys = sum(map(is_image_file, found))
        if nobodys:
            total.problems.append(f"{shown(folder)}: {nobodys} images in no person's folder")
        for person in people:
            path = os.path.join(folder, person)
            try:
                added = self._import_images(person, path, given_up)
            except InterruptedError:
                raise
            except (OSError, ValueError) as error:  # The others may be better.
                total.problems.append(f"{shown(path)}: {error}")
                continue
            total.pictures += added.pictures
            total.present += added.present
            total.problems += added.problems
        return total

    def forget(self, name: str) -> Removed:
        """Removes a person's images, including damaged ones; other files in the folder stay.

        Images that were never completed, because of a crash, are removed as well.

        Raises:
            ValueError: Nobody has this name.
            OSError: The folder cannot be read.
        """
        name = valid_name(name)
        with self._lock:
            folder = self._folder(name)
            if not os.path.isdir(folder) and name not in self._faces:
                raise ValueError(f"nobody is called '{name}'")
            paths, unfinished = [], []
            if os.path.isdir(folder):
                paths = image_paths(folder)
                unfinished = left_over(folder, r"\.\d+") + left_over(self.folder, re.escape(CACHE))
            removed = Removed()
            for path in paths:
                removed.pictures += _removed(path, removed.problems)
            for path in unfinished:
                _removed(path, removed.problems)
            left = self._load_faces(name, self._by_digest(), []) if removed.problems else {}
            self._faces.pop(name, None)
            if left:
                self._faces[name] = left
            with contextlib.suppress(OSError):  # The folder may contain other files.
                os.rmdir(folder)
            removed.problems += self._save_or_remove()
            return removed

    def _load_faces(
        self, name: str, cached: Mapping[str, np.ndarray], problems: List[str]
    ) -> Dict[str, np.ndarray]:
        """Returns the faces of a person by the digests of their images."""
        faces: Dict[str, np.ndarray] = {}
        folder = self._folder(name)
        try:
            paths = image_paths(folder)
        except OSError as error:
            problems.append(f"{shown(folder)} is not used: {reason(error)}")
            return {}
        for path in paths:
            try:
                data = read_file(inside(self.folder, path), MAX_FILE)
                digest = digest_of(data)
                faces[digest] = cached[digest] if digest in cached else face_of(upright(data))
            except (OSError, ValueError) as error:
                problems.append(f"{shown(path)} is not used: {reason(error)}")
        return faces

    def _import_images(self, name: str, folder: str, given_up: Callable[[], Any]) -> Added:
        name = valid_name(name)
        self._check_source(folder)
        candidates = Candidates()
        candidates.read(folder, given_up)
        if not candidates.files and not candidates.problems:
            candidates.problems.append(f"{shown(folder)}: there are no images in it")
        return self._keep(name, candidates)

    def _check_source(self, folder: str) -> None:
        """Raises ValueError if a folder is in the gallery: its portraits must not be cut again."""
        root = os.path.realpath(self.folder)
        if os.path.commonpath([root, os.path.realpath(folder)]) == root:
            raise ValueError(f"{shown(folder)} is in the gallery")

    def _keep(self, name: str, candidates: Candidates) -> Added:
        """Adds images that are new; if one file cannot be written, adds none."""
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
        """Writes the cache of faces; returns problems, which only cost time at the next start."""
        try:
            write_faces(self._cache(), self._by_digest())
        except (OSError, ValueError) as error:
            return [f"{CACHE} cannot be written, the next start takes longer: {reason(error)}"]
        return []

    def _save_or_remove(self) -> List[str]:
        """Writes the cache without the removed faces; if that fails, removes the whole cache."""
        problems = self._save()
        if problems:
            try:
                with contextlib.suppress(FileNotFoundError):
                    os.unlink(os.path.join(self.folder, CACHE))
            except OSError as error:
                return [f"{CACHE} still holds the faces, and cannot be removed: {reason(error)}"]
        return problems
