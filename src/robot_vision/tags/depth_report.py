"""What the node says of a depth camera: on /diagnostics, and in the log if it does not fit."""

import time
from typing import Dict, Iterable, Tuple

import rospy
from diagnostic_msgs.msg import DiagnosticStatus

from .. import CameraModel, DepthErrorParams, TagPoseParams
from ..common.throttle import Throttle
from ..ros.depth_input import DepthInput
from ..ros.image_node import ImageNode
from ..ros.status_topic import StatusTopic
from .depth_check import DepthCheck
from .tag_poses import LocatedTag

SILENCE = 5.0  # s without a tag that a depth image shows, from which on they are told
WRONG_UNIT = 1.5  # times too large, or too small, from which on that is what is said


class DepthReport:
    """Publishes what a DepthCheck says, once in ~diagnostic_period while the node works.

    What was compared before the node was idle is forgotten.

    Args:
        node: The node.
        depth: The depth images; without a topic of them, nothing is published.

    Attributes:
        max_error: The error of a depth, in m, from which on the status is a warning.

    Raises:
        ValueError: ~diagnostic_period is out of range.
    """

    def __init__(self, node: ImageNode, depth: DepthInput):
        self.max_error = 0.0
        self._depth = depth
        self._check = DepthCheck()
        self._last_shown = 0.0  # s of the monotonic clock, when a depth image has shown a tag
        self._warnings = Throttle(10.0)
        self._status = StatusTopic("depth")
        node.on_idle(self._check.clear)

    def add(
        self,
        tags: Iterable[LocatedTag],
        camera: CameraModel,
        noise: TagPoseParams,
        depth_noise: DepthErrorParams,
    ) -> None:
        """Adds the tags of a frame with depth, as DepthCheck does."""
        if self._check.add(tags, camera, noise, depth_noise):
            self._last_shown = time.monotonic()
        if self._check.rejects() and self._warnings.due():
            rospy.logwarn("%s", misfit(self._check, self._depth.topic))

    def publish(self, lack: str = "") -> None:
        """Publishes the status if it is due.

        Args:
            lack: Why no tag has a pose that a depth could be compared with; empty if they have.
        """
        if self._depth.topic:
            self._status.publish(lambda: (*self._summary(lack), values(self._check)))

    def _summary(self, lack: str) -> Tuple[int, str]:
        problem = self._depth.problem() or lack
        if problem:
            return DiagnosticStatus.WARN, problem
        level, text = summary(self._check, self._depth.topic, self.max_error)
        silent = time.monotonic() - self._last_shown
        if self._check.left_out()[1] and silent >= SILENCE:
            text += f"; no tag was seen with depth for {silent:.0f} s"
        return level, text


def summary(check: DepthCheck, topic: str, max_error: float) -> Tuple[int, str]:
    """Returns the level and the text of a status."""
    if check.rejects():
        return DiagnosticStatus.WARN, misfit(check, topic)
    if not len(check.estimate):
        return DiagnosticStatus.OK, f"no tag was seen with depth on {topic}"
    errors = check.estimate.errors()
    depth, error = errors.worst(max_error)
    text = (
        f"scale {errors.scale:.4f} +- {errors.scale_error:.4f}, "
        f"bias {errors.bias:.4f} +- {errors.bias_error:.4f} m"
    )
    if error:
        return DiagnosticStatus.WARN, f"depths are off by {error:+.3f} m at {depth:.2f} m: {text}"
    return DiagnosticStatus.OK, f"depths fit the tags: {text}"


def values(check: DepthCheck) -> Dict[str, str]:
    """Returns the values of a status by name."""
    wrong, planes = check.left_out()
    found = {
        "tags compared": str(len(check.estimate)),
        "newest planes": str(planes),
        "newest planes left out": str(wrong),
    }
    if len(check.estimate):
        errors = check.estimate.errors()
        found.update(
            {
                "scale": f"{errors.scale:.6f}",
                "scale standard error": f"{errors.scale_error:.6f}",
                "bias (m)": f"{errors.bias:.6f}",
                "bias standard error (m)": f"{errors.bias_error:.6f}",
                "nearest (m)": f"{errors.nearest:.3f}",
                "farthest (m)": f"{errors.farthest:.3f}",
            }
        )
    return found


def misfit(check: DepthCheck, topic: str) -> str:
    """Returns that the depths do not fit the tags, and how."""
    wrong, planes = check.left_out()
    text = f"{wrong} of the last {planes} tags in the depth on {topic} do not fit their corners"
    if len(check.estimate):
        ratio = check.estimate.ratio()
        if ratio > WRONG_UNIT:
            text += f": it is {ratio:.2g} times too large"
        elif ratio * WRONG_UNIT < 1.0:
            text += f": it is {1.0 / ratio:.2g} times too small"
        else:
            depth, error = check.estimate.errors().worst(0.0)
            if error:
                text += f": it is off by {error:+.3f} m at {depth:.2f} m"
    hint = "is the unit right, is tag_size, or has depth_bias to be larger?"
    return f"{text}. They are left out: {hint}"
