"""The node window_tracker, which follows an object by its colours with meanShift or CamShift."""

import math
import threading
from typing import Any, Dict

from .. import TrackedWindow, WindowTrackerParams, draw_text
from .. import WindowTracker as Tracker
from ..msg import Detection, DetectionArray, TrackStateArray
from ..ros.configs import WindowTrackerConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import detection_array
from ..ros.startup import run_node
from ..ros.transport import Frame
from .selections import TrackSelection, TrackSelections
from .tracks import detection_of, draw_window, track_state

NOTHING = (0, 0, 0, 0)  # the region of the parameters that selects nothing


class WindowTracker:
    """Publishes ~objects, ~state, ~back_projection (mono8) and ~processed_image (its outline).

    Subscribes to image. It follows one region: that of the parameters ~x, ~y, ~width and ~height,
    or the last that came from ~select (sensor_msgs/RegionOfInterest) or ~select_object, until
    ~forget. While it has an object it processes images even if nobody subscribes, because it would
    lose it otherwise.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards all attributes below
        self._tracker = Tracker()
        self._configured = NOTHING
        self._node = ImageNode(self._process)
        self._selections = TrackSelections(self._node, self._lock, self._tracker)
        self._params = LiveParams(WindowTrackerConfig, self._configure)
        self._objects = self._node.publisher("~objects", DetectionArray)
        self._state = self._node.publisher("~state", TrackStateArray)
        self._projection = self._node.image_publisher("~back_projection")
        self._processed = self._node.image_publisher("~processed_image")
        outputs = (self._objects, self._state, self._projection, self._processed)
        self._selections.listen(outputs)
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        box = config["x"], config["y"], config["width"], config["height"]
        with self._lock:
            self._tracker.configure(filled(WindowTrackerParams(), config))
            if box != self._configured and config["width"] > 0 and config["height"] > 0:
                self._selections.add(TrackSelection(box, timeout=math.inf))
            self._configured = box

    def _process(self, frame: Frame) -> None:
        with self._lock:
            with self._selections.updating(frame.time):
                self._tracker.update(frame.time, frame.image)
            windows = self._tracker.objects()
            projection = self._tracker.back_projection()
            self._selections.keep_working()
        if self._objects.get_num_connections():
            found = (
                window_detection(window, frame)
                for window in windows
                if window.tracked or window.predicted
            )
            self._objects.publish(detection_array(frame, found))
        self._state.publish(TrackStateArray(frame.header, list(map(track_state, windows))))
        if projection is not None:
            self._projection.publish(projection, "mono8", frame.header)
        if self._processed.get_num_connections():
            overlay = frame.image.copy()
            for window in windows:
                draw_window(overlay, window)
            if not windows:
                draw_text(overlay, "nothing is selected", (10, 20))
            self._processed.publish(overlay, "bgr8", frame.header)


def window_detection(window: TrackedWindow, frame: Frame) -> Detection:
    """Returns an object that is seen or expected in a frame as a Detection."""
    found = detection_of(window, frame.image)
    found.predicted = window.predicted
    return found


def main() -> None:
    run_node("window_tracker", WindowTracker)
