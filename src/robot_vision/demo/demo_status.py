"""The node demo_status, which prints rate, age, processing time and state of each node."""

import contextlib
import os
import threading
import time
from typing import Collection, Dict, Set

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from std_srvs.srv import Trigger

from ..common.throttle import Throttle
from ..ros.context import current
from ..ros.graph_master import has_service
from ..ros.params import read_param
from ..ros.startup import run_node
from .window_tiles import Tiles

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
SYNTHETIC = {"object_detector": "/object_detector/processed_image"}  # with the scene as source
BASICS = {  # with basics:=true
    name: f"/{name}/processed_image"
    for name in (
        "filter",
        "dense_flow",
        "spectrum",
        "segmenter",
        "hough",
        "contours",
        "histogram",
        "window_tracker",
        "people_detector",
        "features",
        "template_matcher",
        "cube_overlay",
        "lane_detector",
    )
}
DEPTH = {  # with depth:=true
    "depth_registration": "/usb_cam/depth_registered/image_raw",
    "tabletop": "/tabletop/processed_image",
    "detections_3d": "/detections_3d/processed_image",
}
RECOGNITION = {"object_recognizer": "/object_recognizer/processed_image"}  # with recognition:=true
FRAMES = ": frames"  # the end of the name of the status that each node has; some have others, too
WIDTH = max(map(len, [*TOPICS, *SYNTHETIC, *BASICS, *DEPTH, *RECOGNITION]))
VIEWER = TOPICS["usb_cam"] + " "  # the start of simple_camera_view's title, which has two blanks
WINDOWS_TIMEOUT = 120.0  # s for all windows to open
MAX_PERIOD = 3600.0  # s
PRINT_ADDRESS = "dashboard/print_address"  # the service of the dashboard beside this node
SERVICE_TIMEOUT = 10.0  # s for the dashboard to start
LAST_WITHOUT_NEWS = 10  # rounds in which nobody new reports until nobody is waited for
POLL = 0.5  # s


def line(name: str, status: DiagnosticStatus) -> str:
    """Returns the status of one node as a line of text."""
    values = {pair.key: pair.value for pair in status.values}
    return "{:<{}} {:>6} Hz  age {:>8} ms  processing {:>8} ms  {}".format(
        name,
        WIDTH,
        values.get("output rate (Hz)", "?"),
        values.get("output age (ms)", "?"),
        values.get("processing time (ms)", "?"),
        status.message,
    )


class DemoStatus:
    """Prints a line for each node, in the order in which frames pass the nodes.

    It does so as often as they report, every second, or with ~period at most every so many s. With
    ~dashboard true it begins when the dashboard is there and all report, or nobody new has for ten
    rounds, and has the dashboard print its address again.

    With windows (~view true) it also puts them side by side. With neither windows nor a dashboard,
    the default, it first prints the topics that can be viewed.

    With ~synthetic true the node that detects the scene's things is among them, with ~basics true
    those of basic operations, with ~depth true those of depth, with ~recognition true the one that
    recognizes objects.
    Subscribes to /diagnostics.
    """

    def __init__(self) -> None:
        self._topics = dict(TOPICS)
        if read_param("synthetic", False):
            self._topics.update(SYNTHETIC)
        if read_param("basics", False):
            self._topics.update(BASICS)
        if read_param("depth", False):
            self._topics.update(DEPTH)
        if read_param("recognition", False):
            self._topics.update(RECOGNITION)
        self._wants_address = read_param("dashboard", False)
        if read_param("view", False):
            current().thread(lambda: tile_windows(self._topics), "windows").start()
        elif not self._wants_address:
            none = "No windows (view:=windows)" if os.environ.get("DISPLAY") else "No display"
            print(f"{none}: look at these topics, for instance with")
            print("  rosrun image_view image_view image:=" + TOPICS["edge_detector"])
            print(*("  " + topic for topic in self._topics.values()), sep="\n", flush=True)
        self._throttle = Throttle(read_param("period", 0.0, 0.0, MAX_PERIOD))
        self._seen: Set[str] = set()  # nodes that have reported
        self._without_news = 0  # rounds in which none came to these
        self._lock = threading.Lock()  # guards the rounds: each publisher has its own thread
        self._round: Dict[str, DiagnosticStatus] = {}
        current().subscriber("/diagnostics", DiagnosticArray, self._on_diagnostics)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        with self._lock:
            for status in message.status:
                if status.name.endswith(FRAMES):
                    self._add(status.name[: -len(FRAMES)], status)

    def _add(self, name: str, status: DiagnosticStatus) -> None:
        if name not in self._topics:
            return
        if name in self._round:  # Another node is missing from this round.
            self._print_round()
        self._round[name] = status
        if len(self._round) == len(self._topics):
            self._print_round()

    def _print_round(self) -> None:
        reported, self._round = self._round, {}
        # All nodes first come together in one table, with the address above and below it.
        if self._wants_address and not self._is_worth_printing(reported):
            return
        if self._throttle.due():
            lines = [line(name, reported[name]) for name in self._topics if name in reported]
            print("", *lines, sep="\n", flush=True)
        if self._wants_address:
            self._wants_address = False
            current().thread(print_address, "address").start()

    def _is_worth_printing(self, reported: Collection[str]) -> bool:
        """Returns whether all is up, or so many rounds have brought nothing new that it may be."""
        news = not self._seen.issuperset(reported)
        self._seen.update(reported)
        self._without_news = 0 if news else self._without_news + 1
        if self._without_news > LAST_WITHOUT_NEWS:
            return True
        if len(reported) < len(self._topics):
            return False
        with contextlib.suppress(OSError):  # The master does not answer.
            return has_service(current().resolve(PRINT_ADDRESS))
        return False


def print_address() -> None:
    """Has the dashboard print its address; the address itself is a secret of that node."""
    with contextlib.suppress(rospy.ROSException, rospy.ServiceException):  # It may not be there.
        service = current().resolve(PRINT_ADDRESS)
        rospy.wait_for_service(service, SERVICE_TIMEOUT)
        rospy.ServiceProxy(service, Trigger)()


def tile_windows(topics: Dict[str, str]) -> None:
    """Puts the windows of demo.launch side by side as they open."""
    try:
        tiles = Tiles([*topics.values(), VIEWER])
    except OSError as error:
        rospy.logwarn("windows stay where they open: %s", error)
        return
    deadline = time.monotonic() + WINDOWS_TIMEOUT
    while tiles.place() and time.monotonic() < deadline and not current().is_ending():
        time.sleep(POLL)
    tiles.close()


def main() -> None:
    run_node("demo_status", DemoStatus, has_file=False)
