"""Which views of an object on a turntable are kept: one from each direction, the sharpest."""

import math
from typing import List, NamedTuple, Optional, Sequence

import numpy as np

MAX_WAIT = 1.0  # s, that a view waits for a sharper one from the same direction
SAME_ELEVATION = math.radians(5.0)  # within which views are from the same height of the camera


class View(NamedTuple):
    """A view that may be kept.

    Attributes:
        time: Of the frame, s.
        number: Of the frame.
        image: (height, width, 3) uint8.
        depth: Of its pixels, uint16 in mm or float32 in m.
        mask: (height, width) uint8, not 0 where the object is.
        camera: The camera.
        pose: 4x4, of the object's frame in the camera's optical frame, m.
        sharpness: In any unit.
    """

    time: float
    number: int
    image: np.ndarray
    depth: np.ndarray
    mask: np.ndarray
    camera: object
    pose: np.ndarray
    sharpness: float


def azimuth_of(pose: np.ndarray) -> float:
    """Returns the direction from which a camera sees an object, rad about its z axis."""
    x, y, _ = _place_of_camera(pose)
    return math.atan2(y, x) % (2.0 * math.pi)


def elevation_of(pose: np.ndarray) -> float:
    """Returns how far above an object's x-y plane a camera is that sees it, rad."""
    x, y, z = _place_of_camera(pose)
    return math.atan2(z, math.hypot(x, y))


def _place_of_camera(pose: np.ndarray) -> np.ndarray:
    return -pose[:3, :3].T @ pose[:3, 3]


class ViewCollection:
    """Keeps one view from each of some directions around the z axis of an object.

    The sharpest of the views that come from a direction one after the other is taken, when the
    camera sees the object from another one, or after MAX_WAIT.

    Args:
        count: How many directions there are.
        earlier: Poses of views that were kept before. They count as soon as the camera is seen to
            be at the height that they were taken from; from another height, all are wanted.
    """

    def __init__(self, count: int, earlier: Sequence[np.ndarray] = ()) -> None:
        self._kept = [False] * count
        self._earlier = earlier
        self._best: Optional[View] = None
        self._begin = 0.0  # s, when the first view of this direction came

    @property
    def kept(self) -> int:
        """How many directions have a view."""
        return sum(self._kept)

    @property
    def full(self) -> bool:
        """Whether all directions have one."""
        return all(self._kept)

    def add(self, view: View) -> Optional[View]:
        """Offers a view, and returns one that is to be stored now, or None."""
        self._count_earlier(elevation_of(view.pose))
        here = self._direction(view.pose)
        done = None
        before = self._best
        if before is not None:
            has_left = here != self._direction(before.pose)
            if has_left or not 0.0 <= view.time - self._begin < MAX_WAIT:
                done = self.end()
        if self._kept[here] or (done is not None and self._direction(done.pose) == here):
            return done
        if self._best is None:
            self._begin = view.time
        if self._best is None or view.sharpness > self._best.sharpness:
            self._best = view
        return done

    def end(self) -> Optional[View]:
        """Returns the view that was waiting for a sharper one, to be stored now, or None."""
        done, self._best = self._best, None
        return done

    def keep(self, view: View) -> None:
        """Counts a view that was to be stored, and is."""
        self._kept[self._direction(view.pose)] = True

    def summary(self) -> str:
        """Returns how many views are kept, and from where there is none yet."""
        count = len(self._kept)
        text = f"{self.kept} of {count} views"
        missing = self._missing()
        return f"{text}, missing at {', '.join(missing)} degrees" if missing else text

    def _count_earlier(self, elevation: float) -> None:
        for pose in self._earlier:
            if abs(elevation_of(pose) - elevation) < SAME_ELEVATION:
                self._kept[self._direction(pose)] = True

    def _direction(self, pose: np.ndarray) -> int:
        count = len(self._kept)
        return int(azimuth_of(pose) / (2.0 * math.pi) * count + 0.5) % count

    def _missing(self) -> List[str]:
        """Returns the gaps, in degrees: single directions, and from the first to the last."""
        count, gaps = len(self._kept), []
        if not any(self._kept):
            return ["0-360"]
        begin = self._kept.index(True)
        run: List[int] = []
        for index in [*range(begin, begin + count + 1)]:
            if not self._kept[index % count]:
                run.append(index % count)
            elif run:
                ends = [f"{360.0 * one / count:.0f}" for one in (run[0], run[-1])]
                gaps.append("-".join(dict.fromkeys(ends)))
                run = []
        return gaps
