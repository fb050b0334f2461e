"""What was recognized as markers for rviz: the meshes themselves, which needs no file."""

import time
from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np
import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from .. import Mesh
from ..common.plain_text import to_ascii
from ..ros.poses import pose_of
from .found import Found, KnownObject
from .marker_mesh import marker_triangles

LIFETIME = 0.5  # s for which a marker stays after its object is gone, at least
LIFE = 2.0  # the same, as multiple of the time from one image to the next
MAX_LIFETIME = 20.0  # s
MAX_SHAPES = 100  # objects whose markers are kept: of more than these some are gone
TEXT_HEIGHT = 0.03  # m
WHITE = ColorRGBA(1.0, 1.0, 1.0, 1.0)


class ObjectMarkers:
    """Makes markers of what was found; those of an object differ by their poses alone."""

    def __init__(self) -> None:
        self._shapes: Dict[str, Tuple[Mesh, Marker]] = {}  # by the ids of objects; no header
        self._last: Optional[float] = None  # s, of the last image
        self._life = LIFETIME  # s

    def note_image(self) -> None:
        """Notes that there is an image: markers stay as long as it may take until the next one."""
        now = time.monotonic()
        period = 0.0 if self._last is None else now - self._last
        self._life = min(max(LIFE * period, LIFETIME), MAX_LIFETIME)
        self._last = now

    def end(self) -> None:
        """Notes that the next image may come at any time."""
        self._last = None

    def of(self, header: Header, found: Sequence[Found]) -> MarkerArray:
        """Returns a mesh and a text for each object that was found in the last image."""
        life = rospy.Duration(self._life)
        made: List[Marker] = []
        for number, one in enumerate(found):
            for marker in (self._shape(one.object), _text(one)):
                marker.header = header
                marker.id = number
                marker.lifetime = life
                made.append(marker)
            made[-2].pose = pose_of(one.pose)
        return MarkerArray(made)

    def _shape(self, known: KnownObject) -> Marker:
        mesh, shape = self._shapes.get(known.id, (None, None))
        if mesh is not known.mesh:  # It was loaded anew.
            shape = _triangles(known)
            if len(self._shapes) >= MAX_SHAPES:
                self._shapes.clear()
            self._shapes[known.id] = known.mesh, shape
        return Marker(
            ns="meshes",
            type=Marker.TRIANGLE_LIST,
            color=WHITE,
            scale=shape.scale,
            points=shape.points,
            colors=shape.colors,
        )


def _triangles(known: KnownObject) -> Marker:
    corners, colors = marker_triangles(known.mesh)
    made = Marker()
    made.scale.x = made.scale.y = made.scale.z = 1.0
    made.points = [Point(*corner) for corner in corners.reshape(-1, 3).tolist()]
    made.colors = [ColorRGBA(red, green, blue, 1.0) for blue, green, red in colors.tolist()]
    return made


def _text(one: Found) -> Marker:
    made = Marker(type=Marker.TEXT_VIEW_FACING, color=WHITE, ns="names", text=title(one))
    made.scale.z = TEXT_HEIGHT
    above = np.ptp(one.object.corners, axis=0).max() / 2.0 + TEXT_HEIGHT
    place = np.eye(4)
    place[:3, 3] = one.middle - [0.0, above, 0.0]  # up in the image
    made.pose = pose_of(place)
    return made


def title(one: Found) -> str:
    """Returns what was found, how probable it is, and how far away, in ASCII."""
    distance = float(np.linalg.norm(one.middle))
    return f"{to_ascii(one.object.name, 40)} {one.probability:.2f}: {distance:.2f} m"
