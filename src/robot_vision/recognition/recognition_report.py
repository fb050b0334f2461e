"""What the node says on /diagnostics: what is found, and of what is not the reason."""

import time
from typing import Dict, List, Mapping, Sequence

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from ..common.plain_text import printable
from ..common.throttle import Throttle
from ..ros.params import read_param

PROBLEM_PERIOD = 30.0  # s until a problem is logged again


class RecognitionReport:
    """Publishes a status `<node>: objects`, once in ~diagnostic_period.

    Raises:
        ValueError: ~diagnostic_period is out of range.
    """

    def __init__(self) -> None:
        self._period = read_param("diagnostic_period", 1.0, 0.01, 3600.0)
        self._publisher = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=1)
        self._last = float("-inf")  # s of the monotonic clock, of the newest status
        self._problem, self._logged = "", ""
        self._throttle = Throttle(PROBLEM_PERIOD)
        self._lacks: Sequence[str] = ()
        self._found: Dict[str, str] = {}  # what there is to say of each object, by name
        self._seen = 0  # objects in the newest image

    def set_problem(self, problem: str, lacks: Sequence[str] = ()) -> None:
        """Sets the reason why nothing can be recognized, or "", and what is left out."""
        self._problem, self._lacks = problem, lacks
        self._found, self._seen = {}, 0
        if problem and (problem != self._logged or self._throttle.due()):
            self._logged = problem
            rospy.logerr("%s", problem)
        for lack in lacks:
            rospy.logwarn("%s", lack)

    @property
    def problem(self) -> str:
        """The reason why nothing can be recognized, or ""."""
        return self._problem

    def set_frame(self, found: Mapping[str, str], seen: int) -> None:
        """Sets what is known by the newest image.

        Args:
            found: What there is to say of each object, by its name.
            seen: How many objects were recognized.
        """
        self._found, self._seen = dict(found), seen

    def publish(self) -> None:
        """Publishes the status if it is due."""
        now = time.monotonic()
        if now - self._last < self._period:
            return
        self._last = now
        level, text = self._summary()
        status = DiagnosticStatus(
            level=level,
            name=f"{rospy.get_name().lstrip('/')}: objects",
            message=text,
            hardware_id="none",
            values=self._values(),
        )
        message = DiagnosticArray(status=[status])
        message.header.stamp = rospy.Time.now()
        self._publisher.publish(message)

    def _summary(self) -> "tuple[int, str]":
        if self._problem:
            return DiagnosticStatus.ERROR, self._problem
        if self._lacks:
            more = f" (and {len(self._lacks) - 1} more)" if len(self._lacks) > 1 else ""
            return DiagnosticStatus.WARN, self._lacks[0] + more
        return DiagnosticStatus.OK, f"{self._seen} recognized of {len(self._found)} known objects"

    def _values(self) -> List[KeyValue]:
        return [KeyValue(printable(name), text) for name, text in sorted(self._found.items())]
