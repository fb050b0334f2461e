"""Boxes that move before a camera that shakes, and what a detector makes of them.

All is the same for the same seed. Things have depths: one that is more than half covered by nearer
ones is hidden, and no detector sees it.
"""

import math
from dataclasses import dataclass
from typing import Dict, List, Optional, Tuple

import numpy as np
from track_identities import Box, Frame

SIZE = (640, 480)  # px
RATE = 30.0  # Hz
HIDDEN_SHARE = 0.5  # of a box that is covered
Detection = Tuple[int, float, Box]


@dataclass
class Thing:
    """Something that moves along a straight line, swaying, and comes nearer or goes away."""

    name: int
    class_id: int
    depth: float  # a smaller one covers
    begin: float  # s
    end: float  # s
    center: Tuple[float, float]  # px, at the beginning, without the camera's motion
    velocity: Tuple[float, float]  # px/s
    size: Tuple[float, float]  # px
    growth: float = 0.0  # of the size, 1/s
    sway: float = 0.0  # px

    def box_at(self, time: float) -> Optional[np.ndarray]:
        if not self.begin <= time < self.end:
            return None
        t = time - self.begin
        middle = np.array(self.center) + t * np.array(self.velocity)
        middle[1] += self.sway * math.sin(2.0 * t)
        half = np.array(self.size) * math.exp(self.growth * t) / 2.0
        return np.concatenate([middle - half, middle + half])


def camera_pose(time: float) -> np.ndarray:
    """2x3: pixels of the world at rest to those of a frame, of a camera that is held by hand."""
    angle = 0.02 * math.sin(3.1 * time)
    scale = 1.0 + 0.03 * math.sin(1.7 * time)
    shift = 25.0 * np.array([math.sin(4.3 * time), math.cos(5.1 * time)])
    cos, sin = scale * math.cos(angle), scale * math.sin(angle)
    turn = np.array([[cos, -sin], [sin, cos]])
    middle = np.array(SIZE) / 2.0
    return np.column_stack([turn, middle - turn @ middle + shift])


def warp_between(last: np.ndarray, newest: np.ndarray) -> np.ndarray:
    """2x3: pixels of the frame with one camera_pose() to those of another one."""
    full = [np.vstack([pose, [0.0, 0.0, 1.0]]) for pose in (last, newest)]
    return (full[1] @ np.linalg.inv(full[0]))[:2]


def seen_box(pose: np.ndarray, box: np.ndarray) -> np.ndarray:
    """A box as the camera sees it: the centre moves, and the sides grow."""
    middle = pose[:, :2] @ (box[:2] + box[2:]) / 2.0 + pose[:, 2]
    half = (box[2:] - box[:2]) / 2.0 * math.sqrt(np.linalg.det(pose[:, :2]))
    return np.concatenate([middle - half, middle + half])


def clipped(box: np.ndarray) -> np.ndarray:
    return np.clip(box, 0.0, np.tile(np.array(SIZE, float), 2))


def area(box: np.ndarray) -> float:
    return float(np.prod(np.maximum(box[2:] - box[:2], 0.0)))


def covered_share(box: np.ndarray, nearer: List[np.ndarray]) -> float:
    """The share of a box that is behind others, on a grid of 20 x 20 points."""
    x, y = (np.linspace(box[i], box[i + 2], 41)[1::2] for i in (0, 1))
    hidden = np.zeros((20, 20), bool)
    for x0, y0, x1, y1 in nearer:
        hidden |= ((y >= y0) & (y <= y1))[:, None] & ((x >= x0) & (x <= x1))[None]
    return float(hidden.mean())


class World:
    """Things, the camera and the truth of each frame."""

    def __init__(self, things: List[Thing], shaking: bool = True):
        self.things = things
        self._pose_at = camera_pose if shaking else lambda _time: np.eye(2, 3)

    def warp(self, number: int) -> np.ndarray:
        """Pixels of the frame before this one to those of this one."""
        poses = [self._pose_at(max(i, 0) / RATE) for i in (number - 1, number)]
        return warp_between(*poses)

    def boxes(self, number: int) -> Dict[int, np.ndarray]:
        """The boxes of what is in the image by at least a half and not hidden, clipped."""
        time = number / RATE
        pose, nearer, boxes = self._pose_at(time), [], {}
        for thing in sorted(self.things, key=lambda thing: thing.depth):
            box = thing.box_at(time)
            if box is None:
                continue
            whole = seen_box(pose, box)
            part = clipped(whole)
            if area(part) < 0.5 * area(whole):
                continue
            if covered_share(part, nearer) <= HIDDEN_SHARE:
                boxes[thing.name] = part
            nearer.append(part)
        return boxes

    def truth(self, number: int) -> Frame:
        return {name: tuple(box) for name, box in self.boxes(number).items()}

    def class_of(self, name: int) -> int:
        return next(thing.class_id for thing in self.things if thing.name == name)


@dataclass
class Detector:
    """Misses some, is unsure of others, errs by some px, and sees what is not there."""

    seed: int
    noise: float = 0.03  # of a box's sides: standard deviation of its edges
    missing: float = 0.05  # share
    unsure: float = 0.15  # share
    false_boxes: float = 0.3  # in a frame, on average

    def find(self, number: int, truth: Frame, classes: Dict) -> List[Detection]:
        random = np.random.default_rng([self.seed, number])
        found = []
        for name, box in truth.items():
            sides = np.tile([box[2] - box[0], box[3] - box[1]], 2)
            noisy = np.array(box) + random.normal(0.0, self.noise, 4) * sides
            score = random.uniform(0.15, 0.45) if random.random() < self.unsure else 0.8
            if random.random() >= self.missing:
                found.append((classes[name], score, tuple(noisy)))
        for _ in range(random.poisson(self.false_boxes)):
            corner = random.uniform(0.0, 0.8, 2) * SIZE
            size = random.uniform(20.0, 80.0, 2)
            found.append((0, random.uniform(0.1, 0.7), (*corner, *(corner + size))))
        random.shuffle(found)
        return found


def crossing_world(shaking: bool = True) -> World:
    """20 s of a dozen things: some cross, some hide others, some enter and leave."""
    things = [
        # Two of a class meet in the middle, one behind the other.
        Thing(0, 0, 1.0, 0.0, 20.0, (100.0, 150.0), (24.0, 0.0), (60.0, 90.0)),
        Thing(1, 0, 2.0, 0.0, 20.0, (560.0, 160.0), (-24.0, 0.0), (60.0, 80.0)),
        # A pillar of another class, behind which two go.
        Thing(2, 1, 0.5, 0.0, 20.0, (330.0, 350.0), (0.0, 0.0), (50.0, 220.0)),
        Thing(3, 0, 3.0, 0.0, 9.0, (60.0, 330.0), (75.0, 0.0), (40.0, 80.0)),
        Thing(4, 0, 4.0, 4.0, 14.0, (600.0, 390.0), (-70.0, 0.0), (40.0, 70.0)),
        # What comes nearer, and what goes away.
        Thing(5, 2, 6.0, 0.0, 20.0, (200.0, 60.0), (8.0, 2.0), (40.0, 40.0), 0.03),
        Thing(6, 2, 5.0, 2.0, 20.0, (520.0, 80.0), (-5.0, -1.0), (90.0, 70.0), -0.04),
        # In and out over all borders.
        Thing(7, 0, 7.0, 3.0, 12.0, (-20.0, 250.0), (85.0, 10.0), (50.0, 60.0), 0.0, 10.0),
        Thing(8, 0, 8.0, 8.0, 16.0, (450.0, -30.0), (-10.0, 75.0), (60.0, 60.0)),
        Thing(9, 0, 9.0, 10.0, 20.0, (150.0, 500.0), (20.0, -60.0), (70.0, 60.0)),
        Thing(10, 3, 10.0, 0.0, 20.0, (80.0, 420.0), (8.0, 0.0), (80.0, 50.0), 0.0, 15.0),
    ]
    return World(things, shaking)


def run_tracker(
    tracker, truth: List[Frame], results: Dict[int, List[Detection]], warps, late: int = 0
) -> List[Frame]:
    """The boxes that a rv.BoxTracker reports in each frame, by id, clipped to 640x480 px.

    Args:
        results: the detector's, by the numbers of the frames that they are of.
        warps: of each frame, from the one before; or None.
        late: frames after which a result is there.
    """
    reported = []
    for number in range(len(truth)):
        time, warp = number / RATE, None if warps is None else warps[number]
        past = number - late
        if late and past in results:
            tracker.update(past / RATE, results[past])
        if not late and number in results:
            tracks = tracker.update(time, results[number], warp)
        else:
            tracks = tracker.predict(time, warp)
        boxes = {track.id: clipped(np.array(track.box)) for track in tracks}
        reported.append({name: tuple(box) for name, box in boxes.items() if area(box) > 0.0})
    return reported
