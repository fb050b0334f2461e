"""Conversion of the core's results to messages."""

from typing import Iterable, List, Tuple

import numpy as np
from geometry_msgs.msg import Point, Point32
from sensor_msgs.msg import RegionOfInterest

from .. import Region
from ..msg import Detection, DetectionArray
from .transport import Frame

Box = Tuple[int, int, int, int]  # x, y, width, height in px
MAX_COORDINATE = 2**30  # px, more than any image has


def detection(region: Region, label: str, score: float = 1.0) -> Detection:
    """Returns a region of a mask as a Detection without an id."""
    return Detection(
        label=label,
        id=-1,
        score=score,
        box=region_of(region.box),
        center=Point(*region.center, 0.0),
        outline=points(region.outline),
        circle_center=Point(*region.circle_center, 0.0),
        circle_radius=region.circle_radius,
        area=region.area,
    )


def box_detection(box: Box, label: str, id: int = -1, score: float = 1.0) -> Detection:
    """Returns an upright rectangle as a Detection."""
    x, y, width, height = box
    return Detection(
        label=label,
        id=id,
        score=score,
        box=region_of(box),
        center=Point(x + (width - 1) / 2.0, y + (height - 1) / 2.0, 0.0),
        outline=points(corners(box)),
        area=width * height,
    )


def region_of(box: Box) -> RegionOfInterest:
    """Returns (x, y, width, height) in px as a region."""
    x, y, width, height = box
    return RegionOfInterest(x_offset=x, y_offset=y, width=width, height=height)


def box_of(region: RegionOfInterest) -> Box:
    """Returns a region as x, y, width and height in px."""
    return region.x_offset, region.y_offset, region.width, region.height


def clipped_box(region: RegionOfInterest) -> Box:
    """Returns (x, y, width, height) for the core, which refuses boxes outside the image."""
    return tuple(min(side, MAX_COORDINATE) for side in box_of(region))


def box_around(outline: np.ndarray, image: np.ndarray) -> RegionOfInterest:
    """Returns the part of the image that the bounding box of an outline, (n, 2) px, covers.

    A pixel counts if more of it than its edge is covered. Inside of the image there is one at least
    in each direction.
    """
    height, width = image.shape[:2]
    first = np.floor(outline.min(axis=0) + 0.5)  # Positions are from the middle of the first pixel.
    last = np.maximum(np.ceil(outline.max(axis=0) - 0.5), first)
    left, top = np.maximum(first, 0).astype(int)
    right, bottom = np.minimum(last, (width - 1, height - 1)).astype(int)
    return region_of((left, top, max(right - left + 1, 0), max(bottom - top + 1, 0)))


def corners(box: Box) -> np.ndarray:
    """Returns the corner pixels of a box, (4, 2), clockwise from the top left."""
    x, y, width, height = box
    right, bottom = x + width - 1, y + height - 1
    return np.array([(x, y), (right, y), (right, bottom), (x, bottom)])


def points(positions: np.ndarray) -> List[Point32]:
    """Returns pixel positions, (n, 2), as the points of a message.

    The constructors of the points are not called: an outline may have thousands of points, and
    these calls would take longer than processing the image.
    """
    made = []
    for x, y in positions.tolist():
        point = object.__new__(Point32)
        point.x, point.y, point.z = x, y, 0.0
        made.append(point)
    return made


def detection_array(frame: Frame, detections: Iterable[Detection]) -> DetectionArray:
    """Returns all detections of a frame as a message with the frame's header."""
    found: List[Detection] = list(detections)
    height, width = frame.image.shape[:2]
    return DetectionArray(header=frame.header, width=width, height=height, detections=found)
