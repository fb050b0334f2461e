"""A robot on a floor with a line: how it moves, and what its camera sees. Exact and deterministic.

The floor is that of track.py. The robot's own frame is that of REP 103: x forward, y left, the
origin between the wheels.
"""

import math
from dataclasses import dataclass
from typing import Optional, Tuple

import numpy as np

from .track import Pose, Track

LINE_WIDTH = 0.06  # m, as kSceneLineWidth
LINE_COLOUR = (40, 190, 225)  # BGR: hue 24, saturation 210, within the line follower's range
FLOOR_COLOUR = (150, 150, 150)  # BGR: no saturation, out of it


class DifferentialDrive:
    """Two driven wheels: the unicycle model, integrated exactly over each step.

    Attributes:
        pose: where the robot is.
        linear: its speed, m/s.
        angular: its turn, rad/s, counter-clockwise.
    """

    def __init__(
        self,
        pose: Optional[Pose] = None,
        wheel_distance: float = 0.16,
        linear_acceleration: float = math.inf,
        angular_acceleration: float = math.inf,
    ) -> None:
        """Wheel distance in m, largest accelerations in m/s^2 and rad/s^2."""
        self.pose = pose or Pose()
        self.linear = 0.0
        self.angular = 0.0
        self._wheel_distance = wheel_distance
        self._linear_acceleration = linear_acceleration
        self._angular_acceleration = angular_acceleration

    def drive(self, linear: float, angular: float, dt: float) -> Pose:
        """Drives on for `dt` s; both speeds change, as far as they may in `dt`, at its start."""
        self.linear = _approach(self.linear, linear, self._linear_acceleration * dt)
        self.angular = _approach(self.angular, angular, self._angular_acceleration * dt)
        self.pose = self.pose.along_arc(self.linear * dt, self.angular * dt)
        return self.pose

    def drive_wheels(self, left: float, right: float, dt: float) -> Pose:
        """As drive(), with the speeds of the wheels over the floor, m/s."""
        return self.drive((left + right) / 2.0, (right - left) / self._wheel_distance, dt)


@dataclass(frozen=True)
class FloorCamera:
    """A pinhole camera on the robot, looking ahead and down so far that it sees only floor."""

    width: int = 320  # px
    height: int = 240  # px
    focal: float = 277.0  # px: 60 degrees across
    forward: float = 0.1  # m ahead of the wheels
    above: float = 0.2  # m above the floor
    pitch: float = 0.6  # rad, downwards

    def __post_init__(self) -> None:
        half = math.atan2(self.height / 2.0, self.focal)
        if not half < self.pitch < math.pi - half:
            raise ValueError(f"pitch is {self.pitch:g}, the horizon would be in view")

    def floor_points(self) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Where the pixels' rays meet the floor, and the size of a pixel there.

        Returns:
            Forward and left in the robot's frame, m, and m per px: (height, width) float32 each.
        """
        right = (np.arange(self.width) - (self.width - 1) / 2.0) / self.focal
        down = (np.arange(self.height) - (self.height - 1) / 2.0)[:, None] / self.focal
        cos, sin = math.cos(self.pitch), math.sin(self.pitch)
        depth = self.above / (sin + down * cos)  # along the optical axis
        ahead = np.broadcast_to(
            self.forward + depth * (cos - down * sin), (self.height, self.width)
        )
        size = np.broadcast_to(depth / self.focal, (self.height, self.width))
        return (
            ahead.astype(np.float32),
            (-right * depth).astype(np.float32),
            size.astype(np.float32),
        )


class TrackWorld:
    """A grey floor with a yellow line along a track, as the robot's camera sees it."""

    _NOISE_PLACES = 1 << 16  # where the noise of a frame may begin

    def __init__(
        self,
        track: Track,
        camera: Optional[FloorCamera] = None,
        noise: float = 2.0,
        seed: int = 1,
    ) -> None:
        """`noise` is the standard deviation of the pixel noise in grey levels, `seed` its seed."""
        self.track = track
        self.camera = camera or FloorCamera()
        self._ahead, self._left, self._pixel = self.camera.floor_points()
        random = np.random.RandomState(seed)
        values = self.camera.height * self.camera.width * 3 + self._NOISE_PLACES
        self._noise = np.rint(random.normal(0.0, noise, values)).astype(np.int16)
        self._begins = random.randint(0, self._NOISE_PLACES, 4096)

    def render(self, pose: Pose, frame: int = 0, top: int = 0) -> np.ndarray:
        """The picture from a pose, the same for the same arguments.

        Args:
            pose: of the robot.
            frame: its number; the noise differs from one to the next.
            top: the first row that is drawn, for who looks at the lower part only.

        Returns:
            (height - top, width, 3) uint8, BGR.
        """
        ahead, left, pixel = self._ahead[top:], self._left[top:], self._pixel[top:]
        cos, sin = np.float32(math.cos(pose.heading)), np.float32(math.sin(pose.heading))
        x = np.float32(pose.x) + cos * ahead - sin * left
        y = np.float32(pose.y) + sin * ahead + cos * left
        within = LINE_WIDTH / 2.0 + float(pixel.max())
        lateral, _ = self.track.locate(x.ravel(), y.ravel(), within)

        picture = np.full((lateral.size, 3), FLOOR_COLOUR, np.int16)
        at = np.flatnonzero(~np.isnan(lateral))
        edge = (LINE_WIDTH / 2.0 - np.abs(lateral[at])) / pixel.ravel()[at]  # px inside the line
        part = np.clip(0.5 + edge, 0.0, 1.0)[:, None]
        picture[at] = np.rint(part * LINE_COLOUR + (1.0 - part) * FLOOR_COLOUR)

        begin = self._begins[frame % len(self._begins)] + 3 * self.camera.width * top
        picture += self._noise[begin : begin + picture.size].reshape(picture.shape)
        return np.clip(picture, 0, 255).astype(np.uint8).reshape(*ahead.shape, 3)


def _approach(value: float, target: float, most: float) -> float:
    """`target`, or as near to it as a change by `most` brings `value`."""
    return value + min(max(target - value, -most), most)
