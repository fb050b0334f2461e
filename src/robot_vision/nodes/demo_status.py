"""The node demo_status: a line per node and second, with rate, age, processing time and state."""

import threading
from typing import Dict

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

TOPICS = {
    "usb_cam": "/usb_cam/image_raw",
    "brightness": "/brightness/processed_image",
    "edge_detector": "/edge_detector/processed_image",
    "hsv_tracker": "/hsv_tracker/processed_image",
    "ball_tracker": "/ball_tracker/processed_image",
    "line_follower": "/line_follower/processed_image",
    "face_detector": "/face_detector/processed_image",
    "motion_detector": "/motion_detector/processed_image",
    "object_tracker": "/object_tracker/processed_image",
    "apriltag_detector": "/apriltag_detector/processed_image",
    "code_reader": "/code_reader/processed_image",
}


def line(name: str, status: DiagnosticStatus) -> str:
    """The status of one node as one line of text."""
    values = {pair.key: pair.value for pair in status.values}
    return "{:<14} {:>6} Hz  age {:>8} ms  processing {:>8} ms  {}".format(
        name,
        values.get("output rate (Hz)", "?"),
        values.get("output age (ms)", "?"),
        values.get("processing time (ms)", "?"),
        status.message,
    )


class DemoStatus:
    """Prints the nodes in the order in which the frames pass them.

    Without a display (~view false, the default) it first tells which topics there are to look at.

    Subscribes to /diagnostics.
    """

    def __init__(self) -> None:
        if not rospy.get_param("~view", False):
            print("No display: look at these topics, for instance with")
            print("  rosrun image_view image_view image:=" + TOPICS["edge_detector"])
            print(*("  " + topic for topic in TOPICS.values()), sep="\n", flush=True)
        self._lock = threading.Lock()  # guards _round: each publisher has a thread of its own
        self._round: Dict[str, DiagnosticStatus] = {}
        self._subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, self._on_diagnostics)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        with self._lock:
            for status in message.status:
                self._add(status.name.split(":")[0], status)

    def _add(self, name: str, status: DiagnosticStatus) -> None:
        if name not in TOPICS:
            return
        if name in self._round:  # a node is missing from this round
            self._print_round()
        self._round[name] = status
        if len(self._round) == len(TOPICS):
            self._print_round()

    def _print_round(self) -> None:
        for name in TOPICS:
            if name in self._round:
                print(line(name, self._round[name]), flush=True)
        self._round.clear()
