"""The image files of a gallery, which has a folder for each name: finding, reading, writing."""

import os
import re
import unicodedata
from typing import List, Sequence

from ..common.files import add_file, reason, trying
from ..common.image_files import has_image_suffix
from ..common.plain_text import printable
from ..common.temporary_files import RANDOM
from .identities import UNKNOWN

MAX_NAME = 60  # characters, which fit into the 255 bytes of a file name in any script
MAX_PATH_LENGTH = 1000  # characters of a path in a message
MAX_FILE = 64 << 20  # bytes of an image file


def valid_name(name: str) -> str:
    """Returns a person's name in the form that names the folder; equal looking names become equal.

    Raises:
        ValueError: The name is not allowed.
    """
    name = unicodedata.normalize("NFC", name)
    if not 0 < len(name) <= MAX_NAME:
        raise ValueError(f"a name of {len(name)} characters, must have 1 to {MAX_NAME}")
    if name == UNKNOWN:
        raise ValueError(f"nobody can be called '{UNKNOWN}'")
    # Control, invisible and surrogate characters, and line separators are not allowed.
    forbidden = [unicodedata.category(letter) in ("Cc", "Cf", "Cs", "Zl", "Zp") for letter in name]
    if any(forbidden) or "/" in name or "\\" in name:
        raise ValueError(f"the name {name!a} must not hold /, \\, control or invisible characters")
    if name.startswith(".") or name != name.strip():
        raise ValueError(f"the name {name!r} must not begin with a dot, nor begin or end in space")
    return name


def inside(folder: str, path: str) -> str:
    """Returns a path unchanged; raises ValueError if it leads out of the folder by links."""
    root = os.path.realpath(folder)
    if os.path.commonpath([root, os.path.realpath(path)]) != root:
        raise ValueError("it leads out of the gallery")
    return path


def folder_of(gallery: str, name: str) -> str:
    """Returns the folder of a person's images in a gallery, which need not exist.

    Raises:
        ValueError: The folder is a symbolic link.
    """
    folder = inside(gallery, os.path.join(gallery, name))
    if os.path.islink(folder):  # Forgetting this name would remove the images of another person.
        raise ValueError("it is a symbolic link, must be a folder")
    return folder


def names_in(gallery: str, problems: List[str]) -> List[str]:
    """Returns the names that have a folder in a gallery; adds what is not usable to `problems`."""
    names = []
    try:
        found = entries(gallery) if os.path.isdir(gallery) else []
    except OSError as error:
        problems.append(f"{shown(gallery)} cannot be read: {reason(error)}")
        return []
    for name in found:
        if name.startswith("."):
            continue
        try:
            if os.path.isdir(folder_of(gallery, name)):
                if name != valid_name(name):
                    raise ValueError(f"its name must be in Unicode's form NFC, {name!a} is not")
                names.append(name)
            elif is_image_file(name):
                raise ValueError("images belong into a folder with the person's name")
        except ValueError as error:
            problems.append(f"{shown(os.path.join(gallery, name))} is not used: {error}")
    return names


def is_image_file(name: str) -> bool:
    """Returns whether a file is named like an image and is not hidden."""
    return has_image_suffix(name) and not name.startswith(".")


def image_paths(folder: str) -> List[str]:
    """Returns the sorted paths of the files in a folder that are named like images.

    Raises:
        OSError: The folder cannot be read.
    """
    return [os.path.join(folder, name) for name in entries(folder) if is_image_file(name)]


def left_over(folder: str, stem: str) -> List[str]:
    """Returns the paths of the files in a folder that a crash left before they had their names.

    Args:
        folder: The folder.
        stem: A regular expression of what such a file is named before the random part.

    Raises:
        OSError: The folder cannot be read.
    """
    pattern = re.compile(rf"{stem}\.{RANDOM}\.tmp")
    return [os.path.join(folder, name) for name in entries(folder) if pattern.fullmatch(name)]


def entries(folder: str) -> List[str]:
    """Returns the sorted names of what is in a folder.

    Raises:
        OSError: The folder cannot be read.
    """
    with trying(shown(folder), "read"):
        return sorted(os.listdir(folder))


def write_numbered(folder: str, pngs: Sequence[bytes]) -> None:
    """Writes <folder>/<n>.png for the next free numbers n: all of the files, or none.

    Raises:
        OSError: A file cannot be written.
    """
    is_new = not os.path.lexists(folder)
    with trying(shown(folder), "made"):
        os.makedirs(folder, exist_ok=True)
    stems = [os.path.splitext(name)[0] for name in entries(folder)]
    first = 1 + max((int(stem) for stem in stems if stem.isdecimal()), default=0)
    written: List[str] = []
    try:
        for number, png in enumerate(pngs, first):
            written.append(add_file(folder, str(number), ".png", png))
    except OSError:
        for path in written:
            os.unlink(path)
        if is_new:
            os.rmdir(folder)
        raise


def shown(path: str) -> str:
    """Returns a path as printable text; bytes that are not UTF-8 are replaced."""
    return printable(os.fsencode(path).decode(errors="replace"), MAX_PATH_LENGTH)
