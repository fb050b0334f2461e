"""Selects what another node has found, for object_tracker to follow."""

import collections
import threading
from typing import Deque, List, NamedTuple, Set, Tuple

import cv2
import numpy as np
import rospy

from .. import ObjectTracker, TrackedObject
from ..msg import Detection, DetectionArray
from ..ros.transport import Frame
from .tracks import box_of

HISTORY = 8  # frames that a detection may be late
MAX_CANDIDATES = 100  # of a message, those of the highest score; each is compared with each


class Candidate(NamedTuple):
    """What was found in the last detections, and since when (s) it has been in all of them."""

    detection: Detection
    since: float


class AutoSelection:
    """Selects detections that no tracked object covers, in the frame where they were found.

    Finders err, but seldom twice in the same place: what was not found for long is not selected.

    Args:
        tracker: where objects are selected; select() is called when it is free.
    """

    def __init__(self, tracker: ObjectTracker):
        self._tracker = tracker
        self._label = ""
        self._most = 1
        self._after = 0.0  # s
        self._candidates: List[Candidate] = []
        self._own: Set[int] = set()  # ids of what has been selected here
        self._lost: List[int] = []  # those that are lost in this frame
        self._lock = threading.Lock()  # guards the detections that have come
        self._come: Deque[DetectionArray] = collections.deque(maxlen=HISTORY)
        # The last frames, and the outlines of what was tracked in them.
        self._frames: Deque[Tuple[Frame, List[np.ndarray]]] = collections.deque(maxlen=HISTORY)

    def configure(self, label: str, most: int, after: float) -> None:
        """Selects at most so many objects, found without a gap for `after` seconds.

        Only those with this label, if it is not empty.
        """
        self._label = label
        self._most = most
        self._after = after

    def add(self, detections: DetectionArray) -> None:
        """Takes what was found; for another thread."""
        with self._lock:
            self._come.append(detections)

    def select(self, frame: Frame, tracks: List[TrackedObject]) -> None:
        """Selects what has been found up to this frame, in which these objects are."""
        self._frames.append((frame, [track.outline for track in tracks if track.tracked]))
        self._own &= {track.id for track in tracks}
        self._lost = [track.id for track in tracks if track.id in self._own and not track.tracked]
        with self._lock:
            come, self._come = list(self._come), collections.deque(maxlen=HISTORY)
        stamps = [past.header.stamp for past, _ in self._frames]
        for found in come:
            if found.header.stamp > frame.header.stamp:
                self.add(found)  # its frame is still to come
            elif found.header.stamp in stamps:
                number = stamps.index(found.header.stamp)
                self._update_candidates(found.detections, self._frames[number][0].time)
                self._select_uncovered(number)

    def _update_candidates(self, detections: List[Detection], now: float) -> None:
        before = self._candidates
        self._candidates = [
            Candidate(
                one, min([now, *(old.since for old in before if is_same(old.detection, one))])
            )
            for one in self._best(detections)
        ]

    def _best(self, detections: List[Detection]) -> List[Detection]:
        wanted = [one for one in detections if self._label in ("", one.label)]
        if len(wanted) > MAX_CANDIDATES:
            rospy.logwarn_throttle(
                10.0,
                f"{len(wanted)} detections in a message: only the {MAX_CANDIDATES} of the highest "
                "score are looked at",
            )
            wanted.sort(key=lambda one: one.score, reverse=True)
        return wanted[:MAX_CANDIDATES]

    def _select_uncovered(self, number: int) -> None:
        frame, outlines = self._frames[number]
        for found, since in self._candidates:
            if frame.time - since < self._after or is_covered(found, outlines):
                continue
            full = len(self._own) >= self._most
            if full and not self._lost:
                return
            region = box_of(found.box)
            try:
                selected = self._tracker.select_in(frame.image, region, found.label)
            except ValueError as error:
                rospy.logwarn_throttle(10.0, "a detection cannot be followed: %s", error)
                continue
            if full:  # one that is lost makes way
                self._own.remove(self._lost[0])
                self._tracker.forget(self._lost.pop(0))
            self._own.add(selected)
            # Later detections of it are on their way, of frames in which it was not tracked yet.
            for _, later in list(self._frames)[number:]:
                later.append(corners_of(region))


def corners_of(box: Tuple[int, int, int, int]) -> np.ndarray:
    """The corners, (4, 2), of (x, y, width, height)."""
    x, y, width, height = box
    return np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)], float)


def is_same(before: Detection, now: Detection) -> bool:
    """Whether two detections, of a frame and the one before, are of the same thing."""
    if before.label != now.label or before.id != now.id:
        return False
    if now.id >= 0:
        return True
    x, y, width, height = box_of(before.box)
    middle_x, middle_y = middle_of(now)
    return x <= middle_x <= x + width and y <= middle_y <= y + height


def is_covered(found: Detection, outlines: List[np.ndarray]) -> bool:
    """Whether the middle of what was found is inside of an outline."""
    return any(
        cv2.pointPolygonTest(outline.astype(np.float32), middle_of(found), False) >= 0.0
        for outline in outlines
    )


def middle_of(found: Detection) -> Tuple[float, float]:
    """Of its box, px."""
    x, y, width, height = box_of(found.box)
    return x + width / 2.0, y + height / 2.0
