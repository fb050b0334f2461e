"""Mesh files as the database takes them: read, measured, and with the files that they name."""

import itertools
import os
import re
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence
from urllib.parse import unquote

import numpy as np

from .. import Mesh
from ..common.files import MAX_IMAGE, read_file
from ..meshes import mesh_extent, read_mesh
from .captured_mesh import CAPTURED
from .database import Mesh as StoredMesh
from .database import Symmetry
from .database.folder_files import MAX_DATA, is_file_name
from .mesh_data import pack_mesh

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "inch": 0.0254}  # m
MAX_FILES = 50  # of a mesh, with itself, that are read
MAX_SCANNED = 256 << 20  # bytes of a file that are looked through: 2 million triangles have less
# What names other files: of obj, mtl, ply, gltf and dae. Nothing in it is looked for again from
# each place of what was passed, so that any file takes a time in proportion to its size.
NAMES = re.compile(
    rb"^[ \t]*(?:mtllib|(?:map_\w+|bump)"
    rb"(?:[ \t]+-\w+[ \t]+\S+(?:[ \t]+[-+.\d]+(?=[ \t])){0,2}){0,20}|comment TextureFile)"
    rb'[ \t]([^\r\n]+)|"uri"\s*:\s*"([^"]+)"|<init_from>([^<]{1,1000})</init_from>',
    re.MULTILINE,
)


class Intake(NamedTuple):
    """A mesh that was read.

    Attributes:
        stored: What goes into the database.
        notes: What there is to say of it, in lines.
    """

    stored: StoredMesh
    notes: List[str]


def take_mesh(
    path: str,
    unit: Optional[str] = None,
    symmetries: Sequence[Symmetry] = (),
    scale: float = 1.0,
    center: bool = False,
) -> Intake:
    """Reads a mesh.

    Args:
        path: The file; the files that it names are beside it.
        unit: That of the file: m, cm, mm or inch; None: it is guessed.
        symmetries: Turns that nobody can see.
        scale: By which it is made larger besides.
        center: Whether its origin is moved into its middle.

    Raises:
        OSError: A file cannot be read.
        ValueError: It is no mesh that can be used.
    """
    original = read_file(path, MAX_DATA)
    loaded = read_mesh(path, unit, scale)
    mesh, offset = loaded.mesh, np.zeros(3)
    if center:
        offset = np.asarray(mesh_extent(mesh).center)
        mesh = _moved(mesh, -offset)
    sides = " x ".join(f"{1000.0 * side:.1f}" for side in mesh_extent(mesh).size)
    notes = [loaded.unit_reason, f"it is {sides} mm, of {len(mesh.triangles)} triangles"]
    notes += loaded.warnings
    stored = StoredMesh(
        _stored_name(os.path.basename(path)),
        original,
        pack_mesh(mesh),
        files_beside(path, original, notes.append),
        UNITS[loaded.unit],
        scale,
        tuple(offset.tolist()),
        symmetries,
    )
    return Intake(stored, notes)


def _stored_name(name: str) -> str:
    """Returns a file's name, or another one if that cannot be stored, or means something else."""
    if not is_file_name(name):
        return "mesh"
    return name if name != CAPTURED else f"given_{name}"


def _moved(mesh: Mesh, offset: np.ndarray) -> Any:
    return Mesh(
        (mesh.vertices.astype(float) + offset).astype(np.float32),
        mesh.triangles,
        mesh.normals,
        mesh.colors,
        mesh.texture_coordinates,
        mesh.textures,
        mesh.triangle_textures,
        mesh.color,
    )


def files_beside(path: str, data: bytes, tell: Callable[[str], None]) -> Dict[str, bytes]:
    """Returns the files that a mesh names, and that these name, by their names without folders.

    So what is in folders below the mesh is found again beside it, where read_mesh() looks, too.

    Args:
        path: The mesh's file.
        data: What is in it.
        tell: A function that is told in a line of each file that is left out, as another one has
            its name.
    """
    folder, own = os.path.split(path)
    taken, read = {own: data}, {own}  # by their names, and by where they are
    waiting = _names_in(data)
    while waiting and len(read) < MAX_FILES:
        for place in _places(waiting.pop(0)):
            if place in read:
                break
            name = os.path.basename(place)
            if not is_file_name(name):
                continue
            try:
                content = read_file(os.path.join(folder, place), MAX_IMAGE)
            except OSError:  # It is elsewhere, or the mesh was read without it.
                continue
            read.add(place)
            if name not in taken:
                taken[name] = content
                waiting += _names_in(content)
            elif taken[name] != content:
                tell(f"{place} is left out: another file is stored as {name}")
            break
    del taken[own]
    return taken


def _places(name: str) -> List[str]:
    """Returns where a file of this name may be: below the folder of the mesh, or in it."""
    places = []
    for one in (name, unquote(name)):  # URIs have %20 for a space.
        below = os.path.normpath(one.replace("\\", "/"))
        if "\0" not in below and not os.path.isabs(below) and below.split("/")[0] != "..":
            places.append(below)
        places.append(os.path.basename(below))
    return list(dict.fromkeys(places))


def _names_in(data: bytes) -> List[str]:
    if b"\0" in data[:10000] and not data.startswith(b"ply"):  # not text
        return []
    found = itertools.islice(NAMES.finditer(data, 0, MAX_SCANNED), MAX_FILES)
    return [os.fsdecode(match[match.lastindex].strip()) for match in found]
