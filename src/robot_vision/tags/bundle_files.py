"""Bundles of tags in YAML files, with the layout that apriltag_ros uses.

    tag_bundles:
      - name: box
        layout:
          - {id: 0, size: 0.1, x: 0.0, y: 0.0, z: 0.0, qw: 1.0, qx: 0.0, qy: 0.0, qz: 0.0}

Positions are in m. Values that are missing in a pose are 0, and 1 for qw. A bundle may name its
family. A tag may have the accuracy of its pose as standard deviations: shift_noise (m, of x, y and
z) and turn_noise (rad, about each axis).
"""

import numbers
from typing import Any, List, Mapping, Optional, Sequence

import numpy as np
import yaml

from .._core import Bundle, BundleTag
from ..common.files import create_file, replace_file
from ..common.plain_text import NAME, brief, is_name
from ..common.rotations import quaternion_of, rotation_of

DEFAULTS = {"x": 0.0, "y": 0.0, "z": 0.0, "qw": 1.0, "qx": 0.0, "qy": 0.0, "qz": 0.0}
MAX_ID = 999999999
MAX_TAG_SIZE = 100.0  # m
MAX_NUMBER = 1e7  # largest number in a pose, enough for m in the coordinates of a map
NOISES = {"shift_noise": 0.0005, "turn_noise": 0.005}  # of a layout that was measured carefully


def write_bundles(
    path: str, bundles: Sequence[Bundle], family: Optional[str] = None, replace: bool = True
) -> None:
    """Writes a file in one step or not at all.

    Args:
        path: The path of the file.
        bundles: The bundles.
        family: The family of the tags; with None it is not written.
        replace: Whether to replace an existing file.

    Raises:
        OSError: The file cannot be written.
    """
    lines = ["tag_bundles:"]
    for bundle in bundles:
        name = yaml.safe_dump(bundle.name, default_style='"', width=1000).strip()
        lines += [f"  - name: {name}"] + ([f"    family: {family}"] if family else [])
        lines += ["    layout:"]
        lines += [f"      - {_line(tag)}" for tag in bundle.tags]
    write = replace_file if replace else create_file
    write(path, ("\n".join(lines) + "\n").encode())


def parse_bundles(values: Any) -> List[Bundle]:
    """Returns the bundles in the value of tag_bundles, as the parameter server has it.

    Raises:
        ValueError: The value has another form; the message says what is wrong, and where.
    """
    bundles: List[Bundle] = []
    for index, value in enumerate(list_of(values, "tag_bundles")):
        require_map(value, f"tag_bundles[{index}]", ("name", "family", "layout"))
        name = value.get("name", f"bundle_{index}")
        if not isinstance(name, str) or not is_name(name):
            raise ValueError(f"tag_bundles[{index}]: name is {brief(name)}, must be {NAME}")
        if any(bundle.name == name for bundle in bundles):
            raise ValueError(f"tag_bundles: {brief(name)} is there twice")
        where = f"layout of bundle {brief(name)}"
        layout = list_of(value.get("layout"), where)
        bundles.append(Bundle(name, [_tag(entry, where) for entry in layout]))
    return bundles


def list_of(value: Any, where: str) -> Sequence[Any]:
    """Returns the value if it is a list.

    Raises:
        ValueError: The value is no list; the message says where.
    """
    if not isinstance(value, (list, tuple)):
        raise ValueError(f"{where} is {brief(value)}, must be a list")
    return value


def require_map(value: Any, where: str, keys: Sequence[str]) -> None:
    """Raises ValueError if the value is no map, or has other keys than these."""
    if not isinstance(value, dict):
        raise ValueError(f"{where} is {brief(value)}, must be a map")
    unknown = sorted(map(str, set(value).difference(keys)))
    if unknown:
        raise ValueError(f"{where} has {brief(unknown[0])}, must be {', '.join(keys)}")


def _line(tag: BundleTag) -> str:
    x, y, z = tag.pose[:3, 3]
    qx, qy, qz, qw = quaternion_of(tag.pose[:3, :3])
    place = ", ".join(f"{key}: {value:.6f}" for key, value in zip("xyz", (x, y, z)))
    turn = f"qw: {qw:.8f}, qx: {qx:.8f}, qy: {qy:.8f}, qz: {qz:.8f}"
    noise = f"shift_noise: {tag.shift_noise:.6f}, turn_noise: {tag.turn_noise:.5f}"
    return f"{{id: {tag.id}, size: {tag.size!r}, {place}, {turn}, {noise}}}"


def _tag(entry: Any, where: str) -> BundleTag:
    require_map(entry, f"a tag in the {where}", ("id", "size", *DEFAULTS, *NOISES))
    tag = entry.get("id")
    if not isinstance(tag, int) or isinstance(tag, bool) or abs(tag) > MAX_ID:
        raise ValueError(f"{where}: id is {brief(tag)}, must be a whole number to {MAX_ID}")
    where = f"{where}, tag {tag}"
    numbers_of = {key: _number(entry, key, where) for key in ("size", *DEFAULTS, *NOISES)}
    if numbers_of["size"] > MAX_TAG_SIZE:  # The core checks the other limits.
        size = brief(numbers_of["size"])
        raise ValueError(f"{where}: size is {size}, must be above 0 and at most {MAX_TAG_SIZE:g} m")
    quaternion = np.array([numbers_of[key] for key in ("qx", "qy", "qz", "qw")])
    if not 0.5 < np.linalg.norm(quaternion) < 2.0:
        raise ValueError(f"{where}: qx, qy, qz, qw are {quaternion.tolist()}, must have length 1")
    pose = np.eye(4)
    pose[:3, :3] = rotation_of(quaternion)
    pose[:3, 3] = [numbers_of[key] for key in "xyz"]
    return BundleTag(
        tag, numbers_of["size"], pose, numbers_of["shift_noise"], numbers_of["turn_noise"]
    )


def _number(entry: Mapping[str, Any], key: str, where: str) -> float:
    value = entry.get(key, {**DEFAULTS, **NOISES}.get(key))
    is_number = isinstance(value, numbers.Real) and not isinstance(value, bool)
    if not is_number or not -MAX_NUMBER <= value <= MAX_NUMBER:  # This is also true for NaN.
        limit = f"{MAX_NUMBER:g}"
        raise ValueError(f"{where}: {key} is {brief(value)}, must be a number to {limit}")
    return float(value)
