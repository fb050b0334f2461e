"""The node line_follower, which drives a robot along a line."""

import time
from typing import Any, Dict, Tuple

import rospy
from geometry_msgs.msg import Point, Twist

from .. import HsvMask, HsvRange, Line, LineParams, draw_outline, draw_text, find_line
from ..msg import Line as LineMessage
from ..ros.configs import LineFollowerConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.startup import run_node
from ..ros.transport import Frame, ReportedFrameError
from .drive import Drive
from .line_control import LineController, LineControlParams, must_stop

CONTROL = tuple(LineControlParams.__dataclass_fields__)


class LineFollower:
    """Publishes cmd_vel, ~line and ~processed_image (the image with the line outlined).

    ~roi is the part of the image that the line is looked for in, and ~mask is where its colour is.
    Subscribes to image. ~enable (std_srvs/SetBool) makes the robot stop, or drive again.
    """

    def __init__(self) -> None:
        self._made_of: Tuple[Any, ...] = ()  # what the controller was made of, and for which line
        self._followed = Line()  # the line that was seen last, unless that is too long ago
        self._seen = 0.0  # s of the monotonic clock, when that was
        self._searched: Tuple[Any, ...] = ()  # the size of its mask, of which part and color
        self._stamp = rospy.Time()  # of the last frame
        self._node = ImageNode(self._process)
        self._lines = self._node.publisher("~line", LineMessage)
        self._processed = self._node.image_publisher("~processed_image")
        self._roi = self._node.image_publisher("~roi")
        self._mask = self._node.image_publisher("~mask")
        self._drive = Drive(self._node.publisher("cmd_vel", Twist))
        self._params = LiveParams(LineFollowerConfig, self._configure)
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        line = filled(LineParams(), config)
        control = LineControlParams(**{name: config[name] for name in CONTROL})
        sought = config["strip"], filled(HsvRange(), config)
        mask = HsvMask(sought[1])
        # A new controller forgets where the line was, so it is made only when it has to be: also
        # when another color, or another part of the image, has another line.
        made_of = control, sought
        controller = self._tools[3] if made_of == self._made_of else LineController(control)
        self._made_of = made_of
        # Replaced in one step, because another thread may be processing a frame.
        self._tools = sought, mask, line, controller
        self._min_confidence = config["min_confidence"]
        self._drive.timeout = config["timeout"]

    def _process(self, frame: Frame) -> None:
        began, age = time.monotonic(), _age(frame.header.stamp)
        sought, color, params, controller = self._tools
        height = frame.image.shape[0]
        top = min(round(height * (1.0 - sought[0])), height - 1)
        mask = color.apply(frame.image[top:])
        searched = mask.shape, sought
        if began - self._seen > self._drive.timeout or searched != self._searched:
            self._followed = Line()
        self._searched = searched
        line = find_line(mask, params, self._followed)
        # Of a mask that fills the image it is 0, which is no line whatever the least may be.
        if line.confidence == 0.0 or line.confidence < self._min_confidence:
            line = Line()
        if line.found:
            self._followed, self._seen = line, began
        enabled = self._drive.enabled
        late = enabled and must_stop(age, 0.0, True, self._drive.timeout)
        if not enabled:
            controller.reset()  # Its sums belong to another place when the robot drives again.
        elif self._is_another(frame.header.stamp) and not late:
            # Where frames have no stamps the clock of ROS may stand still, too.
            stamp = frame.header.stamp.to_sec() or began
            late = not self._drive.command(*controller.update(stamp, line), began - age)
            age += time.monotonic() - began
        self._publish(frame, line, top)
        self._roi.publish(frame.image[top:], "bgr8", frame.header)
        self._mask.publish(mask, "mono8", frame.header)
        if late:
            self._refuse(age)

    def _is_another(self, stamp: rospy.Time) -> bool:
        """Returns whether a frame is not the last one again, as of a camera that hangs."""
        last, self._stamp = self._stamp, stamp
        return stamp.is_zero() or stamp != last

    def _refuse(self, age: float) -> None:
        """Has a frame counted as refused that was not driven on, so that diagnostics tell it."""
        if age < 0.0:
            reason = f"stamps are {-age:.2f} s ahead of the clock: these frames are not driven on"
        else:
            reason = f"frames are {age:.2f} s old: they are not driven on"
        rospy.logwarn_throttle(5.0, reason)
        raise ReportedFrameError(reason)

    def _publish(self, frame: Frame, line: Line, top: int) -> None:
        center = Point(line.center[0], line.center[1] + top, 0.0) if line.found else Point()
        self._lines.publish(
            LineMessage(frame.header, line.found, center, line.error, line.angle, line.confidence)
        )
        if self._processed.get_num_connections():
            overlay = frame.image.copy()
            if line.found:
                draw_outline(overlay[top:], line.outline, f"{line.error:+.2f}")
            else:
                draw_text(overlay, "no line", (10, 20))
            self._processed.publish(overlay, "bgr8", frame.header)


def _age(stamp: rospy.Time) -> float:
    """Returns the age in s by the clock of ROS; 0 for a zero stamp, whose sender knows no time."""
    return 0.0 if stamp.is_zero() else rospy.get_time() - stamp.to_sec()


def main() -> None:
    run_node("line_follower", LineFollower)
