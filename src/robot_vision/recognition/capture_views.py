"""Which views of an object on a turntable are kept: one from each direction, the sharpest."""

import math
from typing import List, NamedTuple, Optional

import numpy as np

MAX_WAIT = 1.0  # s, that a view waits for a sharper one from the same direction


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
    place = -pose[:3, :3].T @ pose[:3, 3]
    return math.atan2(place[1], place[0]) % (2.0 * math.pi)


class ViewCollection:
    """Keeps one view from each of some directions around the z axis of an object.

    The sharpest of the views that come from a direction one after the other is taken, when the
    camera sees the object from another one, or after MAX_WAIT.

    Args:
        count: How many directions there are.
    """

    def __init__(self, count: int) -> None:
        self._kept = [False] * count
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
        done = None
        before = self._best
        if before is not None:
            has_left = self._direction(view) != self._direction(before)
            if has_left or not 0.0 <= view.time - self._begin < MAX_WAIT:
                done = self.end()
        if self._kept[self._direction(view)]:
            return done
        if self._best is None:
            self._begin = view.time
        if self._best is None or view.sharpness > self._best.sharpness:
            self._best = view
        return done

    def end(self) -> Optional[View]:
        """Returns the view that was waiting for a sharper one, to be stored now, or None."""
        done, self._best = self._best, None
        if done is not None:
            self._kept[self._direction(done)] = True
        return done

    def summary(self) -> str:
        """Returns how many views are kept, and from where there is none yet."""
        count = len(self._kept)
        text = f"{self.kept} of {count} views"
        missing = self._missing()
        return f"{text}, missing at {', '.join(missing)} degrees" if missing else text

    def _direction(self, view: View) -> int:
        count = len(self._kept)
        return int(azimuth_of(view.pose) / (2.0 * math.pi) * count + 0.5) % count

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
