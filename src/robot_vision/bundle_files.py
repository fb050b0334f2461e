"""Bundles in YAML files, laid out as apriltag_ros has them.

    tag_bundles:
      - name: box
        layout:
          - {id: 0, size: 0.1, x: 0.0, y: 0.0, z: 0.0, qw: 1.0, qx: 0.0, qy: 0.0, qz: 0.0}

Positions are in m; what is left out of a pose is 0, and qw 1. A bundle may say its family.
"""

import numbers
from typing import Any, List, Mapping, Optional, Sequence

import numpy as np
import yaml

from ._core import Bundle, BundleTag
from .files import replace_file
from .rotations import quaternion_of, rotation_of

DEFAULTS = {"x": 0.0, "y": 0.0, "z": 0.0, "qw": 1.0, "qx": 0.0, "qy": 0.0, "qz": 0.0}


def write_bundles(path: str, bundles: Sequence[Bundle], family: Optional[str] = None) -> None:
    """Writes a file, or replaces it, in one step or not at all.

    Args:
        family: of the tags; None: it is not in the file.

    Raises:
        OSError: it cannot be written.
    """
    lines = ["tag_bundles:"]
    for bundle in bundles:
        name = yaml.safe_dump(bundle.name, default_style='"', width=1000).strip()
        lines += [f"  - name: {name}"] + ([f"    family: {family}"] if family else [])
        lines += ["    layout:"]
        lines += [f"      - {_line(tag)}" for tag in bundle.tags]
    replace_file(path, ("\n".join(lines) + "\n").encode())


def read_bundles(path: str) -> List[Bundle]:
    """The bundles of a file.

    Raises:
        ValueError: it is not such a file; says what is wrong, and where.
        OSError: it cannot be read.
    """
    with open(path, encoding="utf-8") as file:
        try:
            values = yaml.safe_load(file)
        except (UnicodeDecodeError, yaml.YAMLError) as error:
            raise ValueError(f"{path}: no valid YAML: {error}") from None
    if not isinstance(values, dict) or "tag_bundles" not in values:
        raise ValueError(f"{path}: there is no tag_bundles")
    try:
        return parse_bundles(values["tag_bundles"])
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def parse_bundles(values: Any) -> List[Bundle]:
    """The bundles of what is below tag_bundles, in a file or on the parameter server.

    Raises:
        ValueError: they are none; says what is wrong, and where.
    """
    bundles: List[Bundle] = []
    for index, value in enumerate(_list_of(values, "tag_bundles")):
        if not isinstance(value, dict):
            raise ValueError(f"tag_bundles[{index}] is {value!r}, must be a map")
        name = str(value.get("name", f"bundle_{index}"))
        if any(bundle.name == name for bundle in bundles):
            raise ValueError(f"tag_bundles: '{name}' is there twice")
        where = f"layout of bundle '{name}'"
        layout = _list_of(value.get("layout"), where)
        bundles.append(Bundle(name, [_tag(entry, where) for entry in layout]))
    return bundles


def _line(tag: BundleTag) -> str:
    x, y, z = tag.pose[:3, 3]
    qx, qy, qz, qw = quaternion_of(tag.pose[:3, :3])
    place = ", ".join(f"{key}: {value:.6f}" for key, value in zip("xyz", (x, y, z)))
    turn = f"qw: {qw:.8f}, qx: {qx:.8f}, qy: {qy:.8f}, qz: {qz:.8f}"
    return f"{{id: {tag.id}, size: {tag.size!r}, {place}, {turn}}}"


def _list_of(value: Any, where: str) -> List[Any]:
    if not isinstance(value, list):
        raise ValueError(f"{where} is {value!r}, must be a list")
    return value


def _tag(entry: Any, where: str) -> BundleTag:
    if not isinstance(entry, dict):
        raise ValueError(f"{where} has {entry!r}, must have maps")
    tag = entry.get("id")
    if not isinstance(tag, int) or isinstance(tag, bool):
        raise ValueError(f"{where}: id is {tag!r}, must be a whole number")
    where = f"{where}, tag {tag}"
    numbers_of = {key: _number(entry, key, where) for key in ("size", *DEFAULTS)}
    quaternion = np.array([numbers_of[key] for key in ("qx", "qy", "qz", "qw")])
    if not 0.5 < np.linalg.norm(quaternion) < 2.0:
        raise ValueError(f"{where}: qx, qy, qz, qw are {quaternion.tolist()}, must have length 1")
    pose = np.eye(4)
    pose[:3, :3] = rotation_of(quaternion)
    pose[:3, 3] = [numbers_of[key] for key in "xyz"]
    return BundleTag(tag, numbers_of["size"], pose)


def _number(entry: Mapping[str, Any], key: str, where: str) -> float:
    value = entry.get(key, DEFAULTS.get(key))
    if not isinstance(value, numbers.Real) or isinstance(value, bool) or not np.isfinite(value):
        raise ValueError(f"{where}: {key} is {value!r}, must be a number")
    return float(value)
