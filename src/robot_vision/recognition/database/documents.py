"""What the database holds: documents as those of object_recognition_core."""

import datetime
import uuid
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Sequence, Tuple

import numpy as np

MAX_FOLD = 120  # of a symmetry


@dataclass
class Object:
    """An object, by its name and what people say of it.

    Attributes:
        id: 32 hexadecimal digits.
        added: When it was added, UTC, ISO 8601.
    """

    name: str
    description: str = ""
    tags: List[str] = field(default_factory=list)
    author: str = ""
    email: str = ""
    id: str = ""
    added: str = ""


@dataclass(frozen=True)
class Symmetry:
    """A turn of an object about an axis through its middle after which it looks the same.

    Attributes:
        axis: Unit vector along the axis, in the mesh's frame.
        fold: How many turns make a whole one; 0: any turn looks the same.
    """

    axis: Tuple[float, float, float]
    fold: int = 0


@dataclass
class Mesh:
    """The mesh of an object.

    Attributes:
        file_name: The name of the original file, which says of what format it is.
        original: The content of that file, as it was given.
        files: The content of the files that it names, as textures, by their names.
        unit: m, of the numbers in the file.
        scale: By which they were multiplied besides.
        offset: m, of the mesh's origin in the frame of the file, after unit and scale.
        converted: The mesh in m, as mesh_data.pack_mesh() packs it.
        symmetries: Turns after which the object looks the same.
    """

    file_name: str
    original: bytes
    converted: bytes
    files: Mapping[str, bytes] = field(default_factory=dict)
    unit: float = 1.0
    scale: float = 1.0
    offset: Tuple[float, float, float] = (0.0, 0.0, 0.0)
    symmetries: Sequence[Symmetry] = ()
    added: str = ""


@dataclass
class Session:
    """Observations of an object that belong together, as of one turn of a turntable."""

    object_id: str
    source: str = ""  # the bag or the topic that they come from
    id: str = ""
    added: str = ""


@dataclass
class Observation:
    """One look at an object.

    Attributes:
        rgb: A PNG file: the color image.
        depth: A PNG file of 16 bits: the depth of its pixels in mm, 0: none.
        mask: A PNG file: not 0 where the object is.
        matrix: (3, 3), K of the camera.
        distortion: Of the camera, as many as its model has.
        pose: (4, 4), of the object's frame in the camera's optical frame, m.
    """

    session_id: str
    frame_number: int
    rgb: bytes
    depth: bytes
    mask: bytes
    matrix: np.ndarray
    pose: np.ndarray
    distortion: Sequence[float] = ()
    id: str = ""


@dataclass
class Model:
    """What a method has learned of an object.

    Attributes:
        method: Its name, as LINEMOD.
        parameters: Those that it was trained with.
        key: The hash of all that it was made of.
        data: What the method has learned; only the method can read it.
    """

    object_id: str
    method: str
    parameters: Dict[str, Any]
    key: str
    data: bytes
    added: str = ""


def checked_symmetry(symmetry: Symmetry) -> Symmetry:
    """Returns a symmetry with an axis of length 1.

    Raises:
        ValueError: The axis has no length, or the fold is none.
    """
    length = float(np.linalg.norm(symmetry.axis))
    if not length > 0.0:
        raise ValueError(f"axis is {list(symmetry.axis)}, must have a length")
    if symmetry.fold != 0 and not 2 <= symmetry.fold <= MAX_FOLD:
        raise ValueError(f"fold is {symmetry.fold}, must be 0 (any turn), or from 2 to {MAX_FOLD}")
    axis = tuple(float(value) / length for value in symmetry.axis)
    return Symmetry(axis, symmetry.fold)


def storable(name: str) -> str:
    """Returns the name of a file as the database holds it: with "?" for bytes that are no UTF-8."""
    return name.encode(errors="replace").decode()


def new_id() -> str:
    """Returns an id that no document has yet."""
    return uuid.uuid4().hex


def now() -> str:
    """Returns the present time, UTC, ISO 8601."""
    return datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
