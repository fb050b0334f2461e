"""The camera of a topic of pictures, by the camera_info beside it."""

import threading
import time
from typing import Any, Optional, Tuple

import rospy
from sensor_msgs.msg import CameraInfo

from .. import CameraModel, is_calibrated
from ..common.repeats import Repeats
from .image_node import ImageNode
from .transport import camera_info_beside, remapped_camera_info

TOLD_AGAIN = 5.0  # s until the same kind of problem is told again
PATIENCE = 2.0  # s that pictures come without camera_info until it is told


class Calibration:
    """The newest camera_info, whatever its stamp: pictures come without any, too.

    It is on the topic camera_info if that is remapped, otherwise beside the picture's: of
    /usb_cam/image_raw on /usb_cam/camera_info.

    Args:
        node: whose pictures they are.
        missing: what there is not without it, for the warning.
    """

    def __init__(self, node: ImageNode, missing: str):
        self.topic = remapped_camera_info() or camera_info_beside(node.topic)
        self._missing = missing
        self._info: Optional[CameraInfo] = None
        self._came = threading.Event()
        self._used: Tuple[Any, ...] = ()  # what the camera was made from
        self._camera: Optional[CameraModel] = None
        self._wrong = ""  # with the newest
        self._problem = ""  # that was told last
        self._told = Repeats(TOLD_AGAIN)
        self._first_asked = 0.0  # s of the monotonic clock
        node.subscriber(self.topic, CameraInfo, self._on_info)

    def camera(self, size: Tuple[int, int]) -> Optional[CameraModel]:
        """The camera of pictures of `size`, (width, height) in px.

        The same object until it changes; None if it is not known, with one warning why.
        """
        info = self._info  # other threads replace it
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
        """Until there is a camera_info, for a moment at most; the node has to work."""
        self._came.wait(seconds)

    @property
    def frame_id(self) -> str:
        """Of the camera, as camera_info has it; empty if that is not known."""
        return self._info.header.frame_id if self._info else ""

    def camera_at_once(self, size: Tuple[int, int]) -> CameraModel:
        """The same for a picture by itself; nothing is remembered, or told.

        Raises:
            ValueError: it is not known, and why.
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
        kind = problem.split(" is ")[0]  # what is wrong; its value may change with every message
        if problem == self._problem or not self._told.news([kind], time.monotonic()):
            return
        self._problem = problem
        if problem:
            rospy.logwarn("no %s: camera_info on %s: %s", self._missing, self.topic, problem)
        else:
            rospy.loginfo("%s from now on: camera_info on %s", self._missing, self.topic)


def camera_model(info: CameraInfo, size: Tuple[int, int]) -> CameraModel:
    """The camera of pictures of `size`, (width, height) in px.

    Raises:
        ValueError: camera_info is not calibrated, of other pictures, or of a model not known here.
    """
    if not is_calibrated(info.K):
        raise ValueError("the camera is not calibrated")
    if (info.width, info.height) != size:
        raise ValueError(
            f"camera_info is of {info.width}x{info.height}, the picture {size[0]}x{size[1]}"
        )
    return CameraModel(info.width, info.height, info.K, info.D, info.distortion_model)
