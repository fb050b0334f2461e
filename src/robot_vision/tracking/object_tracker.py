"""The node object_tracker, which follows objects that are selected in the image."""

import threading
import time
from typing import Any, Dict, List, Optional

import rospy
from sensor_msgs.msg import RegionOfInterest

from .. import ObjectTracker as Tracker
from .. import ObjectTrackerParams, TrackedObject, draw_text
from ..common.plain_text import to_ascii
from ..common.throttle import Throttle
from ..msg import DetectionArray, Flow, TrackStateArray
from ..ros.configs import ObjectTrackerConfig
from ..ros.image_node import ImageNode
from ..ros.messages import detection_array
from ..ros.params import LiveParams, filled
from ..ros.startup import run_node
from ..ros.transport import Frame
from ..srv import ForgetObject, ForgetObjectResponse, SelectObject, SelectObjectResponse
from .auto_selection import AutoSelection
from .tracks import clipped_box, detection_of, draw_tracks, flow_message, track_states

MAX_FRAME_AGE = 1.0  # s; nobody selects something in a frame that is older
SELECT_TIMEOUT = 5.0  # s that a selection waits for a frame


class Selection:
    """A region that waits for a frame in which it is selected."""

    def __init__(self, region: RegionOfInterest, label: str, replaces: bool):
        self.box = clipped_box(region)
        self.label = label
        self.replaces = replaces  # whether it replaces all other objects
        self.deadline = time.monotonic() + SELECT_TIMEOUT
        self.done = threading.Event()
        self.id = -1
        self.error = ""

    def fail(self, error: str) -> None:
        self.error = error
        self.done.set()


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
        self._waiting: List[Selection] = []
        self._refusal_throttle = Throttle()
        self._auto = AutoSelection(self._tracker)
        self._time: Optional[float] = None  # s, the newest frame
        self._lost: Dict[int, float] = {}  # s, the time since which an object is lost
        self._busy = False  # whether there are objects, or may soon be
        self._detections: Optional[rospy.Subscriber] = None
        self._node = ImageNode(self._process)
        self._params = LiveParams(ObjectTrackerConfig, self._configure)
        self._object = self._node.publisher("~object", DetectionArray)
        self._state = self._node.publisher("~state", TrackStateArray)
        self._flow = self._node.publisher("~flow", Flow)
        self._processed = self._node.image_publisher("~processed_image")
        self._select = rospy.Subscriber("~select", RegionOfInterest, self._on_select)
        rospy.Service("~select_object", SelectObject, self._on_select_object)
        rospy.Service("~forget", ForgetObject, self._on_forget)
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        with self._lock:
            self._tracker.configure(filled(ObjectTrackerParams(), config))
            self._config = config
            self._auto.configure(config["auto_label"], config["max_objects"], config["auto_after"])
            if config["auto_select"] and self._detections is None:
                self._detections = rospy.Subscriber(
                    "detections", DetectionArray, self._auto.add, queue_size=10, tcp_nodelay=True
                )
            elif not config["auto_select"] and self._detections is not None:
                self._detections.unregister()
                self._detections = None
            self._keep_working()

    def _keep_working(self) -> None:
        """Has the node work while there is something to follow. The lock must be held."""
        busy = bool(self._waiting or self._tracker.objects() or self._detections)
        if busy != self._busy:
            self._busy = busy
            self._node.keep_working(busy)

    def _process(self, frame: Frame) -> None:
        now = frame.time
        with self._lock:
            tracks = self._update(now, frame)
            config = self._config
            has_readers = self._flow.get_num_connections() > 0
            flow = self._tracker.flow(config["flow_points"]) if has_readers else None
            self._keep_working()
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
            detections = self._detections
            if detections and not detections.get_num_connections():
                nobody = f"nobody publishes detections on {detections.resolved_name}"
                draw_text(overlay, to_ascii(nobody), (10, overlay.shape[0] - 10))
            self._processed.publish(overlay, "bgr8", frame.header)

    def _update(self, now: float, frame: Frame) -> List[TrackedObject]:
        """Returns the objects in the frame, including those just selected."""
        self._drop_expired()
        waiting, self._waiting = self._waiting, []
        # People select in the frame that they saw, which is the last one if frames were coming.
        in_last = self._time is not None and 0.0 <= now - self._time < MAX_FRAME_AGE
        try:
            if in_last:
                self._select_all(waiting)
            tracks = self._tracker.update(now, frame.image)
            if not in_last:
                self._select_all(waiting)
        finally:
            for selection in waiting:
                if not selection.done.is_set():
                    selection.fail("the frame failed")
        if self._detections:
            self._auto.select(frame, tracks)
        self._forget_lost(now, tracks)
        self._time = now
        return self._tracker.objects()

    def _select_all(self, waiting: List[Selection]) -> None:
        for selection in waiting:
            others = [track.id for track in self._tracker.objects()] if selection.replaces else []
            try:
                selection.id = self._tracker.select(selection.box, selection.label)
            except ValueError as error:
                if self._refusal_throttle.due():
                    rospy.logerr("nothing selected on %s: %s", self._node.topic, error)
                selection.fail(str(error))
                continue
            for number in others:
                self._tracker.forget(number)
            selection.done.set()

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

    def _await(self, selection: Selection) -> None:
        with self._lock:
            outputs = (self._object, self._state, self._flow, self._processed)
            if not self._busy and not any(output.get_num_connections() for output in outputs):
                self._time = None  # No images were coming, so nobody saw the last one.
            self._drop_expired()
            if selection.replaces:
                self._waiting = [other for other in self._waiting if not other.replaces]
            self._waiting.append(selection)
            self._keep_working()

    def _drop_expired(self) -> None:
        """Fails selections that no frame came for in time. The lock must be held."""
        for selection in self._waiting:
            if time.monotonic() > selection.deadline:
                selection.fail(self._node.no_frame(SELECT_TIMEOUT))
                rospy.logerr_throttle(1.0, "nothing selected: " + selection.error)
        self._waiting = [one for one in self._waiting if not one.done.is_set()]

    def _on_select(self, region: RegionOfInterest) -> None:
        self._await(Selection(region, "", not self._config["several"]))

    def _on_select_object(self, request: Any) -> SelectObjectResponse:
        selection = Selection(request.region, request.label, False)
        self._await(selection)
        selection.done.wait(SELECT_TIMEOUT + 0.1)
        with self._lock:
            self._drop_expired()
            self._keep_working()
        return SelectObjectResponse(selection.id > 0, selection.error, selection.id)

    def _on_forget(self, request: Any) -> ForgetObjectResponse:
        with self._lock:
            known = [track.id for track in self._tracker.objects()]
            if request.id != -1 and request.id not in known:
                names = ", ".join(map(str, known)) or "none"
                return ForgetObjectResponse(
                    False, f"id is {request.id}, must be of an object ({names}), or -1 for all"
                )
            for number in known if request.id == -1 else [request.id]:
                self._tracker.forget(number)
            self._keep_working()
        return ForgetObjectResponse(True, "")


def main() -> None:
    run_node("object_tracker", ObjectTracker)
