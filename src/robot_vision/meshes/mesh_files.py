"""Writing meshes: as PLY, STL or OBJ."""

import os
from typing import Dict

import numpy as np

from .. import Mesh
from ..common import opencv as cv2
from ..common.errors import about
from ..common.files import create_file, replace_file
from ..common.plain_text import printable

FORMATS = ("ply", "stl", "obj")


def write_mesh(path: str, mesh: Mesh, replace: bool = True) -> None:
    """Writes a mesh, in m, in the format that the suffix of the file names.

    PLY has normals and the colors of vertices, STL has only the shape. OBJ has textures as well:
    they and the materials go into files beside it, of mug.obj into mug_0.png, ... and mug.mtl.

    Args:
        path: The file.
        mesh: The mesh.
        replace: Whether files may be replaced.

    Raises:
        ValueError: The suffix is none of these.
        OSError: A file cannot be written, or is there and must not be replaced.
    """
    stem, suffix = os.path.splitext(path)
    kind = suffix[1:].lower()
    with about(printable(path)):
        if kind not in FORMATS:
            raise ValueError(f"the suffix is '{suffix}', must be .ply, .stl or .obj")
    made = {"ply": _ply, "stl": _stl, "obj": _obj}[kind](mesh, os.path.basename(stem))
    files = {os.path.join(os.path.dirname(path), name): data for name, data in made.items()}
    for name in files:
        if os.path.lexists(name) and not replace:
            raise FileExistsError(f"{name} is there already; --force replaces it")
    for name, data in files.items():
        (replace_file if replace else create_file)(name, data)


def _ply(mesh: Mesh, stem: str) -> Dict[str, bytes]:
    return {f"{stem}.ply": ply_of(mesh)}


def ply_of(mesh: Mesh, scale: float = 1.0) -> bytes:
    """Returns a mesh, `scale` times as large, as a PLY file with normals and colors of vertices."""
    columns = [("x", "f4"), ("y", "f4"), ("z", "f4")]
    parts = [mesh.vertices * np.float32(scale)]
    if len(mesh.normals):
        columns += [("nx", "f4"), ("ny", "f4"), ("nz", "f4")]
        parts.append(mesh.normals)
    columns += [("red", "u1"), ("green", "u1"), ("blue", "u1")]
    parts.append(_vertex_colors(mesh)[:, ::-1])
    vertices = np.empty(len(mesh.vertices), [(name, f"<{kind}") for name, kind in columns])
    for (name, _), values in zip(columns, np.hstack(parts).T):
        vertices[name] = values
    faces = np.empty(len(mesh.triangles), [("count", "u1"), ("vertices", "<i4", 3)])
    faces["count"] = 3
    faces["vertices"] = mesh.triangles
    words = {"f4": "float", "u1": "uchar"}
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    header += [f"property {words[kind]} {name}" for name, kind in columns]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    text = "\n".join(header) + "\n"
    return text.encode() + vertices.tobytes() + faces.tobytes()


def _vertex_colors(mesh: Mesh) -> np.ndarray:
    """(n, 3) uint8, BGR; of vertices with a texture what it has at their place."""
    colors = (
        mesh.colors if len(mesh.colors) else np.tile(np.uint8(mesh.color), (len(mesh.vertices), 1))
    )
    for index, texture in enumerate(mesh.textures):
        used = np.unique(mesh.triangles[mesh.triangle_textures == index])
        size = np.array([texture.shape[1], texture.shape[0]])
        at = (_within_texture(mesh.texture_coordinates[used]) * size).astype(int)
        at = np.clip(at, 0, size - 1)
        colors[used] = texture[at[:, 1], at[:, 0]]
    return colors


def _within_texture(coordinates: np.ndarray) -> np.ndarray:
    """Returns texture coordinates, of textures that repeat, as those of the first: from 0 to 1.

    The far border stays one, as the vertices there are of what is before it.
    """
    inside = coordinates - np.floor(coordinates)
    return np.where((inside == 0.0) & (coordinates > 0.0), 1.0, inside)


def _stl(mesh: Mesh, stem: str) -> Dict[str, bytes]:
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    kind = [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
    triangles = np.zeros(len(corners), kind)
    triangles["normal"] = normals
    triangles["corners"] = corners
    header = b"a mesh of robot_vision, in m".ljust(80, b"\0")
    return {f"{stem}.stl": header + np.uint32(len(corners)).tobytes() + triangles.tobytes()}


def _obj(mesh: Mesh, stem: str) -> Dict[str, bytes]:
    lines = [f"mtllib {stem}.mtl"]
    for vertex, color in zip(mesh.vertices, _vertex_colors(mesh)[:, ::-1] / 255.0):
        lines.append("v " + " ".join(f"{x:.9g}" for x in [*vertex, *color]))
    lines += [f"vt {u:.7g} {1.0 - v:.7g}" for u, v in mesh.texture_coordinates]
    lines += ["vn " + " ".join(f"{x:.6f}" for x in normal) for normal in mesh.normals]
    numbers = "{0}/{0}" if len(mesh.texture_coordinates) else "{0}/" if len(mesh.normals) else "{0}"
    numbers += "/{0}" if len(mesh.normals) else ""
    textures = mesh.triangle_textures if len(mesh.triangle_textures) else [-1] * len(mesh.triangles)
    material = None
    for triangle, texture in zip(mesh.triangles, textures):
        if texture != material:
            material = texture
            lines.append("usemtl " + ("plain" if texture < 0 else f"texture_{texture}"))
        lines.append("f " + " ".join(numbers.format(vertex + 1) for vertex in triangle))
    files = {  # the mesh comes last, when all is there that it needs
        f"{stem}_{index}.png": cv2.imencode(".png", texture)[1].tobytes()
        for index, texture in enumerate(mesh.textures)
    }
    files[f"{stem}.mtl"] = _materials(mesh, stem)
    files[f"{stem}.obj"] = ("\n".join(lines) + "\n").encode()
    return files


def _materials(mesh: Mesh, stem: str) -> bytes:
    red, green, blue = (value / 255.0 for value in reversed(mesh.color))
    lines = ["newmtl plain", f"Kd {red:.4f} {green:.4f} {blue:.4f}"]
    for index in range(len(mesh.textures)):
        # Without ./ a name that begins as an option of map_Kd, or with a blank, would be no name.
        lines += [f"newmtl texture_{index}", "Kd 1 1 1", f"map_Kd ./{stem}_{index}.png"]
    return ("\n".join(lines) + "\n").encode()
