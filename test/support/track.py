"""Curves on the floor, made of straights and arcs, and the exact geometry around them.

The floor has x and y; headings are counter-clockwise from x, rad. All lengths are in metres.
"""

import math
from dataclasses import dataclass
from typing import Optional, Sequence, Tuple

import numpy as np


@dataclass(frozen=True)
class Pose:
    """A position and a heading on the floor: m, m, rad."""

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0

    def along_arc(self, length: float, angle: float) -> "Pose":
        """The exact pose after an arc of `length` m that turns the heading left by `angle` rad."""
        # The chord of the arc has the heading of its middle; np.sinc(t / pi) is sin(t) / t.
        chord = length * float(np.sinc(angle / (2.0 * math.pi)))
        middle = self.heading + angle / 2.0
        return Pose(
            self.x + chord * math.cos(middle),
            self.y + chord * math.sin(middle),
            self.heading + angle,
        )


@dataclass(frozen=True)
class Segment:
    """A piece of a track: its length (m) and its turn to the left (rad), 0 if it is straight."""

    length: float
    angle: float = 0.0


class Track:
    """A curve on the floor of straights and arcs, each of which starts at the end of the last."""

    _SLACK = 1e-4  # m by which pieces overlap, so that rounding leaves no gap at a joint

    def __init__(self, segments: Sequence[Segment], start: Optional[Pose] = None) -> None:
        self.segments = tuple(segments)
        self.starts = [start or Pose()]
        for segment in self.segments:
            self.starts.append(self.starts[-1].along_arc(segment.length, segment.angle))
        self.length = sum(segment.length for segment in self.segments)

    @property
    def end(self) -> Pose:
        """The end of the last piece: if the track is closed, the start plus a full turn."""
        return self.starts[-1]

    def mirrored(self) -> "Track":
        """The track with left and right of the x axis exchanged."""
        start = self.starts[0]
        turned = [Segment(segment.length, -segment.angle) for segment in self.segments]
        return Track(turned, Pose(start.x, -start.y, -start.heading))

    def reversed(self) -> "Track":
        """The track from its end to its start."""
        turned = [Segment(segment.length, -segment.angle) for segment in self.segments[::-1]]
        return Track(turned, Pose(self.end.x, self.end.y, self.end.heading + math.pi))

    def bounds(self, margin: float) -> Tuple[float, float, float, float]:
        """The bounds of the track with `margin` around it: largest and smallest y, smallest and
        largest x, m."""
        points = [
            start.along_arc(part * segment.length, part * segment.angle)
            for start, segment in zip(self.starts, self.segments)
            for part in np.linspace(0.0, 1.0, 65)
        ]
        x, y = [point.x for point in points], [point.y for point in points]
        return max(y) + margin, min(y) - margin, min(x) - margin, max(x) + margin

    def lateral_error(self, x: float, y: float) -> float:
        """Distance (m) of a point from the track, positive on its left; NaN beyond an open end."""
        return float(self.locate(np.array([x]), np.array([y]))[0][0])

    def progress(self, x: float, y: float) -> float:
        """Length (m) of the track up to its point nearest to a point; NaN beyond an open end."""
        return float(self.locate(np.array([x]), np.array([y]))[1][0])

    def locate(
        self, x: np.ndarray, y: np.ndarray, within: float = math.inf
    ) -> Tuple[np.ndarray, np.ndarray]:
        """Lateral error and progress (m) of points; NaN beyond the ends of an open track.

        Args:
            x: (n,), m.
            y: (n,), m.
            within: points farther than this (m) from the track may be NaN, too, which is faster.
        """
        lateral, progress = np.full_like(x, np.nan), np.full_like(x, np.nan)
        middle_x, middle_y = (x.max() + x.min()) / 2.0, (y.max() + y.min()) / 2.0
        reach = math.hypot(np.ptp(x), np.ptp(y)) / 2.0 + within
        before = 0.0
        for start, segment in zip(self.starts, self.segments):
            half = start.along_arc(segment.length / 2.0, segment.angle / 2.0)
            distance = math.hypot(half.x - middle_x, half.y - middle_y)
            if distance <= reach + segment.length / 2.0:
                ahead, left = _from(start, x, y)
                at, along, off = _beside(segment, ahead, left, within)
                on_piece = (along >= -self._SLACK) & (along <= segment.length + self._SLACK)
                nearer = on_piece & ~(np.abs(off) >= np.abs(lateral[at]))  # NaN counts as far
                lateral[at[nearer]] = off[nearer]
                progress[at[nearer]] = along[nearer] + before
            before += segment.length
        return lateral, progress


def _from(start: Pose, x: np.ndarray, y: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Points in the frame of a pose: forward and left, m."""
    cos, sin = math.cos(start.heading), math.sin(start.heading)
    dx, dy = x - start.x, y - start.y
    return dx * cos + dy * sin, dy * cos - dx * sin


def _beside(
    segment: Segment, ahead: np.ndarray, left: np.ndarray, within: float
) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points within a distance of the line or circle that a segment is part of.

    Returns:
        Their indices, and their distances along the curve and to the left of it, m.
    """
    if segment.angle == 0.0:
        at = np.flatnonzero(np.abs(left) <= within)
        return at, ahead[at], left[at]
    side = math.copysign(1.0, segment.angle)
    radius = segment.length / abs(segment.angle)
    inward = radius - side * left  # component of the vector from the point to the centre
    off = side * (radius - np.sqrt(ahead * ahead + inward * inward))
    at = np.flatnonzero(np.abs(off) <= within)
    turned = np.arctan2(ahead[at], inward[at])
    # The rest of the circle is split in two: one half counts as ahead, the other as behind.
    turned[turned < abs(segment.angle) / 2.0 - math.pi] += 2.0 * math.pi
    return at, turned * radius, off[at]


def course_track(radius: float = 0.9) -> Track:
    """A closed track, counter-clockwise: a straight, two half circles, a dent on the far side.

    Its curves to the left and right have a radius of `radius` m.
    """
    eighth = math.pi / 4.0
    half_circle = Segment(math.pi * radius, math.pi)
    dent = [
        Segment(eighth * radius, eighth),
        Segment(2.0 * eighth * radius, -2.0 * eighth),
        Segment(eighth * radius, eighth),
    ]
    straight = Segment(4.0 * radius * math.sin(eighth))
    return Track([straight, half_circle, *dent, half_circle])
