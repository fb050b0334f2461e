"""Selects what another node has found, for object_tracker to follow."""

import collections
import threading
from typing import Deque, List, Set, Tuple

import cv2
import numpy as np
import rospy

from .. import ObjectTracker, TrackedObject
from ..msg import Detection, DetectionArray
from ..transport import Frame
from .tracks import box_of

HISTORY = 8  # frames that a detection may be late


class AutoSelection:
    """Selects detections that no tracked object covers, in the frame where they were found.

    Args:
        tracker: where objects are selected; select() is called when it is free.
    """

    def __init__(self, tracker: ObjectTracker):
        self._tracker = tracker
        self._label = ""
        self._most = 1
        self._own: Set[int] = set()  # ids of what has been selected here
        self._lost: List[int] = []  # those that are lost in this frame
        self._lock = threading.Lock()  # guards the detections that have come
        self._come: Deque[DetectionArray] = collections.deque(maxlen=HISTORY)
        # The last frames, and the outlines of what was tracked in them.
        self._frames: Deque[Tuple[Frame, List[np.ndarray]]] = collections.deque(maxlen=HISTORY)

    def configure(self, label: str, most: int) -> None:
        """Selects only what has this label, if it is not empty, and has at most so many objects."""
        self._label = label
        self._most = most

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
                self._select_uncovered(found.detections, stamps.index(found.header.stamp))

    def _select_uncovered(self, detections: List[Detection], number: int) -> None:
        frame, outlines = self._frames[number]
        for found in detections:
            if self._label not in ("", found.label) or is_covered(found, outlines):
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


def is_covered(found: Detection, outlines: List[np.ndarray]) -> bool:
    """Whether the middle of what was found is inside of an outline."""
    x, y, width, height = box_of(found.box)
    middle = x + width / 2.0, y + height / 2.0
    return any(
        cv2.pointPolygonTest(outline.astype(np.float32), middle, False) >= 0.0
        for outline in outlines
    )
