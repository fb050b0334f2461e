"""The node trial_node, which does what no node may do, as its parameter ~does says."""

import sys
import threading
from typing import Any, Dict

import rospy
from std_srvs.srv import Trigger, TriggerResponse

from ..msg import DetectionArray
from ..ros.configs import HsvTrackerConfig
from ..ros.context import current
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams
from ..ros.messages import detection_array
from ..ros.params import read_param
from ..ros.startup import run_node
from ..ros.transport import Frame


class TrialNode:
    """Publishes ~objects, an empty message for each frame."""

    def __init__(self) -> None:
        self._does = read_param("does", "")
        self._released = threading.Event()
        self._params = LiveParams(HsvTrackerConfig, self._configure)
        self._node = ImageNode(self._process)
        self._objects = self._node.publisher("~objects", DetectionArray)
        current().service("~release", Trigger, self._on_release)
        current().service("~exit", Trigger, lambda _: sys.exit(3))
        self._do("at_start")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        if config["opening"] == 7:
            raise ValueError("opening is 7, must not be")

    def _process(self, frame: Frame) -> None:
        self._do("at_frame")
        self._objects.publish(detection_array(frame, []))

    def _do(self, when: str) -> None:
        what = self._does.partition(" ")[0] if self._does.endswith(when) else ""
        if what == "raises":
            raise KeyError("of the trial")
        if what == "refuses":
            raise ValueError("does is this, must not be")
        if what == "exits":
            sys.exit(4)
        if what == "waits":
            rospy.logwarn("waiting")
            self._released.wait()
        if what == "outlasts":
            rospy.logwarn("waiting")
            while not rospy.is_shutdown():
                rospy.rostime.wallsleep(0.01)
            raise RuntimeError("the process has been shut down")

    def _on_release(self, _request: Any) -> TriggerResponse:
        self._do("at_service")
        self._released.set()
        return TriggerResponse(True, "")


def main() -> None:
    run_node("trial_node", TrialNode)
