"""The action recognize_objects, which recognizes objects in the next image."""

from typing import Callable, List, Optional

import rospy

from ..common.plain_text import error_text
from ..msg import ObjectRecognitionAction, ObjectRecognitionGoal, ObjectRecognitionResult
from ..msg import RecognizedObjectArray as Array
from ..ros.actions import SimpleActionServer, action_server
from ..ros.context import current
from ..ros.frame_calls import FrameCalls
from .found import Limits, limits_of

TIMEOUT = 10.0  # s that a goal waits for an image and what is in it
Result = Callable[[Optional[Limits]], Array]  # what was recognized within limits


class RecognizeAction:
    """Serves an action under one or more names.

    Args:
        names: The names.
        calls: What waits for the next image; the node offers it functions of type Result.
    """

    def __init__(self, names: List[str], calls: FrameCalls):
        self._calls = calls
        for name in names:
            action_server(name, ObjectRecognitionAction, self._execute)

    def _execute(self, server: SimpleActionServer, goal: ObjectRecognitionGoal) -> None:
        try:
            limits = limits_of(goal.filter_limits) if goal.use_roi else None
            with self._calls.working():
                made = self._calls.wait(TIMEOUT, lambda: _is_over(server))
            server.set_succeeded(ObjectRecognitionResult(made(limits)))
        except Exception as error:  # Of any kind, because actionlib would answer without a reason.
            reason = error_text(error)
            if server.is_preempt_requested():
                server.set_preempted(text=reason)
            elif not current().is_ending():
                rospy.logerr("no objects recognized: %s", reason)
                server.set_aborted(text=reason)


def _is_over(server: SimpleActionServer) -> bool:
    return server.is_preempt_requested() or current().is_ending()
