"""Where detections are, by the depth image that belongs to them."""

import math
from typing import Any, Dict, Optional

import numpy as np
from geometry_msgs.msg import Vector3

from .. import LocatedRegion, RegionLocator
from ..common.plain_text import printable
from ..msg import Detection, Detection3D, DetectionArray
from ..ros.messages import clipped_box
from ..ros.transport import Frame
from .places import at_position


def located(
    locator: RegionLocator, image: np.ndarray, detection: Detection
) -> Optional[LocatedRegion]:
    """Returns where a detection is; None if it has too few depths.

    Raises:
        ValueError: The detection is not in the image, or not finite.
    """
    if not math.isfinite(detection.score):
        raise ValueError(f"the score is {detection.score}, must be finite")
    return locator.locate(image, **region_of_interest(detection))


def region_of_interest(detection: Detection) -> Dict[str, Any]:
    """Returns the arguments of RegionLocator.locate() for a detection.

    A centre that is outside of the box was left at 0: that of the box takes its place.
    """
    x, y, width, height = box = clipped_box(detection.box)
    center, radius = detection.center, detection.circle_radius
    if radius > 0.0:
        center = detection.circle_center
    outside = center.x < x - 1 or center.y < y - 1 or center.x > x + width or center.y > y + height
    outline = [(point.x, point.y) for point in detection.outline]
    return {
        "box": box,
        "outline": np.array(outline) if outline else None,
        "center": None if outside else (center.x, center.y),
        "radius": radius,
    }


def detection_3d(detection: Detection, found: LocatedRegion, frame_id: str) -> Detection3D:
    """Returns a detection with its place."""
    return Detection3D(
        label=detection.label,
        id=detection.id,
        score=detection.score,
        box=detection.box,
        frame_id=frame_id,
        pose=at_position(found.position, found.covariance),
        size=Vector3(*found.size.tolist()),
        pixels=found.pixels,
    )


def misfit(detections: DetectionArray, depth: Frame, camera_frame: str) -> str:
    """Returns why a depth image does not belong to detections, as a part of a line; "": it does.

    Args:
        camera_frame: The frame_id of the depth's camera_info.
    """
    height, width = depth.image.shape[:2]
    if (detections.width, detections.height) != (width, height):
        return (
            f"the detections are of an image of {detections.width}x{detections.height}, the depth "
            f"of {width}x{height}"
        )
    frames = detections.header.frame_id, depth.header.frame_id, camera_frame
    if len({name.lstrip("/") for name in frames if name}) > 1:
        one, other, third = map(printable, frames)
        return (
            f"the detections are in the frame '{one}', the depth in '{other}', its camera_info in "
            f"'{third}'"
        )
    return ""
