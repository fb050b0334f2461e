"""Steering along a line: computes speed and turn from the line in the image. Uses no ROS."""

import math
from dataclasses import dataclass
from typing import Optional, Tuple

from .._core import Line
from ..common.plain_text import printable
from ..common.ranges import require_range

MODES = ("course", "pid")


@dataclass(frozen=True)
class LineControlParams:
    """The parameters of a LineController.

    Raises:
        ValueError: A field is out of range; the message has its name, its value and the range.
    """

    mode: str = "course"  # course: full speed, gain and dead band; pid: kp, ki, kd and curve speed
    linear_speed: float = 0.2  # m/s, 0 to 5
    max_angular: float = 0.3  # rad/s, largest turn of all, 0 to 10
    gain: float = 0.3  # course: rad/s for each px of the line's offset, 0 to 10
    dead_band: float = 20.0  # course: px, largest offset that is not steered against, 0 to 10000
    kp: float = 1.0  # pid: rad/s for an error of 1, half an image width, 0 to 100
    ki: float = 0.0  # pid: rad/s for an error of 1 over 1 s, 0 to 100
    kd: float = 0.1  # pid: rad/s for an error that changes by 1 in 1 s, 0 to 100
    min_speed: float = 0.05  # pid: m/s where the line is farthest off or across, 0 to 5
    timeout: float = 0.5  # s after a line, in which its error still says something, 0.05 to 10
    search: bool = False  # whether to turn to where the line was lost, instead of stopping at once
    search_angular: float = 0.3  # rad/s, 0 to 10; max_angular limits it, too
    search_timeout: float = 3.0  # s, longest search before the robot stops, 0 to 60

    def __post_init__(self) -> None:
        if self.mode not in MODES:
            raise ValueError(f"mode is {printable(self.mode)}, must be {' or '.join(MODES)}")
        require_range("linear_speed", self.linear_speed, 0, 5)
        require_range("max_angular", self.max_angular, 0, 10)
        require_range("gain", self.gain, 0, 10)
        require_range("dead_band", self.dead_band, 0, 10000)
        for name in ("kp", "ki", "kd"):
            require_range(name, getattr(self, name), 0, 100)
        require_range("min_speed", self.min_speed, 0, 5)
        require_range("timeout", self.timeout, 0.05, 10)
        require_range("search_angular", self.search_angular, 0, 10)
        require_range("search_timeout", self.search_timeout, 0, 60)


class LineController:
    """Keeps a line in the middle of the image. As in ROS, a positive angular speed turns left."""

    def __init__(self, params: Optional[LineControlParams] = None) -> None:
        """Makes a controller; without `params` it behaves like the course's."""
        self._params = params or LineControlParams()
        self.reset()

    def reset(self) -> None:
        """Forgets all past lines, for a robot that was paused or carried elsewhere."""
        self._time: Optional[float] = None  # s, the last line
        self._updated = -math.inf  # s, the last call of update()
        self._error = 0.0  # of the last line
        self._integral = 0.0  # of the error over time, in s
        self._lost_since: Optional[float] = None  # s; None before any line, and while there is one

    def update(self, time: float, line: Optional[Line]) -> Tuple[float, float]:
        """Returns the command for the line in one frame.

        Args:
            time: The time of the frame in s. An earlier time than the last one resets the
                controller, and so does one that is more than `timeout` later: the robot has
                stood meanwhile, and may be elsewhere.
            line: The result of find_line(); None means the same as a line that was not found.

        Returns:
            The linear speed in m/s, and the angular speed in rad/s, counter-clockwise.
        """
        found = line is not None and line.found
        is_found_again = found and self._lost_since is not None
        if not 0.0 <= time - self._updated <= self._params.timeout or is_found_again:
            self.reset()
        self._updated = time
        if not found:
            return self._search(time)
        if self._params.mode == "course":
            command = self._params.linear_speed, self._steer(line.offset)
        else:
            command = self._speed(line), self._pid(time, line.error)
        self._time, self._error = time, line.error
        return command

    def _steer(self, offset: float) -> float:
        if abs(offset) <= self._params.dead_band:
            return 0.0
        return -_clip(self._params.gain * offset, self._params.max_angular)

    def _pid(self, time: float, error: float) -> float:
        params = self._params
        dt = 0.0 if self._time is None else time - self._time
        change = (error - self._error) / dt if dt > 0.0 else 0.0
        integral = self._integral + error * dt
        turn = params.kp * error + params.ki * integral + params.kd * change
        # Anti-windup: at the limit of the turn the integral may only shrink.
        if abs(turn) <= params.max_angular or abs(integral) < abs(self._integral):
            self._integral = integral
        turn = params.kp * error + params.ki * self._integral + params.kd * change
        return -_clip(turn, params.max_angular)

    def _speed(self, line: Line) -> float:
        """Returns the linear speed in m/s; it falls with the line's error and its angle."""
        askew = min(max(abs(line.error), abs(math.sin(line.angle))), 1.0)
        fastest = self._params.linear_speed
        slowest = min(self._params.min_speed, fastest)
        return fastest - (fastest - slowest) * askew

    def _search(self, time: float) -> Tuple[float, float]:
        if self._time is None:
            return 0.0, 0.0  # There was no line yet.
        if self._lost_since is None:
            self._lost_since = time
        searching = time - self._lost_since < self._params.search_timeout
        if not self._params.search or not searching or self._error == 0.0:
            return 0.0, 0.0
        turn = min(self._params.search_angular, self._params.max_angular)
        return 0.0, -math.copysign(turn, self._error)


def must_stop(now: float, last_frame: Optional[float], enabled: bool, timeout: float = 0.5) -> bool:
    """Returns whether the robot must stand still, whatever was commanded last.

    Args:
        now: The present time in s.
        last_frame: The time of the last frame in s of the same clock; None before the first.
        enabled: Whether the line follower may drive.
        timeout: The age in s up to which a frame is worth driving on. A frame from the future is
            treated alike: the clock was set back, and the true age is not known.
    """
    if not enabled or last_frame is None:
        return True
    return not abs(now - last_frame) <= timeout  # This is also true for NaN.


def _clip(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
