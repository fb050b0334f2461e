"""The node object_tracker, which follows objects that are selected in the image."""

import threading
from typing import Any, Dict, List, Optional

import rospy

from .. import ObjectTracker as Tracker
from .. import ObjectTrackerParams, TrackedObject, draw_text
from ..common.plain_text import to_ascii
from ..common.throttle import Throttle
from ..msg import DetectionArray, Flow, TrackStateArray
from ..ros.configs import ObjectTrackerConfig
from ..ros.context import MESSAGE_QUEUE, current
from ..ros.image_node import INPUT_TIMEOUT, ImageNode, silence_text
from ..ros.live_params import LiveParams, filled
from ..ros.messages import detection_array
from ..ros.startup import run_node
from ..ros.transport import Frame
from .auto_selection import AutoSelection
from .selections import TrackSelections
from .tracks import detection_of, draw_tracks, flow_message, track_states


class ObjectTracker:
    """Publishes ~object, ~state, ~flow and ~processed_image (outlines, points, lost objects).

    Subscribes to image. It follows the regions that come from ~select
    (sensor_msgs/RegionOfInterest), from ~select_object and, if ~auto_select is true, from
    `detections` (robot_vision/DetectionArray), until ~forget. While it has objects it processes
    images even if nobody subscribes, because it would lose them otherwise.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards all attributes below
        self._tracker = Tracker()
        self._auto = AutoSelection(self._tracker)
        self._lost: Dict[int, float] = {}  # s, the time since which an object is lost
        self._detections: Optional[rospy.Subscriber] = None
        self._lacking = Throttle(10.0)
        self._node = ImageNode(self._process)
        self._selections = TrackSelections(
            self._node, self._lock, self._tracker, lambda: self._detections is not None
        )
        self._params = LiveParams(ObjectTrackerConfig, self._configure)
        self._object = self._node.publisher("~object", DetectionArray)
        self._state = self._node.publisher("~state", TrackStateArray)
        self._flow = self._node.publisher("~flow", Flow)
        self._processed = self._node.image_publisher("~processed_image")
        self._selections.listen((self._object, self._state, self._flow, self._processed))
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        with self._lock:
            self._tracker.configure(filled(ObjectTrackerParams(), config))
            self._config = config
            self._selections.replaces = not config["several"]
            self._auto.configure(
                config["auto_label"],
                config["max_objects"],
                config["auto_after"],
                config["auto_predicted"],
            )
            if config["auto_select"] and self._detections is None:
                self._auto.clear()
                self._detections = current().subscriber(
                    "detections",
                    DetectionArray,
                    self._auto.add,
                    queue_size=MESSAGE_QUEUE,
                    tcp_nodelay=True,
                )
            elif not config["auto_select"] and self._detections is not None:
                current().close(self._detections.unregister)
                self._detections = None
                self._auto.clear()
            self._selections.keep_working()

    def _process(self, frame: Frame) -> None:
        now = frame.time
        with self._lock:
            tracks = self._update(now, frame)
            config = self._config
            lack = self._lack()
            has_readers = self._flow.get_num_connections() > 0
            flow = self._tracker.flow(config["flow_points"]) if has_readers else None
            self._selections.keep_working()
        self._node.set_lack(lack)
        if lack and self._lacking.due():
            rospy.logwarn("nothing is selected automatically: %s", lack)
        if self._object.get_num_connections():
            found = (detection_of(track, frame.image) for track in tracks if track.tracked)
            self._object.publish(detection_array(frame, found))
        if self._state.get_num_connections():
            self._state.publish(track_states(frame, tracks))
        if flow:
            self._flow.publish(flow_message(frame, *flow))
        if self._processed.get_num_connections():
            overlay = frame.image.copy()
            draw_tracks(overlay, tracks)
            if lack:
                draw_text(overlay, to_ascii(lack), (10, overlay.shape[0] - 10))
            self._processed.publish(overlay, "bgr8", frame.header)

    def _update(self, now: float, frame: Frame) -> List[TrackedObject]:
        """Returns the objects in the frame, including those just selected."""
        with self._selections.updating(now):
            tracks = self._tracker.update(now, frame.image)
        if self._detections:
            self._auto.select(frame, tracks)
        self._forget_lost(now, tracks)
        return self._tracker.objects()

    def _lack(self) -> str:
        """Returns why nothing that comes on `detections` can be selected, or an empty text."""
        if not self._detections:
            return ""
        topic, silent = self._detections.resolved_name, self._auto.silence()
        if silent >= INPUT_TIMEOUT:
            return silence_text("detections", "detections", topic, self._detections, silent)
        if self._auto.misfit:
            return f"the stamps on {topic} and {self._node.topic} do not meet: {self._auto.misfit}"
        return ""

    def _forget_lost(self, now: float, tracks: List[TrackedObject]) -> None:
        limit = self._config["forget_after"]
        self._lost = {
            track.id: min(self._lost.get(track.id, now), now)
            for track in tracks
            if not track.tracked
        }
        for number, since in self._lost.items():
            if 0.0 < limit < now - since:
                rospy.loginfo("object %d is forgotten: lost for %g s", number, limit)
                self._tracker.forget(number)


def main() -> None:
    run_node("object_tracker", ObjectTracker)
