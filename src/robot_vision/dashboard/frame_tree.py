"""Where frames are to each other by what was said last, and their poses in one of them."""

import math
from typing import Any, Dict, List, NamedTuple, Sequence, Tuple

from ..common.plain_text import is_name

MAX_FRAMES = 2000
Vector = Tuple[float, float, float]
Quaternion = Tuple[float, float, float, float]  # x, y, z, w


class Pose(NamedTuple):
    """Where a frame is in another one: m, and a quaternion of length 1."""

    position: Vector
    orientation: Quaternion


class Link(NamedTuple):
    """A frame's parent, and its pose there."""

    parent: str
    pose: Pose


ORIGIN = Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def rotated(by: Quaternion, vector: Vector) -> Vector:
    """Returns a vector turned by a unit quaternion."""
    x, y, z, w = by
    vx, vy, vz = vector
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    return (
        vx + w * tx + y * tz - z * ty,
        vy + w * ty + z * tx - x * tz,
        vz + w * tz + x * ty - y * tx,
    )


def joined(first: Pose, second: Pose) -> Pose:
    """Returns the pose in the frame of `first` of what has the pose `second` in its frame."""
    moved = rotated(first.orientation, second.position)
    position = tuple(one + two for one, two in zip(first.position, moved))
    ax, ay, az, aw = first.orientation
    bx, by, bz, bw = second.orientation
    turned = (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )
    return Pose(position, turned)  # type: ignore[arg-type]


def inverse(pose: Pose) -> Pose:
    """Returns the pose of the other frame in this one."""
    x, y, z, w = pose.orientation
    back = (-x, -y, -z, w)
    px, py, pz = rotated(back, pose.position)
    return Pose((-px, -py, -pz), back)


class FrameTree:
    """The newest transform of each frame. It is for one thread at a time."""

    def __init__(self) -> None:
        self._links: Dict[str, Link] = {}

    def add(self, transforms: Sequence[Any]) -> bool:
        """Takes geometry_msgs/TransformStamped; returns whether one of them could be used.

        A slash that a name begins with, as in times of tf_prefix, is left out.
        """
        used = False
        for transform in transforms:
            child = transform.child_frame_id.lstrip("/")
            parent = transform.header.frame_id.lstrip("/")
            pose = _pose_of(transform.transform)
            full = child not in self._links and len(self._links) >= MAX_FRAMES
            if full or pose is None or child == parent or not (is_name(child) and is_name(parent)):
                continue
            self._links[child] = Link(parent, pose)
            used = True
        return used

    def roots(self) -> List[str]:
        """Returns the names of the frames that have no parent, the one with most frames first."""
        sizes: Dict[str, int] = {}
        for name in self._links:
            root = self._root_of(name)
            sizes[root] = sizes.get(root, 0) + 1
        return sorted(sizes, key=lambda root: (-sizes[root], root))

    def poses(self, root: str) -> List[Tuple[str, str, Pose]]:
        """Returns the names, parents and poses in `root` of all frames that hang together with it.

        The parent of a frame that has none is "".
        """
        links = self._links
        children: Dict[str, List[str]] = {}
        for name, link in links.items():
            children.setdefault(link.parent, []).append(name)
        if root not in links and root not in children:
            return []
        found = {root: ORIGIN}
        waiting = [root]
        while waiting:
            name = waiting.pop()
            if name in links and links[name].parent not in found:
                found[links[name].parent] = joined(found[name], inverse(links[name].pose))
                waiting.append(links[name].parent)
            for child in children.get(name, []):
                if child not in found:
                    found[child] = joined(found[name], links[child].pose)
                    waiting.append(child)
        return [
            (name, links[name].parent if name in links else "", pose)
            for name, pose in sorted(found.items())
        ]

    def _root_of(self, name: str) -> str:
        """Returns the first frame of a chain; of a ring the first of its names."""
        passed = []
        seen = set()
        while name in self._links and name not in seen:
            seen.add(name)
            passed.append(name)
            name = self._links[name].parent
        return min(passed[passed.index(name) :]) if name in seen else name


def _pose_of(transform: Any) -> Any:
    """Returns the pose of a geometry_msgs/Transform, or None if it is none."""
    move, turn = transform.translation, transform.rotation
    length = math.hypot(turn.x, turn.y, turn.z, turn.w)  # Squares may be too large for floats.
    position = (move.x, move.y, move.z)
    if not (all(map(math.isfinite, position)) and math.isfinite(length) and length > 1e-6):
        return None
    orientation = (turn.x / length, turn.y / length, turn.z / length, turn.w / length)
    return Pose(position, orientation)
