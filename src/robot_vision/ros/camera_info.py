"""The camera model of an image topic, from the camera_info beside it."""

import threading
import time
from typing import Any, Optional, Tuple

import rospy
from sensor_msgs.msg import CameraInfo

from .. import CameraModel, is_calibrated
from ..common.repeats import Repeats
from .image_node import ImageNode
from .transport import camera_info_beside, remapped_camera_info

TOLD_AGAIN = 5.0  # s until the same kind of problem is logged again
PATIENCE = 2.0  # s without camera_info until its lack is logged


class Calibration:
    """Keeps the newest camera_info of a node's images, whatever its stamp is.

    It also serves images without a stamp. The camera_info is expected on the topic camera_info if
    that name is remapped, and otherwise beside the image: for /usb_cam/image_raw on
    /usb_cam/camera_info.

    Args:
        node: The node that processes the images.
        missing: What the node cannot provide without camera_info, for the warning.
    """

    def __init__(self, node: ImageNode, missing: str):
        self.topic = remapped_camera_info() or camera_info_beside(node.topic)
        self._missing = missing
        self._info: Optional[CameraInfo] = None
        self._came = threading.Event()
        self._used: Tuple[Any, ...] = ()  # the values that the camera was made from
        self._camera: Optional[CameraModel] = None
        self._wrong = ""  # the problem of the newest camera_info
        self._problem = ""  # the problem logged last
        self._told = Repeats(TOLD_AGAIN)
        self._first_asked = 0.0  # s of the monotonic clock
        node.subscriber(self.topic, CameraInfo, self._on_info)

    def camera(self, size: Tuple[int, int]) -> Optional[CameraModel]:
        """Returns the camera model for images of `size`, (width, height) in px.

        The same object is returned until the camera changes. If the camera is not known, None is
        returned, and one warning gives the reason.
        """
        info = self._info  # Other threads replace it.
        if info is None:
            self._complain_later()
            return None
        used = size, info.width, info.height, info.K, info.D, info.distortion_model
        if used != self._used:
            self._used = used
            self._camera, self._wrong = None, ""
            try:
                self._camera = camera_model(info, size)
            except ValueError as error:
                self._wrong = str(error)
        self._tell(self._wrong)
        return self._camera

    def wait(self, seconds: float) -> None:
        """Waits at most `seconds` for the first camera_info; the node has to be working."""
        self._came.wait(seconds)

    @property
    def frame_id(self) -> str:
        """The frame_id of the camera by its camera_info, or "" if that is not known."""
        return self._info.header.frame_id if self._info else ""

    def camera_at_once(self, size: Tuple[int, int]) -> CameraModel:
        """Returns the camera model for a single image; nothing is remembered or logged.

        Raises:
            ValueError: The camera is not known; the message gives the reason.
        """
        try:
            if self._info is None:
                raise ValueError("there is none")
            return camera_model(self._info, size)
        except ValueError as error:
            why = f"no {self._missing}: camera_info on {self.topic}: {error}"
            raise ValueError(why) from None

    def _on_info(self, info: CameraInfo) -> None:
        self._info = info
        self._came.set()

    def _complain_later(self) -> None:
        now = time.monotonic()
        self._first_asked = self._first_asked or now
        if now - self._first_asked > PATIENCE:
            self._tell("there is none")

    def _tell(self, problem: str) -> None:
        kind = problem.split(" is ")[0]  # A value that follows may change with every message.
        if problem == self._problem or not self._told.news([kind], time.monotonic()):
            return
        self._problem = problem
        if problem:
            rospy.logwarn("no %s: camera_info on %s: %s", self._missing, self.topic, problem)
        else:
            rospy.loginfo("%s from now on: camera_info on %s", self._missing, self.topic)


def camera_model(info: CameraInfo, size: Tuple[int, int]) -> CameraModel:
    """Returns the camera model for images of `size`, (width, height) in px.

    Raises:
        ValueError: The camera is not calibrated, camera_info belongs to images of another size,
            or its distortion model is not known here.
    """
    if not is_calibrated(info.K):
        raise ValueError("the camera is not calibrated")
    if (info.width, info.height) != size:
        raise ValueError(
            f"camera_info is of {info.width}x{info.height}, the picture {size[0]}x{size[1]}"
        )
    return CameraModel(info.width, info.height, info.K, info.D, info.distortion_model)
