"""What the node says on /diagnostics: what is found, and of what is not the reason."""

from typing import Dict, Mapping, Sequence

import rospy
from diagnostic_msgs.msg import DiagnosticStatus

from ..common.plain_text import printable
from ..common.throttle import Throttle
from ..ros.status_topic import StatusTopic

PROBLEM_PERIOD = 30.0  # s until a problem is logged again


class RecognitionReport:
    """Publishes a status `<node>: objects`, once in ~diagnostic_period.

    Raises:
        ValueError: ~diagnostic_period is out of range.
    """

    def __init__(self) -> None:
        self._status = StatusTopic("objects")
        self._problem, self._logged = "", ""
        self._frame_problem = ""  # why nothing can be recognized in the newest image
        self._throttle = Throttle(PROBLEM_PERIOD)
        self._lacks: Sequence[str] = ()
        self._found: Dict[str, str] = {}  # what there is to say of each object, by name
        self._seen = 0  # objects in the newest image

    def set_problem(self, problem: str, lacks: Sequence[str] = ()) -> None:
        """Sets the reason why nothing can be recognized, or "", and what is left out."""
        news = [lack for lack in lacks if lack not in self._lacks]
        self._problem, self._lacks = problem, lacks
        self._found, self._seen = {}, 0
        if problem and (problem != self._logged or self._throttle.due()):
            self._logged = problem
            rospy.logerr("%s", problem)
        for lack in news:
            rospy.logwarn("%s", lack)

    @property
    def problem(self) -> str:
        """The reason why nothing can be recognized in any image, or ""."""
        return self._problem

    def set_frame_problem(self, problem: str) -> None:
        """Sets the reason why nothing can be recognized in the newest image."""
        self._found, self._seen, self._frame_problem = {}, 0, problem

    def set_frame(self, found: Mapping[str, str], seen: int) -> None:
        """Sets what is known by the newest image.

        Args:
            found: What there is to say of each object, by its name.
            seen: How many objects were recognized.
        """
        self._found, self._seen, self._frame_problem = dict(found), seen, ""

    def publish(self) -> None:
        """Publishes the status if it is due."""
        self._status.publish(lambda: (*self._summary(), self._values()))

    def end(self) -> None:
        """Publishes the status of the last image, as no other comes for now."""
        self._status.publish_untold()

    def _summary(self) -> "tuple[int, str]":
        if self._problem or self._frame_problem:
            return DiagnosticStatus.ERROR, self._problem or self._frame_problem
        if self._lacks:
            more = f" (and {len(self._lacks) - 1} more)" if len(self._lacks) > 1 else ""
            return DiagnosticStatus.WARN, self._lacks[0] + more
        return DiagnosticStatus.OK, f"{self._seen} recognized of {len(self._found)} known objects"

    def _values(self) -> Dict[str, str]:
        return {printable(name): text for name, text in sorted(self._found.items())}
