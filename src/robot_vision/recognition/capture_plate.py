"""The plate that an object is captured on: where it is, by the tags around the object."""

from typing import Any, Dict, NamedTuple, Optional, Sequence

import numpy as np

from .. import Bundle
from ..common.errors import about
from ..common.files import MAX_TEXT, read_file
from ..common.plain_text import brief, printable
from ..common.yaml_text import load_yaml
from ..tags.bundle_files import parse_bundles

MAX_PLANE_ERROR = 0.005  # m, of a tag from the plane of the plate
MIN_RADIUS = 0.02  # m, of the place for an object
MIN_LEVEL = 0.1  # cosine of the plate's tilt in the bundle's frame, where x and y tell a place
SQUARE = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]])


class PlateBundle(NamedTuple):
    """The tags on a plate.

    Attributes:
        bundle: Where they are.
        family: Theirs.
        entry: The bundle as it is in a file, with the family.
    """

    bundle: Bundle
    family: str
    entry: Dict[str, Any]


class Plate(NamedTuple):
    """Where objects stand.

    Attributes:
        tags: The tags on it.
        frame: 4x4, of the plate's frame in that of the bundle, m: z is up, and the origin is where
            the middle of the object is to be.
        radius: m, of the place for the object.
    """

    tags: PlateBundle
    frame: np.ndarray
    radius: float


def read_plate_bundle(path: str, name: str, family: str) -> PlateBundle:
    """Reads the bundle of a file, as calibrate_bundle.py writes it.

    Args:
        path: The file.
        name: Which one of several bundles, or "".
        family: Of the tags if the file does not name it.

    Raises:
        OSError: The file cannot be read.
        ValueError: It has no such bundle.
    """
    text = read_file(path, MAX_TEXT).decode(errors="replace")
    with about(path):
        values = load_yaml(text)
        entries = values.get("tag_bundles") if isinstance(values, dict) else None
        if entries is None:
            raise ValueError("there are no tag_bundles in it, as calibrate_bundle.py writes them")
        bundles = parse_bundles(entries)
        there = ", ".join(bundle.name for bundle in bundles)
        chosen = [i for i, one in enumerate(bundles) if name in ("", one.name)]
        if len(chosen) != 1:
            wanted = f"none of the name '{printable(name)}'" if name else "not one of them"
            raise ValueError(f"its bundles are {there or 'none'}: {wanted} is meant")
        found = entries[chosen[0]].get("family", family)
        if not isinstance(found, str):
            raise ValueError(f"family is {brief(found)}, must be a name")
        entry = {**entries[chosen[0]], "family": found}
        return PlateBundle(bundles[chosen[0]], found, entry)


def plate_of(
    tags: PlateBundle, center: Optional[Sequence[float]] = None, radius: Optional[float] = None
) -> Plate:
    """Returns the plate whose tags these are.

    Args:
        tags: The tags, which are on its upper side.
        center: (x, y), m, of the middle in the bundle's frame; None: in the middle of the tags.
        radius: m, of the place for the object; None: up to the nearest tag.

    Raises:
        ValueError: The tags are on no plane, there is no place between them, or x and y tell none,
            as the plate is upright in the bundle's frame.
    """
    corners = np.array(
        [tag.size * SQUARE @ tag.pose[:3, :3].T + tag.pose[:3, 3] for tag in tags.bundle.tags]
    )
    up = np.mean([tag.pose[:3, 2] for tag in tags.bundle.tags], axis=0)
    frame = _plane(corners.reshape(-1, 3), up)
    if center is not None:
        frame[:3, 3] = _below(frame, center)
    apart = (corners - frame[:3, 3]) @ frame[:3, :3]
    free = min(_distance_to(square[:, :2]) for square in apart)
    if radius is None and free < MIN_RADIUS:
        raise ValueError(
            f"bundle '{tags.bundle.name}': a tag is {1000.0 * free:.0f} mm from the middle; where "
            "the object stands must be told: center and radius"
        )
    return Plate(tags, frame, free if radius is None else radius)


def _plane(points: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Returns the frame in the middle of points of a plane, whose z axis is up."""
    middle = points.mean(axis=0)
    normal = np.linalg.svd(points - middle)[2][2]
    normal *= np.sign(normal @ up) or 1.0
    error = np.abs((points - middle) @ normal).max()
    if error > MAX_PLANE_ERROR:
        raise ValueError(
            f"the tags are up to {1000.0 * error:.0f} mm from the plane of all of them, must be on "
            f"the upper side of a plate, within {1000.0 * MAX_PLANE_ERROR:.0f} mm"
        )
    along = np.array([1.0, 0.0, 0.0]) if abs(normal[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    x = along - (along @ normal) * normal
    x /= np.linalg.norm(x)
    frame = np.eye(4)
    frame[:3, :3] = np.column_stack([x, np.cross(normal, x), normal])
    frame[:3, 3] = middle
    return frame


def _below(frame: np.ndarray, center: Sequence[float]) -> np.ndarray:
    """Returns the point of the plane with these x and y in the bundle's frame."""
    middle, normal = frame[:3, 3], frame[:3, 2]
    if abs(normal[2]) < MIN_LEVEL:
        raise ValueError(
            "center tells no place on the plate, which is upright in the bundle's frame"
        )
    away = np.asarray(center) - middle[:2]
    return np.array([*center, middle[2] - (away @ normal[:2]) / normal[2]])


def _distance_to(square: np.ndarray) -> float:
    """Returns how far the origin is from a square, (4, 2); 0 if it is within."""
    sides = np.roll(square, -1, axis=0) - square
    across = square[:, 0] * sides[:, 1] - square[:, 1] * sides[:, 0]
    if (across > 0.0).all() or (across < 0.0).all():
        return 0.0
    shares = np.clip(-(square * sides).sum(axis=1) / (sides**2).sum(axis=1), 0.0, 1.0)
    return float(np.linalg.norm(square + shares[:, None] * sides, axis=1).min())
