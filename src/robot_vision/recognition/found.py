"""Objects as a node knows them, and what was found of them in an image."""

import json
import operator
from typing import Any, Dict, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .. import Mesh, ObjectShape


class KnownObject(NamedTuple):
    """An object whose model was loaded.

    Attributes:
        id: Its id in the database.
        name: Its name.
        mesh: Its mesh, m.
        shape: What poses are refined and verified by, and what draws the mesh.
        corners: (8, 3), m, the corners of the box around the mesh, in the mesh's frame.
        models: What was learned of it, by the names of methods.
        is_box: Whether it has no mesh: there is only a box around what was learned, which says
            nothing of whether it is there.
        made_of: Names and hashes of all that it was made of: what has the same is the same.
            Empty: some of it could not be used.
    """

    id: str
    name: str
    mesh: Mesh
    shape: ObjectShape
    corners: np.ndarray
    models: Dict[str, bytes]
    is_box: bool = False
    made_of: Tuple[Any, ...] = ()

    def middle_at(self, pose: np.ndarray) -> np.ndarray:
        """Returns where the middle of the box around it is in a pose, (3,), m."""
        return pose[:3, :3] @ self.corners.mean(axis=0) + pose[:3, 3]


def are_same(objects: Sequence[KnownObject], others: Sequence[KnownObject]) -> bool:
    """Returns whether two sequences have the same objects, not only equal ones."""
    return len(objects) == len(others) and all(map(operator.is_, objects, others))


class Found(NamedTuple):
    """An object that was recognized in an image.

    Attributes:
        object: Which one.
        pose: 4x4, of the object's frame, that of its mesh, in the camera's optical frame, m.
        covariance: 6x6, m and rad, with the axes of the camera's optical frame.
        probability: That it is there, 0 to 1.
    """

    object: KnownObject
    pose: np.ndarray
    covariance: np.ndarray
    probability: float

    @property
    def middle(self) -> np.ndarray:
        """(3,), m, the middle of the box around it: the origin of its mesh may be anywhere."""
        return self.object.middle_at(self.pose)


class Look(NamedTuple):
    """How an object that was found looks in the image.

    Attributes:
        box: (x, y, width, height), px, around it, within the image; all 0: it is not seen.
        depth: (height, width) of the box, float32, m, of its surface; NaN where it is not.
        bgr: (height, width, 3) of the box, uint8, how its mesh looks; None: it was not asked for.
        outline: (n, 2), px, around the largest piece of what is seen.
    """

    box: Tuple[int, int, int, int]
    depth: np.ndarray
    bgr: Optional[np.ndarray]
    outline: np.ndarray


class Limits(NamedTuple):
    """A box along the axes of the camera's optical frame, m."""

    low: Sequence[float]
    high: Sequence[float]

    def holds(self, pose: np.ndarray) -> bool:
        """Returns whether the origin of a pose is within."""
        place = pose[:3, 3]
        return bool((place >= self.low).all() and (place <= self.high).all())


def limits_of(numbers: Sequence[float]) -> Limits:
    """Returns the limits that least x, largest x, least y, ... of an action's goal are.

    Raises:
        ValueError: They are not six numbers, or hold nothing.
    """
    values = np.asarray(numbers, float)
    if values.shape != (6,) or np.isnan(values).any():
        raise ValueError(
            f"filter_limits has {len(values)} numbers, must be least x, largest x, least y, "
            "largest y, least z and largest z, in m"
        )
    low, high = values[::2], values[1::2]
    if not (low <= high).all():
        raise ValueError(f"filter_limits is {values.tolist()}: a least one is above the largest")
    return Limits(tuple(low.tolist()), tuple(high.tolist()))


def database_json(path: str) -> str:
    """Returns which database objects are of, as messages have it."""
    return json.dumps({"type": "SQLite", "root": path})
