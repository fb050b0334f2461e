"""Symmetries of objects, as people write them and as BOP's files have them."""

import math
from typing import Any, Dict, List, Optional, Sequence

import numpy as np

from .. import SymmetryGroup
from ..common import opencv as cv2
from ..common.plain_text import brief
from .database import Symmetry
from .database.documents import MAX_FOLD, checked_symmetry
from .database.json_values import matrix, numbers

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
FORM = "x, y or z, for any turn about it, or x:N for N turns that make a whole one"
MAX_ANGLE_ERROR = 0.01  # rad, by which an angle may not be a whole turn divided by a whole number
MAX_SHIFT = 0.03  # of the diameter, by which an axis may pass the middle of an object
MM = 0.001  # m


def parse_symmetries(text: str) -> List[Symmetry]:
    """Returns the symmetries that are meant: "z", "z:4,x:2", "none".

    Raises:
        ValueError: The text has another form, or no object has all of them.
    """
    words = [word.strip() for word in text.split(",")]
    found = [] if words == ["none"] else [_symmetry(word) for word in words]
    turns_of(found)
    return found


def turns_of(symmetries: Sequence[Symmetry]) -> List[np.ndarray]:
    """Returns the turns, 3x3, that symmetries make together, the one by nothing first.

    Of turns by any angle about an axis there is one for each way that they leave the axis.

    Raises:
        ValueError: They do not belong to one object.
    """
    return SymmetryGroup([(tuple(one.axis), one.fold) for one in symmetries]).turns


def _symmetry(word: str) -> Symmetry:
    axis, _, fold = word.partition(":")
    if axis not in AXES or (":" in word and not (fold.isdecimal() and len(fold) < 10)):
        raise ValueError(f"a symmetry is {brief(word)}, must be {FORM}, or none")
    return checked_symmetry(Symmetry(AXES[axis], int(fold or 0)))


def symmetry_text(symmetry: Symmetry) -> str:
    """Returns a symmetry as people write it."""
    names = [name for name, axis in AXES.items() if axis == tuple(symmetry.axis)]
    axis = names[0] if names else "({:.3g}, {:.3g}, {:.3g})".format(*symmetry.axis)
    return f"{axis}:{symmetry.fold}" if symmetry.fold else axis


def to_bop(symmetries: Sequence[Symmetry], middle: Sequence[float]) -> Dict[str, Any]:
    """Returns symmetries of an object as models_info.json has them, in mm.

    Args:
        symmetries: The symmetries.
        middle: m, the middle of the mesh, through which their axes go.
    """
    found: Dict[str, Any] = {}
    point = np.asarray(middle) / MM
    for one in symmetries:
        if one.fold == 0:
            entry = {"axis": list(one.axis), "offset": point.tolist()}
            found.setdefault("symmetries_continuous", []).append(entry)
    for turn in turns_of(symmetries)[1:]:  # BOP's tools do not combine them.
        made = np.eye(4)
        made[:3, :3], made[:3, 3] = turn, point - turn @ point
        found.setdefault("symmetries_discrete", []).append(made.ravel().tolist())
    return found


def from_bop(info: Dict[str, Any], middle: Sequence[float], diameter: float) -> List[Symmetry]:
    """Returns the symmetries of an entry of models_info.json.

    Args:
        info: The entry.
        middle: m, the middle of the mesh.
        diameter: m, of the mesh.

    Raises:
        ValueError: They have another form, are no turns, their axes pass the middle, or no object
            has all of them.
    """
    found: List[Symmetry] = []
    for entry in _list(info, "symmetries_continuous"):
        if not isinstance(entry, dict):
            raise ValueError(f"symmetries_continuous has {brief(entry)}, must have axis, offset")
        axis, point = np.array(numbers(entry, "axis", 3)), np.array(numbers(entry, "offset", 3))
        one = checked_symmetry(Symmetry(tuple(axis.tolist())))
        away = np.cross(MM * point - middle, one.axis)
        _require_middle(float(np.linalg.norm(away)), diameter)
        found.append(one)
    turns: List[Symmetry] = []
    for entry in _list(info, "symmetries_discrete"):
        made = matrix({"symmetries_discrete": entry}, "symmetries_discrete", 4)
        one = _turn(made)
        moved = MM * made[:3, 3] + made[:3, :3] @ middle - middle
        _require_middle(float(np.linalg.norm(moved)) / 2.0, diameter)
        if one is not None:
            turns.append(one)
    for one in sorted(turns, key=lambda one: -one.fold):
        if not _is_made_by(found, one):  # A file may have all turns that few make together.
            found.append(one)
    turns_of(found)
    return found


def _is_made_by(symmetries: Sequence[Symmetry], one: Symmetry) -> bool:
    turn = cv2.Rodrigues(np.array(one.axis) * (2.0 * math.pi / one.fold))[0]
    return any(np.abs(made - turn).max() < MAX_ANGLE_ERROR for made in turns_of(symmetries))


def _require_middle(shift: float, diameter: float) -> None:
    if shift > MAX_SHIFT * diameter:
        raise ValueError(
            f"an axis of symmetry is {1000.0 * shift:.1f} mm from the middle of the object"
        )


def _turn(made: np.ndarray) -> Optional[Symmetry]:
    """Returns the symmetry whose smallest turn a matrix is, or None if it is a larger one."""
    rotation = made[:3, :3]
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > MAX_ANGLE_ERROR:
        raise ValueError("symmetries_discrete has a matrix that is no turn")
    turn = cv2.Rodrigues(rotation)[0][:, 0]
    angle = float(np.linalg.norm(turn))
    if angle < MAX_ANGLE_ERROR:
        return None
    fold = round(2.0 * math.pi / angle)
    if fold > MAX_FOLD:
        raise ValueError(f"symmetries_discrete has a turn of {angle:.3g} rad, which is too small")
    if abs(fold * angle - 2.0 * math.pi) > fold * MAX_ANGLE_ERROR:
        return None
    axis = turn / angle
    if axis[np.argmax(np.abs(axis))] < 0.0:  # Turns to both sides are the same symmetry.
        axis = -axis
    return Symmetry(tuple((np.round(axis, 9) + 0.0).tolist()), fold)


def _list(info: Dict[str, Any], key: str) -> List[Any]:
    value = info.get(key, [])
    if not isinstance(value, list):
        raise ValueError(f"{key} is {brief(value)}, must be a list")
    return value
