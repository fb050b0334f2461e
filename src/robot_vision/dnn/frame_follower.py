"""Following what a network finds through all frames, also those that it does not look at."""

import threading
from typing import Any, Callable, List, NamedTuple, Optional, Sequence, Tuple

from .. import BoxTrack, BoxTracker, BoxTrackerParams, CameraMotion, FoundObject
from ..ros.context import current
from ..ros.transport import Frame

Look = Callable[[Frame], List[FoundObject]]
Score = Callable[[FoundObject], float]
Tell = Callable[[Frame, List[BoxTrack], Sequence[FoundObject]], Any]


class Pace:
    """Tells which frames are looked at, so that there are not too many.

    Attributes:
        period: s from one to the next, on average at least.
    """

    def __init__(self) -> None:
        self.period = 0.0
        self._last: Optional[float] = None  # s, when the newest that was looked at was due

    def is_due(self, now: float, wanted: bool = False) -> bool:
        """Returns whether the frame of this time is looked at; time may go back.

        Args:
            now: The time, s.
            wanted: Whether it is looked at however short the time since the last one is.
        """
        if self._last is None or now < self._last:
            self._last = now
            return True
        if now - self._last >= self.period:
            # What one is late by, the next one may be earlier by: frames seldom come when they are
            # due, and of a camera at this very rate some would be left out each time.
            self._last = max(self._last + self.period, now - self.period)
            return True
        if wanted:
            self._last = now
        return wanted


class _Job(NamedTuple):
    """A frame that the network looks at."""

    frame: Frame
    time: float  # s; that of a frame without a stamp is another one whenever it is asked for


class FrameFollower:
    """Has a network look at frames in a thread, and tells of each frame what is in it.

    The network looks at the newest frame when it is done with the last one. Meanwhile the tracker
    says where things are now, by their velocity and the motion of the camera. A frame that the
    network looks at is told of when it has, or when the next frame comes if that is earlier. What
    is found too late for its own frame is known from the next frame on. With frames of another size
    all begins anew. Thread-safe.

    Args:
        look: A function that returns what the network finds in a frame. Only one thread calls it.
        tell: A function that is called for each frame in turn, with what is followed in it and
            what was found in it, which is empty if the network has not looked at it in time.
        fail: A function that is called with what `look` has raised, or what the tracker or `tell`
            has raised at its result; the next frame is looked at as usual.
    """

    def __init__(self, look: Look, tell: Tell, fail: Callable[[Exception], Any]):
        self._look, self._tell, self._fail = look, tell, fail
        self._changed = threading.Condition()  # guards all below
        self._tracker = BoxTracker()
        self._pace = Pace()
        self._score: Score = lambda found: found.score
        self._worker: Optional[threading.Thread] = None
        self._size: Tuple[int, ...] = ()  # of the newest frame, px
        self._forget()
        self._ended = False
        current().on_end(self._end_thread)

    def configure(self, params: BoxTrackerParams, period: float, score: Score) -> None:
        """Sets how things are followed.

        Args:
            params: Those of the tracker.
            period: s from one frame that the network looks at to the next, at least.
            score: A function that returns the score of what was found for the tracker.

        Raises:
            ValueError: A parameter of the tracker is out of range.
        """
        with self._changed:
            self._tracker.configure(params)
            self._pace.period = period
            self._score = score

    def offer(self, frame: Frame, wanted: bool = False) -> None:
        """Takes the next frame, which is looked at sooner than `period` allows if it is wanted."""
        time = frame.time
        with self._changed:
            self._tell_waiting([])
            if frame.image.shape[:2] != self._size:
                self.clear()  # Places in frames of another size say nothing of this one.
                self._size = frame.image.shape[:2]
            warp = self._motion.update(frame.image, frame.encoding, self._boxes)
            tracks = self._tracker.predict(time, warp)
            self._boxes = [one.box for one in tracks]
            if self._job is None and self._pace.is_due(time, wanted):
                self._begin(_Job(frame, time), tracks)
            else:
                self._tell(frame, tracks, [])

    def clear(self) -> None:
        """Forgets what is followed; what the network is looking at does not count any more."""
        with self._changed:
            self._tracker.clear()
            self._forget()

    def _forget(self) -> None:
        self._motion = CameraMotion()
        self._boxes: List[Tuple[float, float, float, float]] = []  # in the newest frame, px
        self._job: Optional[_Job] = None
        self._waiting: Optional[List[BoxTrack]] = None  # in the job, if that was not told of yet

    def _begin(self, job: _Job, tracks: List[BoxTrack]) -> None:
        self._job, self._waiting = job, tracks
        if self._worker is None:
            self._worker = current().thread(self._work, "network")
            self._worker.start()
        self._changed.notify()

    def _tell_waiting(
        self, found: Sequence[FoundObject], tracks: Optional[List[BoxTrack]] = None
    ) -> None:
        """Tells of the job's frame, with other tracks than those expected in it if there are."""
        waiting, self._waiting = self._waiting, None
        if waiting is not None:
            self._tell(self._job.frame, waiting if tracks is None else tracks, found)

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._job is not None or self._ended)
                if self._ended:
                    return
                job = self._job
            found: List[FoundObject] = []
            error: Optional[Exception] = None
            try:
                found = self._look(job.frame)
            except Exception as raised:  # Of any kind, as the runtimes raise what they like.
                error = raised
            with self._changed:
                if self._job is job:
                    self._end(found, error)

    def _end_thread(self) -> None:
        with self._changed:
            self._ended = True
            self._changed.notify()

    def _end(self, found: List[FoundObject], error: Optional[Exception]) -> None:
        """Ends the job. Whatever is raised, the thread goes on, as nobody would start another."""
        tracks = None
        try:
            if error is None:
                boxes = [(one.class_id, self._score(one), one.box) for one in found]
                tracks = self._tracker.update(self._job.time, boxes)
        except Exception as raised:  # Numbers of a network need not make sense.
            error, found = raised, []
        try:
            if error is not None:
                self._fail(error)
            self._tell_waiting(found, tracks)
        except Exception as raised:
            self._fail(raised)
        finally:
            self._job, self._waiting = None, None
