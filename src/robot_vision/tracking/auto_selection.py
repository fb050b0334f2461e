"""Selects what another node detects, for object_tracker to follow."""

import collections
import math
import threading
import time
from typing import Any, Deque, List, NamedTuple, Set, Tuple

import numpy as np
import rospy

from .. import ObjectTracker, TrackedObject
from ..common.plain_text import MAX_NAME_LENGTH
from ..common.polygons import box_corners, is_inside
from ..msg import Detection, DetectionArray
from ..ros.detection_limit import best_detections
from ..ros.frame_pairs import MAX_UNMATCHED
from ..ros.image_node import INPUT_TIMEOUT
from ..ros.messages import clipped_box
from ..ros.recent import MAX_LAG, Recent
from ..ros.transport import Frame
from .selections import MAX_OBJECTS

HISTORY = 8  # frames at least that are kept, in which detectors that differ may have looked
MAX_WAITING = 10  # messages that wait for their frames


class Past(NamedTuple):
    """A frame of which detections may still come."""

    frame: Frame
    outlines: List[np.ndarray]  # of the objects that were tracked in it

    @property
    def header(self) -> Any:
        """That of the frame."""
        return self.frame.header

    @property
    def image(self) -> np.ndarray:
        """That of the frame."""
        return self.frame.image


class Candidate(NamedTuple):
    """A detection of the last message, and the time in s since which it was in all messages.

    A pause of the detector counts as a message without detections.
    """

    detection: Detection
    since: float


class AutoSelection:
    """Selects detections that no tracked object covers, in the frame in which they were found.

    A false detection seldom comes twice in the same place. Therefore only detections are selected
    that were found for some time. One that is only predicted in a frame is no gap, but is not
    selected there, as something else may be in its place.

    Args:
        tracker: The tracker of the objects. It must not be in use by others during select().

    Attributes:
        misfit: Why detections cannot be selected, in words, if many in a row were of no frame.
    """

    def __init__(self, tracker: ObjectTracker):
        self._tracker = tracker
        self._label = ""
        self._most = 1
        self._after = 0.0  # s
        self._predicted = False
        self._candidates: List[Candidate] = []
        self._looked_at = -math.inf  # s, the frame of the last message
        self._own: Set[int] = set()  # ids of the objects that were selected here
        self._lost: List[int] = []  # ids of those that are lost in this frame
        self.misfit = ""
        self._unmatched = 0  # messages in a row that were of no frame
        self._frames = Recent(in_order=True)  # of Past
        self._lock = threading.Lock()  # guards what is received
        self._come: Deque[DetectionArray] = collections.deque(maxlen=MAX_WAITING)
        self._last_come = time.monotonic()
        self._last_frame = self._last_come
        self._restarted: Any = None  # the stamp of the frame with which stamps went back

    def configure(self, label: str, most: int, after: float, predicted: bool = False) -> None:
        """Sets what is selected.

        Args:
            label: Only detections with this label are selected; "" selects all.
            most: The largest number of objects selected here.
            after: The time in s for which a detection must have been found without a gap.
            predicted: Whether a detection that is predicted counts as found.
        """
        self._label = label
        self._most = most
        self._after = after
        self._predicted = predicted

    def add(self, detections: DetectionArray) -> None:
        """Takes detections; may be called by another thread."""
        with self._lock:
            self._come.append(detections)
            self._last_come = time.monotonic()

    def silence(self) -> float:
        """Returns for how long no detections have come, in s; at first since clear()."""
        with self._lock:
            return time.monotonic() - self._last_come

    def clear(self) -> None:
        """Forgets frames and detections, but not which objects were selected here."""
        self._frames.clear()
        self._candidates = []
        self.misfit, self._unmatched = "", 0
        with self._lock:
            self._come.clear()
            self._last_come = time.monotonic()

    def select(self, frame: Frame, tracks: List[TrackedObject]) -> None:
        """Selects what was detected up to this frame, in which `tracks` are the objects."""
        self._note_pauses(frame.header.stamp)
        self._keep(frame, [track.outline for track in tracks if track.tracked])
        self._own &= {track.id for track in tracks}
        self._lost = [track.id for track in tracks if track.id in self._own and not track.tracked]
        for found in self._take_up_to(frame.header.stamp):
            stamps = [past.header.stamp for past in self._frames]
            if found.header.stamp not in stamps:
                self._note_unmatched(found.header.stamp)
                continue
            self.misfit, self._unmatched = "", 0
            number = stamps.index(found.header.stamp)
            self._update_candidates(found.detections, self._frames[number].frame.time)
            self._select_uncovered(number)
            self._drop_before(found.header.stamp)

    def _note_pauses(self, stamp: Any) -> None:
        """Notes that frames come again after a pause, in which nobody could detect, or anew."""
        now, before = time.monotonic(), self._last_frame
        self._last_frame = now
        if now - before >= INPUT_TIMEOUT:
            with self._lock:
                self._last_come = now
        if self._frames and stamp < self._frames[-1].header.stamp:
            self._candidates = []
            self.misfit, self._unmatched = "", 0
            self._restarted = stamp

    def _drop_before(self, stamp: Any) -> None:
        """Drops frames of which no detections come any more, as those of this stamp have come."""
        while len(self._frames) > HISTORY and self._frames[0].header.stamp < stamp:
            self._frames.popleft()

    def _keep(self, frame: Frame, outlines: List[np.ndarray]) -> None:
        """Adds the newest frame; of several with the same stamp, as with none, it is the last."""
        if self._frames and self._frames[-1].header.stamp == frame.header.stamp:
            self._frames.pop()
        self._frames.keep(Past(frame, outlines))

    def _take_up_to(self, stamp: Any) -> List[DetectionArray]:
        """Returns the messages whose frames cannot be still to come; the others wait."""
        with self._lock:
            come = list(self._come)
            self._come.clear()
            self._come.extend(found for found in come if found.header.stamp > stamp)
            waits = len(self._come) == MAX_WAITING
            if waits and self._has_just_restarted(stamp):  # They are of the end of the last time.
                self._come.clear()
                waits = False
        if waits:  # Nobody detects so much before the frames come: they are of another clock.
            self._note_unmatched(come[0].header.stamp)
        return [found for found in come if found.header.stamp <= stamp]

    def _has_just_restarted(self, stamp: Any) -> bool:
        return self._restarted is not None and (stamp - self._restarted).to_sec() < MAX_LAG

    def _note_unmatched(self, stamp: Any) -> None:
        """Counts a message of no frame, unless it is of one that came before the first here."""
        late = self._frames.lateness(stamp)
        if not late and 0.0 < (self._frames[0].header.stamp - stamp).to_sec() < MAX_LAG:
            return
        self._unmatched += 1
        if self._unmatched >= MAX_UNMATCHED:
            apart = min(abs((past.header.stamp - stamp).to_sec()) for past in self._frames)
            self.misfit = (
                late or f"the last is of none of the images, the nearest {apart:.3g} s off"
            )

    def _update_candidates(self, detections: List[Detection], now: float) -> None:
        has_paused = abs(now - self._looked_at) >= INPUT_TIMEOUT
        before = [] if has_paused else self._candidates
        self._looked_at = now
        self._candidates = []
        wanted = [one for one in detections if self._label in ("", one.label)]
        for one in best_detections(wanted):
            since = [old.since for old in before if is_same(old.detection, one)]
            if since or self._is_found(one):
                self._candidates.append(Candidate(one, min([now, *since])))

    def _is_found(self, detection: Detection) -> bool:
        return self._predicted or not detection.predicted

    def _select_uncovered(self, number: int) -> None:
        frame, outlines = self._frames[number]
        for found, since in self._candidates:
            if frame.time - since < self._after or not self._is_found(found):
                continue
            if is_covered(found, outlines):
                continue
            full = len(self._own) >= self._most or len(self._tracker.objects()) >= MAX_OBJECTS
            if full and not self._lost:
                return
            region = clipped_box(found.box)
            try:
                label = found.label[:MAX_NAME_LENGTH]  # It is published with each frame.
                selected = self._tracker.select_in(frame.image, region, label)
            except ValueError as error:
                rospy.logwarn_throttle(10.0, "a detection cannot be followed: %s", error)
                continue
            if full:  # A lost object makes way.
                self._own.remove(self._lost[0])
                self._tracker.forget(self._lost.pop(0))
            self._own.add(selected)
            # Further detections of it may come for frames in which it was not tracked yet.
            for later in list(self._frames)[number:]:
                later.outlines.append(box_corners(region))


def is_same(before: Detection, now: Detection) -> bool:
    """Returns whether detections of two frames in a row are of the same thing."""
    if before.label != now.label or before.id != now.id:
        return False
    if now.id >= 0:
        return True
    x, y, width, height = clipped_box(before.box)
    middle_x, middle_y = middle_of(now)
    return x <= middle_x <= x + width and y <= middle_y <= y + height


def is_covered(found: Detection, outlines: List[np.ndarray]) -> bool:
    """Returns whether the middle of a detection is inside an outline."""
    return any(is_inside(outline, middle_of(found)) for outline in outlines)


def middle_of(found: Detection) -> Tuple[float, float]:
    """Returns the middle of a detection's box in px."""
    x, y, width, height = clipped_box(found.box)
    return x + width / 2.0, y + height / 2.0
