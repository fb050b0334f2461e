"""Contours as messages."""

from typing import Iterable, Optional, Tuple

from geometry_msgs.msg import Point, Point32

from .. import Contour
from ..msg import Contour as ContourMessage
from ..msg import ContourArray, Detection
from ..ros.messages import points, region_of
from ..ros.transport import Frame

NO_TEMPLATE = -1.0  # of a distance from the template's shape


def label_of(contour: Contour) -> str:
    """Returns "match" for the shape of the template, else the name of the contour's shape."""
    return "match" if contour.matches else contour.shape


def score_of(contour: Contour) -> float:
    """Returns how much a contour has the template's shape, 0 to 1; 1 without a template."""
    return 1.0 if contour.match is None else 1.0 / (1.0 + contour.match)


def contour_detection(contour: Contour) -> Detection:
    """Returns a contour as a Detection."""
    return Detection(
        label=label_of(contour),
        id=-1,
        score=score_of(contour),
        box=region_of(contour.box),
        center=_point(contour.center),
        outline=points(contour.outline),
        circle_center=_point(contour.circle_center),
        circle_radius=contour.circle_radius,
        area=contour.area,
    )


def contour_message(contour: Contour) -> ContourMessage:
    """Returns a contour with all that was measured."""
    rectangle, ellipse, defects = contour.rectangle, contour.ellipse, contour.defects
    message = ContourMessage(
        label=label_of(contour),
        parent=contour.parent,
        depth=contour.depth,
        hole=contour.hole,
        box=region_of(contour.box),
        center=_point(contour.center),
        outline=points(contour.outline),
        area=contour.area,
        length=contour.length,
        convex=contour.convex,
        solidity=contour.solidity,
        approximation=points(contour.approximation),
        hull=points(contour.hull),
        defect_starts=[_point32(defect.start) for defect in defects],
        defect_ends=[_point32(defect.end) for defect in defects],
        defect_points=[_point32(defect.farthest) for defect in defects],
        defect_depths=[defect.depth for defect in defects],
        circle_center=_point(contour.circle_center),
        circle_radius=contour.circle_radius,
        rectangle_center=_point(rectangle.center),
        rectangle_length=rectangle.length,
        rectangle_width=rectangle.width,
        rectangle_angle=rectangle.angle,
        has_ellipse=ellipse is not None,
        line_point=_point(contour.line_point),
        line_angle=contour.line_angle,
        hu=contour.hu,
        match_distance=NO_TEMPLATE if contour.match is None else contour.match,
        point_distance=contour.point_distance,
    )
    if ellipse is not None:
        message.ellipse_center = _point(ellipse.center)
        message.ellipse_length = ellipse.length
        message.ellipse_width = ellipse.width
        message.ellipse_angle = ellipse.angle
    return message


def contour_array(
    frame: Frame, contours: Iterable[Contour], point: Optional[Tuple[float, float]]
) -> ContourArray:
    """Returns the contours of a frame, and the point that was asked for, with the header."""
    height, width = frame.image.shape[:2]
    return ContourArray(
        header=frame.header,
        width=width,
        height=height,
        has_point=point is not None,
        point=_point(point or (0.0, 0.0)),
        contours=[contour_message(contour) for contour in contours],
    )


def _point(position: Tuple[float, float]) -> Point:
    return Point(*position, 0.0)


def _point32(position: Tuple[int, int]) -> Point32:
    return Point32(*position, 0.0)
