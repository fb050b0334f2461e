"""The action check_for_objects of darknet_ros, which finds objects in an image that it is given."""

from typing import Callable

import rospy
from sensor_msgs.msg import Image

from ..common.plain_text import error_text
from ..msg import (
    BoundingBoxes,
    CheckForObjectsAction,
    CheckForObjectsGoal,
    CheckForObjectsResult,
)
from ..ros.actions import SimpleActionServer, action_server
from ..ros.context import current


class CheckForObjects:
    """Serves an action (darknet_ros_msgs/CheckForObjects).

    Args:
        name: The action's.
        search: A function that searches an image. Any thread may call it.
    """

    def __init__(self, name: str, search: Callable[[Image], BoundingBoxes]):
        self._search = search
        action_server(name, CheckForObjectsAction, self._execute)

    def _execute(self, server: SimpleActionServer, goal: CheckForObjectsGoal) -> None:
        try:
            boxes = self._search(goal.image)
        except Exception as error:  # Of any kind, because actionlib would answer without a reason.
            reason = error_text(error)
            if not current().is_ending():
                rospy.logerr("no objects searched for: %s", reason)
                server.set_aborted(text=reason)
            return
        if server.is_preempt_requested():
            server.set_preempted()
        else:
            server.set_succeeded(CheckForObjectsResult(goal.id, boxes))
