"""Shared by the tests of stereo_matcher: a calibrated pair of cameras that publishes."""

import itertools
from typing import Any, Sequence

import numpy as np
import rospy
from frames import Source, message
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header
from stereo_images import HEIGHT, WIDTH

SIDES = ("left", "right")
FOCAL, CX, CY, BASELINE = 180.0, 101.0, 58.0, 0.15  # px, m

numbers = itertools.count()


def info_of(side: str, offset: float = 0.0) -> CameraInfo:
    """The calibration of a pair without distortion, rectified already.

    Args:
        offset: px, principal point of the left image minus that of the right one.
    """
    left = side == "left"
    cx = CX if left else CX - offset
    matrix = [FOCAL, 0.0, cx, 0.0, FOCAL, CY, 0.0, 0.0, 1.0]
    return CameraInfo(
        width=WIDTH,
        height=HEIGHT,
        distortion_model="plumb_bob",
        D=[0.0] * 5,
        K=matrix,
        R=np.eye(3).ravel().tolist(),
        P=[*matrix[:3], 0.0 if left else -FOCAL * BASELINE, *matrix[3:6], 0.0, *matrix[6:], 0.0],
    )


class StereoCameras:
    """Publishes images of both cameras, and before each of them its camera_info."""

    def __init__(self) -> None:
        self.namespace = f"/eyes_{next(numbers)}"
        self.images = {side: Source(self.topic(side, "image_raw"), Image) for side in SIDES}
        self.infos = {side: Source(self.topic(side, "camera_info"), CameraInfo) for side in SIDES}
        self.calibration = {side: info_of(side) for side in SIDES}  # may be replaced at any time
        self._stamps = (rospy.Time(100 + number) for number in itertools.count())

    def topic(self, side: str, name: str) -> str:
        return f"{self.namespace}/{side}/{name}"

    def arguments(self) -> Sequence[str]:
        """What remaps the node's images."""
        return [f"{side}/image_raw:={self.topic(side, 'image_raw')}" for side in SIDES]

    def wait_for(self, connections: int = 1) -> None:
        for source in (*self.images.values(), *self.infos.values()):
            source.wait_for(connections)

    def send(
        self, side: str, pixels: np.ndarray, stamp: Any, encoding: str = "mono8", **fields: Any
    ) -> None:
        """Sends the image of one camera, some of whose fields may be set to anything."""
        header = Header(stamp=stamp, frame_id=f"{side}_eye")
        info = self.calibration[side]
        info.header = header
        self.infos[side].send(info)
        image = message(pixels, encoding)
        image.header = header
        for name, value in fields.items():
            setattr(image, name, value)
        self.images[side].send(image)

    def show(self, left: np.ndarray, right: np.ndarray, encoding: str = "mono8") -> rospy.Time:
        """Sends a pair; returns its stamp."""
        stamp = next(self._stamps)
        for side, pixels in zip(SIDES, (left, right)):
            self.send(side, pixels, stamp, encoding)
        return stamp
