"""A coarse mesh of an object by its observations, so that methods that need one know it, too."""

from typing import List

import numpy as np

from .. import DepthVolume
from ..common.errors import about
from ..meshes import mesh_extent
from ..meshes.mesh_files import ply_of
from .database import Database, Mesh, Object
from .mesh_data import pack_mesh
from .observed_views import ObservationSource, Seen, extent_of, seen_by

CAPTURED = "captured.ply"  # the name of a mesh that was made here, which no other one has
MAX_VIEWS = 120  # that are used of an object, those that are spread best
CELLS = 100  # voxels along the longest side
MIN_VOXEL = 0.0015  # m; what is smaller is less than depth cameras tell
MARGIN = 4  # voxels around the object


def wants_mesh(database: Database, object_id: str) -> bool:
    """Returns whether an object has no mesh but one that was made of observations."""
    entry = database.meshes.entry(object_id)
    return entry is None or entry.file_name == CAPTURED


def forget_mesh(database: Database, object_id: str) -> None:
    """Deletes, within a transaction, a mesh that was made of observations which are no more."""
    if wants_mesh(database, object_id):
        database.meshes.delete(object_id)


def make_mesh(database: Database, one: Object, floor: float) -> str:
    """Makes a mesh of an object's observations, stores it, and returns what there is to say.

    A mesh that somebody has given the object meanwhile stays.

    Args:
        database: The database.
        one: The object.
        floor: m above the plate, below which depths may be the plate's.

    Raises:
        OSError: The database cannot be written.
        ValueError: There are no observations that show a surface.
    """
    source = ObservationSource(database, one.id)
    chosen = source.spread(MAX_VIEWS)
    with about(f"'{one.name}'"):
        mesh = _mesh_of(source, chosen, floor)
    size = np.asarray(mesh_extent(mesh).size)
    stored = Mesh(CAPTURED, ply_of(mesh), pack_mesh(mesh))
    with database.transaction():
        if not wants_mesh(database, one.id):
            return f"'{one.name}' was given a mesh meanwhile, which stays"
        database.meshes.set(one.id, stored)
    sides = " x ".join(f"{1000.0 * side:.0f}" for side in size)
    return f"a mesh of {sides} mm, of {len(mesh.triangles)} triangles, by {len(chosen)} views"


def _mesh_of(source: ObservationSource, chosen: List[str], floor: float) -> object:
    center, size = extent_of(source.of(one) for one in chosen)
    voxel = max(float(size.max()) / CELLS, MIN_VOXEL)
    low, high = (center + sign * size / 2.0 + sign * MARGIN * voxel for sign in (-1.0, 1.0))
    low[2] = 0.0  # It stands on the plate.
    volume = DepthVolume(low, high, voxel, floor)
    for number in chosen:
        seen: Seen = seen_by(source.of(number))
        volume.add(seen.image, seen.depth, seen.mask, seen.camera, seen.pose)
    return volume.mesh()
