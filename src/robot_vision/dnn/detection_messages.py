"""What a network found in an image as Detections."""

from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np
from geometry_msgs.msg import Point, Point32, Vector3

from .. import BoxTrack, FoundObject, RegionFinder, RegionParams, box_pixels
from ..msg import Detection
from ..ros.messages import corners, points, region_of

CENTER = 0.5  # px from the corner of a pixel, where the core counts from, to its centre, as here
MASK_PARTS = RegionParams()
MASK_PARTS.min_area, MASK_PARTS.opening, MASK_PARTS.closing = 0.0, 1, 1  # as the network has it


class Seen(NamedTuple):
    """A thing in a frame: found in it by the network, followed to it from another, or both."""

    label: str
    class_id: int
    score: float
    box: Tuple[float, float, float, float]  # left, top, right, bottom, px from the image's corner
    found: Optional[FoundObject] = None  # None: it was not found in this frame
    track: Optional[BoxTrack] = None  # None: it is not followed


def seen_object(found: FoundObject, label: str) -> Seen:
    """Returns what was found in a frame, with the name of its class."""
    return Seen(label, found.class_id, found.score, found.box, found)


def seen_track(track: BoxTrack, found: Sequence[FoundObject], label: str, score: float) -> Seen:
    """Returns what is followed in a frame.

    What was found in it has the network's box, which the track has smoothed.

    Args:
        track: The track.
        found: All that was found in the frame, of which the track has the number.
        label: The name of its class.
        score: That of the track, for where the network has not found it in the frame.
    """
    if track.detection < 0:  # Also of a frame with the stamp of the one that it was seen in.
        return Seen(label, track.class_id, score, track.box, None, track)
    one = found[track.detection]
    return Seen(label, track.class_id, one.score, one.box, one, track)


def object_detection(seen: Seen, size: Tuple[int, int]) -> Detection:
    """Returns a thing in an image of (width, height) px as a Detection."""
    left, top, right, bottom = seen.box
    box = pixels_of(seen.box, size)
    message = Detection(
        label=seen.label,
        id=-1,
        score=seen.score,
        box=region_of(box),
        center=Point((left + right) / 2.0 - CENTER, (top + bottom) / 2.0 - CENTER, 0.0),
        outline=points(corners(box)),
        area=box[2] * box[3],
        class_id=seen.class_id,
    )
    if seen.found is not None:
        _add_details(message, seen.found)
    if seen.track is not None:
        message.id = seen.track.id
        message.predicted = seen.track.predicted
        message.has_velocity = True
        message.velocity = Vector3(*seen.track.velocity, 0.0)
    return message


def pixels_of(
    box: Tuple[float, float, float, float], size: Tuple[int, int]
) -> Tuple[int, int, int, int]:
    """Returns x, y, width and height of the pixels of an image that a box covers, also in part."""
    x, y, width, height = box_pixels(box)
    left, top = min(max(x, 0), size[0]), min(max(y, 0), size[1])
    right, bottom = min(x + width, size[0]), min(y + height, size[1])
    return left, top, max(right - left, 0), max(bottom - top, 0)


def _add_details(message: Detection, found: FoundObject) -> None:
    """Adds the outline of a box that is turned, the mask with its outline, and the keypoints."""
    if len(found.outline):
        x, y = found.center  # which is not that of its box, if it reaches out of the image
        message.center = Point(x - CENTER, y - CENTER, 0.0)
        message.outline = points(found.outline - CENTER)
        message.area = float(np.prod(np.linalg.norm(np.diff(found.outline[:3], axis=0), axis=1)))
    if found.mask.size:
        x, y, width, height = found.box_pixels
        message.box = region_of((x, y, width, height))
        message.mask = found.mask.tobytes()
        message.area = np.count_nonzero(found.mask)
        _, parts = RegionFinder(MASK_PARTS).apply(found.mask)
        message.outline = points(parts[0].outline + np.array((x, y))) if parts else []
    message.keypoints = [
        Point32(x - CENTER, y - CENTER, score) for x, y, score in found.keypoints.tolist()
    ]
