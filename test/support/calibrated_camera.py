"""Shared by the tests of nodes that need camera_info: images, and the calibration beside them."""

import copy
from typing import Any, Callable, Tuple

import numpy as np
import rospy
import support
from frames import Camera, Source
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

from robot_vision import CameraModel, draw_text


def info_of(camera: CameraModel) -> CameraInfo:
    """The message of a camera."""
    return CameraInfo(
        width=camera.width,
        height=camera.height,
        K=np.ravel(camera.K).tolist(),
        D=list(camera.D),
        distortion_model=camera.distortion_model,
    )


def of_whole_sensor(info: CameraInfo) -> CameraInfo:
    """What a driver says that makes the same images of two by two pixels each."""
    whole = copy.deepcopy(info)
    whole.width, whole.height = 2 * info.width, 2 * info.height
    whole.binning_x = whole.binning_y = 2
    for name, columns in (("K", 3), ("P", 4)):
        rows = np.reshape(getattr(info, name), (3, columns))
        setattr(whole, name, (np.diag([2.0, 2.0, 1.0]) @ rows).ravel().tolist())
    return whole


def not_calibrated(image: np.ndarray) -> np.ndarray:
    """What a node shows of an image as long as it does not know the camera."""
    drawn = image.copy()
    draw_text(drawn, "no calibration: see what the node has printed", (10, 20))
    return drawn


def show_until_known(
    show: Callable[[np.ndarray], Tuple[rospy.Time, np.ndarray]], image: np.ndarray
) -> Tuple[rospy.Time, np.ndarray]:
    """Shows an image until the node knows the camera, as camera_info may come later.

    Args:
        show: Sends an image, and returns its stamp and what the node shows of it.
    """

    def known() -> Any:
        stamp, shown = show(image)
        return not np.array_equal(shown, not_calibrated(image)) and (stamp, shown)

    return support.wait_for(known, "the camera to be known")


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
