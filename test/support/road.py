"""Roads on the floor whose lane is known exactly, as a robot's camera sees them."""

import math
from dataclasses import dataclass
from typing import Optional, Sequence, Tuple

import numpy as np
from simulation import FloorCamera
from track import Pose

from robot_vision import CameraModel, FloorScene

WIDTH = 0.4  # m, between the middles of a lane's lines
LINE_WIDTH = 0.02  # m
DASH = 0.1  # m, of a dashed line and of the gap behind it
WHITE, YELLOW, FLOOR = (230, 230, 230), (40, 190, 225), (150, 150, 150)  # BGR
FRONT, BACK, SIDE = 1.7, -0.3, 1.0  # m, of what is painted around the robot
CAMERA = FloorCamera(focal=200.0, above=0.25, pitch=0.6, forward=0.0)


@dataclass(frozen=True)
class Line:
    """A line of a road: its distance to the left of the lane's middle (m), color and kind."""

    left: float
    color: Tuple[int, int, int] = WHITE
    dashed: bool = False
    width: float = LINE_WIDTH


LANE = (Line(WIDTH / 2.0), Line(-WIDTH / 2.0, YELLOW, dashed=True))


class Road:
    """A road of constant curvature.

    Args:
        curvature: Of the lane's middle, 1/m, to the left positive.
        lines: What is painted.
        distortion: Of the camera's lens, k1, k2, p1 and p2.
        shadows: Whether a band across the road and one along it have half of the light.
        grain: Standard deviation of the floor's own pattern, gray levels.
        floor: Its color, BGR.
        camera: How the camera is mounted.
    """

    _TEXEL = 0.0025  # m

    def __init__(
        self,
        curvature: float = 0.0,
        lines: Sequence[Line] = LANE,
        distortion: Sequence[float] = (),
        shadows: bool = False,
        grain: float = 0.0,
        floor: Tuple[int, int, int] = FLOOR,
        camera: FloorCamera = CAMERA,
    ) -> None:
        self._mounting = camera
        model = camera.model()
        self.camera = CameraModel(model.width, model.height, model.K, list(distortion))
        x = FRONT - (np.arange(round((FRONT - BACK) / self._TEXEL))[:, None] + 0.5) * self._TEXEL
        y = SIDE - (np.arange(round(2.0 * SIDE / self._TEXEL)) + 0.5) * self._TEXEL
        image = np.empty((len(x), len(y), 3))
        image[:] = floor
        image += np.random.RandomState(1).normal(0.0, grain, (*image.shape[:2], 1))
        beside, along = _from_middle(x, y, curvature)
        for line in lines:
            self._paint(image, line, beside, along)
        if shadows:
            across = (x + 0.7 * y > 0.45) & (x + 0.7 * y < 0.75)
            image[across | ((y - 0.3 * x > 0.02) & (y - 0.3 * x < 0.12))] *= 0.5
        size = 2.0 * SIDE, FRONT - BACK
        self._scene = FloorScene(np.uint8(np.clip(np.rint(image), 0, 255)), size, self.camera)

    def view(self, offset: float, heading: float, noise: float = 2.0, frame: int = 0) -> np.ndarray:
        """The image of a robot that is `offset` m to the left of the middle and turned to the left.

        Args:
            offset: m.
            heading: rad, against the lane.
            noise: Standard deviation of the noise of the pixels, gray levels.
            frame: The number of the frame, on which the noise depends.
        """
        robot = Pose(-(FRONT + BACK) / 2.0, offset, heading)  # in the frame of the painted floor
        image = self._scene.render(self._mounting.pose_on(robot))
        random = np.random.RandomState(frame)
        return np.uint8(np.clip(np.rint(image + random.normal(0.0, noise, image.shape)), 0, 255))

    def _paint(self, image: np.ndarray, line: Line, beside: np.ndarray, along: np.ndarray) -> None:
        reach = line.width / 2.0 - np.abs(beside - line.left)
        part = np.clip(0.5 + reach / self._TEXEL, 0.0, 1.0)
        if line.dashed:
            part *= np.mod(along, 2.0 * DASH) < DASH
        image[:] += part[:, :, None] * (np.array(line.color) - image)


def _from_middle(x: np.ndarray, y: np.ndarray, curvature: float) -> Tuple[np.ndarray, np.ndarray]:
    """How far places are to the left of the circle through the origin, and along it, m."""
    x, y = np.broadcast_arrays(x, y)
    if curvature == 0.0:
        return y, x
    radius = 1.0 / curvature
    side = math.copysign(1.0, radius)
    beside = radius - side * np.hypot(x, radius - y)
    return beside, radius * np.arctan2(side * x, side * (radius - y))


def corners_in_image(near: float, far: float, camera: Optional[CameraModel] = None) -> np.ndarray:
    """Where the lines of a straight lane are, in shares of the image.

    Returns:
        (4, 2): near left, near right, far left and far right of a robot in the lane's middle.
    """
    camera = camera or CAMERA.model()
    pose = np.linalg.inv(CAMERA.pose_on(Pose()))
    places = np.array([(x, y, 0.0) for x in (near, far) for y in (WIDTH / 2.0, -WIDTH / 2.0)])
    pixels, _ = camera.project(places @ pose[:3, :3].T + pose[:3, 3])
    return (pixels + 0.5) / (camera.width, camera.height)
