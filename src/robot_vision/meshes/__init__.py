"""Meshes: of files, made by formulas, drawn from any side, without ROS.

>>> from robot_vision import meshes
>>> loaded = meshes.read_mesh("coke.stl")
>>> print(loaded.unit_reason)
>>> view = meshes.MeshRenderer(loaded.mesh).render(K, pose, (0, 0, 640, 480), normals=True)
>>> meshes.write_mesh("/tmp/mug.ply", meshes.sample_mesh("mug").mesh)
"""

import os
from typing import Optional

from .. import (
    LoadedMesh,
    Mesh,
    MeshCamera,
    MeshExtent,
    MeshRenderer,
    MeshView,
    SampleMesh,
    mesh_extent,
    render_meshes,
    sample_mesh,
    sample_mesh_names,
)
from .. import read_mesh as _read_mesh
from .mesh_files import write_mesh
from .mesh_sheet import mesh_sheet

__all__ = [
    "LoadedMesh",
    "Mesh",
    "MeshCamera",
    "MeshExtent",
    "MeshRenderer",
    "MeshView",
    "SampleMesh",
    "mesh_extent",
    "mesh_sheet",
    "read_mesh",
    "render_meshes",
    "sample_mesh",
    "sample_mesh_names",
    "write_mesh",
]


def read_mesh(path: str, unit: Optional[str] = None, scale: float = 1.0) -> LoadedMesh:
    """Reads a mesh in a process of its own: stl, obj, dae, ply, gltf, glb, and what assimp knows.

    Args:
        path: The file; textures are beside it.
        unit: That of the file: m, cm, mm or inch. None: what the file says, or what makes a thing
            that one can handle.
        scale: What its numbers are multiplied by besides.

    Raises:
        ValueError: The file is no mesh that can be used, or there is no such unit or scale.
        OSError: The file cannot be read: it is not there, damaged, or takes too long.
    """
    try:
        return _read_mesh(os.fsencode(path), unit or "", scale)  # Its bytes may be no UTF-8.
    except RuntimeError as error:
        raise OSError(str(error)) from None
