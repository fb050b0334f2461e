"""Drives a robot, and stops it whenever the node no longer sees what it drives on."""

import threading
import time
from typing import Optional

import rospy
from geometry_msgs.msg import Twist
from std_srvs.srv import SetBool, SetBoolRequest, SetBoolResponse

from ..ros.context import current
from ..ros.params import read_param
from ..ros.registration import UNREACHABLE_ERRORS
from .line_control import must_stop

PERIOD = 0.05  # s between two checks of the timeout, and between two zero commands


class Drive:
    """Passes commands on to `cmd_vel` while they keep coming, and else tells the robot to stop.

    It repeats a zero Twist when the last observation is older than `timeout`, while the drive is
    disabled by ~enabled or the service ~enable (std_srvs/SetBool), and when the node shuts down.
    Time is real time, because a simulated clock that stands still must not keep a robot going.

    Args:
        publisher: The publisher of geometry_msgs/Twist.
        timeout: The time in s for which an observation is worth driving on.

    Raises:
        ValueError: ~enabled has the wrong type.
    """

    def __init__(self, publisher: rospy.Publisher, timeout: float = 0.5):
        self.timeout = timeout
        self.enabled = read_param("enabled", True)
        self._publisher = publisher
        self._lock = threading.Lock()  # so that no command overtakes a stop
        self._keeping = threading.Lock()  # so that what is kept is what was asked for last
        self._seen: Optional[float] = None  # s of the monotonic clock, the last observation
        self._ended = False
        self._thread = current().thread(self._watch, "watchdog")
        current().service("~enable", SetBool, self._on_enable)
        current().on_end(self._end)
        if not self.enabled:
            rospy.logwarn("stopped by the parameter ~enabled: the service ~enable lets it drive")
        self._thread.start()

    def command(self, linear: float, angular: float, seen: float) -> bool:
        """Sends a command, unless the observation it is based on is too old by now.

        Args:
            linear: The forward speed in m/s.
            angular: The turn to the left in rad/s.
            seen: The time of the observation in s of time.monotonic(). On a busy machine it may
                have become too old while it was processed.

        Returns:
            Whether the observation is not too old, also if the drive is disabled.
        """
        with self._lock:
            now = time.monotonic()
            self._seen = min(seen, now)
            is_fresh = not must_stop(now, self._seen, True, self.timeout)
            if is_fresh and self.enabled and not self._ended:
                self._send(linear, angular)
        return is_fresh

    def _watch(self) -> None:
        while not self._ended:
            with self._lock:
                now = time.monotonic()
                if must_stop(now, self._seen, self.enabled, self.timeout) and not self._ended:
                    self._send(0.0, 0.0)
            time.sleep(PERIOD)

    def _on_enable(self, request: SetBoolRequest) -> SetBoolResponse:
        with self._lock:
            self.enabled = request.data
            if not self.enabled:
                self._send(0.0, 0.0)
        self._keep_enabled()
        return SetBoolResponse(True, "driving" if request.data else "stopped")

    def _keep_enabled(self) -> None:
        """Sets ~enabled: a robot that was stopped does not drive when the node starts again."""
        try:
            with self._keeping:
                current().set_param("~enabled", self.enabled)
        except UNREACHABLE_ERRORS as error:
            rospy.logwarn("~enabled is not kept for when the node starts again: %s", error)

    def _end(self) -> None:
        with self._lock:
            self._ended = True
        for _ in range(3):  # A lost message must not keep the robot going.
            self._send(0.0, 0.0)
            time.sleep(PERIOD)

    def _send(self, linear: float, angular: float) -> None:
        twist = Twist()
        twist.linear.x = linear
        twist.angular.z = angular
        self._publisher.publish(twist)
