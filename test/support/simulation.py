"""A robot on a floor with a line: its motion and the view of its camera, exact and deterministic.

Images are drawn like those of the synthetic scene, with exact rays, textures and anti-aliasing. The
floor is that of track.py. The robot's frame is that of REP 103: x forward, y left, the origin
between the wheels.
"""

import math
from dataclasses import dataclass
from typing import Dict, Optional, Tuple

import cv2
import numpy as np
from track import Pose, Track

from robot_vision import CameraModel, FloorScene

LINE_WIDTH = 0.06  # m, as kSceneLineWidth
LINE_COLOUR = (40, 190, 225)  # BGR: hue 24, saturation 210, within the line follower's range
FLOOR_COLOUR = (150, 150, 150)  # BGR: no saturation, out of that range


class DifferentialDrive:
    """Two driven wheels: the unicycle model, integrated exactly over each step."""

    def __init__(self, pose: Optional[Pose] = None) -> None:
        self.pose = pose or Pose()

    def drive(self, linear: float, angular: float, dt: float) -> Pose:
        """Drives for `dt` s with a speed in m/s and a turn rate in rad/s, counter-clockwise."""
        self.pose = self.pose.along_arc(linear * dt, angular * dt)
        return self.pose


@dataclass(frozen=True)
class FloorCamera:
    """A pinhole camera on the robot that looks ahead and so far down that it sees only floor."""

    width: int = 320  # px
    height: int = 240  # px
    focal: float = 277.0  # px; a horizontal field of view of 60 degrees
    forward: float = 0.1  # m ahead of the wheels
    above: float = 0.2  # m above the floor
    pitch: float = 0.6  # rad, downwards

    def __post_init__(self) -> None:
        half = math.atan2(self.height / 2.0, self.focal)
        if not half < self.pitch < math.pi - half:
            raise ValueError(f"pitch is {self.pitch:g}, the horizon would be in view")

    def model(self, top: int = 0) -> CameraModel:
        """The camera, or the part of it below the row `top`."""
        center = (self.width - 1) / 2.0, (self.height - 1) / 2.0 - top
        matrix = [[self.focal, 0.0, center[0]], [0.0, self.focal, center[1]], [0.0, 0.0, 1.0]]
        return CameraModel(self.width, self.height - top, np.array(matrix))

    def pose_on(self, robot: Pose) -> np.ndarray:
        """The camera's optical frame (x right, y down, z ahead) in the floor's frame: 4x4, m."""
        cos, sin = math.cos(robot.heading), math.sin(robot.heading)
        ahead, left, up = np.array([cos, sin, 0.0]), np.array([-sin, cos, 0.0]), np.eye(3)[2]
        level, steep = math.cos(self.pitch), math.sin(self.pitch)
        pose = np.eye(4)
        pose[:3, :3] = np.transpose(
            [-left, -steep * ahead - level * up, level * ahead - steep * up]
        )
        pose[:3, 3] = np.array([robot.x, robot.y, 0.0]) + self.forward * ahead + self.above * up
        return pose

    def floor_points(self) -> Tuple[np.ndarray, np.ndarray]:
        """The points where the rays of the pixels meet the floor.

        Returns:
            Forward and left in the robot's frame, m: (height, width) float32 each.
        """
        right = (np.arange(self.width) - (self.width - 1) / 2.0) / self.focal
        down = (np.arange(self.height) - (self.height - 1) / 2.0)[:, None] / self.focal
        cos, sin = math.cos(self.pitch), math.sin(self.pitch)
        depth = self.above / (sin + down * cos)  # along the optical axis
        ahead = np.broadcast_to(
            self.forward + depth * (cos - down * sin), (self.height, self.width)
        )
        return ahead.astype(np.float32), (-right * depth).astype(np.float32)


class TrackWorld:
    """A gray floor with a yellow line along a track, as the robot's camera sees it."""

    _TEXEL = 0.0025  # m, on the floor
    _NOISE_PLACES = 1 << 16  # places in the noise where that of a frame may begin

    def __init__(
        self,
        track: Track,
        camera: Optional[FloorCamera] = None,
        noise: float = 2.0,
        seed: int = 1,
    ) -> None:
        """`noise` is the standard deviation of the pixel noise in gray levels, `seed` its seed."""
        self.track = track
        self.camera = camera or FloorCamera()
        self._floor, self._size, self._middle = _paint(track, self._TEXEL)
        self._scenes: Dict[int, FloorScene] = {}  # first drawn row -> scene
        random = np.random.RandomState(seed)
        values = self.camera.height * self.camera.width * 3 + self._NOISE_PLACES
        self._noise = np.rint(random.normal(0.0, noise, values)).astype(np.int16)
        self._begins = random.randint(0, self._NOISE_PLACES, 4096)

    def render(self, pose: Pose, frame: int = 0, top: int = 0) -> np.ndarray:
        """The image from a pose; the same arguments give the same image.

        Args:
            pose: the robot's pose.
            frame: the number of the frame, on which the noise depends.
            top: the first row to be drawn, for users of the lower part only.

        Returns:
            (height - top, width, 3) uint8, BGR.
        """
        if top not in self._scenes:
            model = self.camera.model(top)
            self._scenes[top] = FloorScene(self._floor, self._size, model, FLOOR_COLOUR)
        x, y = pose.x - self._middle[0], pose.y - self._middle[1]
        image = self._scenes[top].render(self.camera.pose_on(Pose(x, y, pose.heading)))
        begin = self._begins[frame % len(self._begins)] + 3 * self.camera.width * top
        noise = self._noise[begin : begin + image.size].reshape(image.shape)
        return cv2.add(image, noise, dtype=cv2.CV_8U)


def _paint(
    track: Track, texel: float
) -> Tuple[np.ndarray, Tuple[float, float], Tuple[float, float]]:
    """The floor around a track, seen from above: its image, its size and its middle, m.

    Returns:
        (height, width, 3) uint8, BGR, its top towards +x and its left side towards +y; (width,
        height); (x, y).
    """
    left, right, back, front = track.bounds(2.0 * LINE_WIDTH)
    columns, rows = (math.ceil(length / texel) for length in (left - right, front - back))
    x = front - (np.arange(rows, dtype=np.float32)[:, None] + 0.5) * np.float32(texel)
    y = left - (np.arange(columns, dtype=np.float32) + 0.5) * np.float32(texel)
    x, y = np.broadcast_arrays(x, y)
    lateral, _ = track.locate(x.ravel(), y.ravel(), LINE_WIDTH / 2.0 + texel)
    at = np.flatnonzero(~np.isnan(lateral))
    part = np.clip(0.5 + (LINE_WIDTH / 2.0 - np.abs(lateral[at])) / texel, 0.0, 1.0)[:, None]
    floor = np.full((lateral.size, 3), FLOOR_COLOUR, np.uint8)
    floor[at] = np.rint(part * LINE_COLOUR + (1.0 - part) * FLOOR_COLOUR)
    size = columns * texel, rows * texel
    return floor.reshape(rows, columns, 3), size, (front - size[1] / 2.0, left - size[0] / 2.0)
