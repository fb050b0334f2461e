"""Shared by the tests of nodes that need camera_info: images, and the calibration beside them."""

from typing import Any

import numpy as np
from frames import Camera, Source
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

from robot_vision import CameraModel


def info_of(camera: CameraModel) -> CameraInfo:
    """The message of a camera."""
    return CameraInfo(
        width=camera.width,
        height=camera.height,
        K=np.ravel(camera.K).tolist(),
        D=list(camera.D),
        distortion_model=camera.distortion_model,
    )


class CalibratedCamera(Camera):
    """Publishes images and, before each of them, camera_info.

    Args:
        rate: Of the stamps, Hz.
        info: What is published beside the images; it may be replaced at any time.
    """

    def __init__(self, rate: float, info: CameraInfo):
        super().__init__(rate)
        self.info = info
        self._infos = Source(self.topic.replace("image", "camera_info"), CameraInfo)

    def wait_for(self, connections: int = 1) -> None:
        super().wait_for(connections)
        self._infos.wait_for(connections)

    def show(self, pixels: np.ndarray, encoding: str = "bgr8", **options: Any) -> Header:
        self._infos.send(self.info)
        return super().show(pixels, encoding, **options)
