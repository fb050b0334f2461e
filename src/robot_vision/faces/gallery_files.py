"""Picture files below a folder for each name: which there are, read with care, and written."""

import os
import unicodedata
from typing import List, Sequence

import numpy as np

from ..common.files import add_file, read_file, reason, trying
from ..common.pictures import upright
from ..common.plain_text import printable
from .identities import UNKNOWN

SUFFIXES = (".bmp", ".jpeg", ".jpg", ".pgm", ".png", ".ppm", ".tif", ".tiff", ".webp")
MAX_NAME = 60  # characters: fits into the 255 bytes of a file system's names in any script
LONGEST_PATH = 1000  # letters that are told of it
MAX_FILE = 64 << 20  # bytes, of a picture


def valid_name(name: str) -> str:
    """A person's name, which is that of a folder, too; what reads the same is the same name.

    Raises:
        ValueError: nobody can have this name.
    """
    name = unicodedata.normalize("NFC", name)
    if not 0 < len(name) <= MAX_NAME:
        raise ValueError(f"a name of {len(name)} characters, must have 1 to {MAX_NAME}")
    if name == UNKNOWN:
        raise ValueError(f"nobody can be called '{UNKNOWN}'")
    # Control characters, those that cannot be seen, halves of characters, and what ends a line.
    forbidden = [unicodedata.category(letter) in ("Cc", "Cf", "Cs", "Zl", "Zp") for letter in name]
    if any(forbidden) or "/" in name or "\\" in name:
        raise ValueError(f"the name {name!a} must not hold /, \\, control or invisible characters")
    if name.startswith(".") or name != name.strip():
        raise ValueError(f"the name {name!r} must not begin with a dot, nor begin or end in space")
    return name


def inside(folder: str, path: str) -> str:
    """The path, if it is in the folder; ValueError if it leads out of it by symbolic links."""
    root = os.path.realpath(folder)
    if os.path.commonpath([root, os.path.realpath(path)]) != root:
        raise ValueError("it leads out of the gallery")
    return path


def folder_of(gallery: str, name: str) -> str:
    """The folder of a person's pictures in a gallery, which need not be there.

    Raises:
        ValueError: it is a link.
    """
    folder = inside(gallery, os.path.join(gallery, name))
    if os.path.islink(folder):  # to forget this name would remove another's pictures
        raise ValueError("it is a symbolic link, must be a folder")
    return folder


def names_in(gallery: str, problems: List[str]) -> List[str]:
    """The names that have a folder in a gallery; what else there is becomes a problem."""
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
            elif is_picture(name):
                raise ValueError("pictures belong into a folder with the person's name")
        except ValueError as error:
            problems.append(f"{shown(os.path.join(gallery, name))} is not used: {error}")
    return names


def is_picture(name: str) -> bool:
    """Whether a file is called as pictures are, and not hidden."""
    return name.lower().endswith(SUFFIXES) and not name.startswith(".")


def picture_files(folder: str) -> List[str]:
    """The paths of a folder's files that are called as pictures are, in order.

    Raises:
        OSError: the folder cannot be read.
    """
    return [os.path.join(folder, name) for name in entries(folder) if is_picture(name)]


def entries(folder: str) -> List[str]:
    """The names of what is in a folder, in order.

    Raises:
        OSError: it cannot be read.
    """
    with trying(shown(folder), "read"):
        return sorted(os.listdir(folder))


def read_picture(path: str) -> bytes:
    """A picture file, as it is.

    Raises:
        OSError: it is no file, too large, or cannot be read.
    """
    return read_file(path, MAX_FILE)


def decode(data: bytes) -> np.ndarray:
    """The picture of a file, (height, width, 3), BGR, upright.

    Raises:
        ValueError: it is none.
    """
    picture = upright(data)
    if picture is None:
        raise ValueError("it is damaged, or no picture")
    return picture


def write_numbered(folder: str, pngs: Sequence[bytes]) -> None:
    """Writes <folder>/<n>.png with the next free numbers: all of them, or none.

    Raises:
        OSError: they cannot be written.
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
    """A path as text for people and messages: what is no UTF-8 in it is replaced."""
    return printable(os.fsencode(path).decode(errors="replace"), LONGEST_PATH)
