"""Tracked objects as messages, and in the overlay."""

from typing import Iterable, List, Union

import numpy as np
from geometry_msgs.msg import Point, Vector3

from .. import TrackedObject, TrackedWindow, draw_dot, draw_outline, draw_text
from ..common.plain_text import to_ascii
from ..msg import Detection, Flow, TrackState, TrackStateArray
from ..ros.messages import box_around, points
from ..ros.transport import Frame

RED = (0, 0, 255)
YELLOW = (0, 255, 255)


def detection_of(track: Union[TrackedObject, TrackedWindow], image: np.ndarray) -> Detection:
    """Returns a tracked object as a Detection, whose box is clipped to the image."""
    sides = np.hypot(*(track.outline[1:3] - track.outline[:2]).T)
    return Detection(
        label=track.label,
        id=track.id,
        score=track.confidence,
        box=box_around(track.outline, image),
        center=Point(*track.center, 0.0),
        outline=points(track.outline),
        circle_center=Point(*track.outline.mean(axis=0), 0.0),
        circle_radius=np.hypot(*sides) / 2.0,
        area=np.prod(sides),
        has_velocity=True,
        velocity=Vector3(*track.velocity, 0.0),
    )


def track_states(frame: Frame, tracks: Iterable[TrackedObject]) -> TrackStateArray:
    """Returns the states of all objects in a frame, including lost ones."""
    states = []
    for track in tracks:
        state = track_state(track)
        state.points = points(track.points)
        states.append(state)
    return TrackStateArray(frame.header, states)


def track_state(track: Union[TrackedObject, TrackedWindow]) -> TrackState:
    """Returns the state of an object without its points."""
    return TrackState(
        id=track.id,
        label=track.label,
        state=TrackState.TRACKED if track.tracked else TrackState.LOST,
        scale=track.scale,
        angle=track.angle,
        confidence=track.confidence,
    )


def flow_message(frame: Frame, positions: np.ndarray, velocities: np.ndarray) -> Flow:
    """Returns moving points, (n, 2) px, and their velocities, (n, 2) px/s, as a message."""
    return Flow(frame.header, points(positions), points(velocities))


def draw_tracks(image: np.ndarray, tracks: List[TrackedObject]) -> None:
    """Draws outlines and points of tracked objects, and the names of lost ones in red."""
    line = 20
    for track in tracks:
        name = _drawn_name(track)
        if track.tracked:
            outline = np.rint(track.outline).astype(int)
            draw_outline(image, outline, f"{name}: {track.confidence:.0%}")
            for x, y in track.points.tolist():
                draw_dot(image, (x, y), 2, YELLOW)
        else:
            draw_text(image, f"{name}: lost", (10, line), RED)
            line += 20


def draw_window(image: np.ndarray, window: TrackedWindow) -> None:
    """Draws the outline and the center of a tracked object, yellow if it is only expected."""
    name = _drawn_name(window)
    outline = np.rint(window.outline).astype(int)
    if window.tracked:
        draw_outline(image, outline, f"{name}: {window.confidence:.0%}")
        draw_dot(image, window.center, 3, RED)
    elif window.predicted:
        draw_outline(image, outline, f"{name}: expected", YELLOW)
    else:
        draw_text(image, f"{name}: lost", (10, 20), RED)


def _drawn_name(track: Union[TrackedObject, TrackedWindow]) -> str:
    return to_ascii(f"{track.label} {track.id}".strip())
