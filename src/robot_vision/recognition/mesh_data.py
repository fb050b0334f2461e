"""A mesh as the database holds it: an uncompressed .npz file of its arrays, textures as PNG."""

import io
import zipfile
from typing import Any, Dict

import numpy as np

from .. import Mesh
from ..common import opencv as cv2
from ..common.image_files import sensor_pixels
from ..common.plain_text import brief

MAX_ARRAYS = 300  # textures included
ARRAYS = {  # names and types of the arrays
    "vertices": np.float32,
    "triangles": np.int32,
    "normals": np.float32,
    "colors": np.uint8,
    "texture_coordinates": np.float32,
    "triangle_textures": np.int32,
    "color": np.uint8,
}
LISTS = ("triangle_textures", "color")  # the others have rows and columns
TEXTURE = "texture_"


def pack_mesh(mesh: Mesh) -> bytes:
    """Returns the bytes of a mesh, the same ones for the same mesh."""
    arrays: Dict[str, np.ndarray] = {}
    for name, kind in ARRAYS.items():
        arrays[name] = np.ascontiguousarray(getattr(mesh, name), kind)
    for index, texture in enumerate(mesh.textures):
        arrays[f"{TEXTURE}{index}"] = cv2.imencode(".png", texture)[1].ravel()
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


def unpack_mesh(data: bytes) -> Mesh:
    """Returns the mesh that pack_mesh() has packed.

    Raises:
        ValueError: The bytes are of something else, or damaged.
    """
    arrays = _arrays(data)
    missing = sorted(set(ARRAYS) - set(arrays))
    if missing:
        raise ValueError(f"it is no mesh: there are no {missing[0]}")
    for name, kind in ARRAYS.items():
        if arrays[name].dtype != kind:
            raise ValueError(f"it is no mesh: {name} are {arrays[name].dtype}")
        if arrays[name].ndim != (1 if name in LISTS else 2):
            raise ValueError(f"it is no mesh: {name} are of the shape {arrays[name].shape}")
    textures = [arrays[name] for name in sorted(_textures(arrays), key=_index)]
    try:
        return Mesh(
            *(arrays[name] for name in list(ARRAYS)[:5]),
            [sensor_pixels(texture.tobytes()) for texture in textures],
            arrays["triangle_textures"],
            tuple(arrays["color"].tolist()),
        )
    except (TypeError, RuntimeError):  # of the binding, whose text has all of the arrays
        raise ValueError("it is no mesh: an array has a length that it cannot have") from None


def _arrays(data: bytes) -> Dict[str, np.ndarray]:
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as file:
            entries = file.infolist()
            sizes = sum(entry.file_size for entry in entries)
            if len(entries) > MAX_ARRAYS or sizes > len(data):  # Compressed ones might be huge.
                raise ValueError("it has more than a mesh has")
        with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
            found = {name: arrays[name] for name in arrays.files}
    except ValueError:
        raise
    except Exception as error:  # zipfile and NumPy have many kinds
        raise ValueError(f"it is no mesh: {error}") from None
    for name, array in found.items():
        if not isinstance(array, np.ndarray):
            raise ValueError(f"it is no mesh: {brief(name)} is no array")
    return found


def _textures(arrays: Dict[str, Any]) -> Any:
    return (name for name in arrays if name.startswith(TEXTURE) and name[len(TEXTURE) :].isdigit())


def _index(name: str) -> int:
    return int(name[len(TEXTURE) :])
