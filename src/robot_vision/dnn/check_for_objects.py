"""The action check_for_objects of darknet_ros, which finds objects in an image that it is given."""

from typing import Callable

import actionlib
import rospy
from sensor_msgs.msg import Image

from ..common.plain_text import error_text
from ..msg import (
    BoundingBoxes,
    CheckForObjectsAction,
    CheckForObjectsGoal,
    CheckForObjectsResult,
)


class CheckForObjects:
    """Serves an action (darknet_ros_msgs/CheckForObjects).

    Args:
        name: The action's.
        search: A function that searches an image. Any thread may call it.
    """

    def __init__(self, name: str, search: Callable[[Image], BoundingBoxes]):
        self._search = search
        self._server = actionlib.SimpleActionServer(
            name, CheckForObjectsAction, self._execute, False
        )
        self._server.start()

    def _execute(self, goal: CheckForObjectsGoal) -> None:
        try:
            boxes = self._search(goal.image)
        except Exception as error:  # Of any kind, because actionlib would answer without a reason.
            reason = error_text(error)
            if not rospy.core.is_shutdown_requested():
                rospy.logerr("no objects searched for: %s", reason)
                self._server.set_aborted(text=reason)
            return
        if self._server.is_preempt_requested():
            self._server.set_preempted()
        else:
            self._server.set_succeeded(CheckForObjectsResult(goal.id, boxes))
