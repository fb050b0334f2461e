"""The camera model of an image topic, from the camera_info beside it."""

import threading
import time
from typing import Any, Dict, Iterable, Optional, Tuple

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo

from .. import CameraModel, is_calibrated
from ..common.errors import about
from ..common.repeats import Repeats
from .image_node import ImageNode
from .transport import ReportedFrameError, camera_info_beside, remapped_camera_info

REPEAT_PERIOD = 5.0  # s until the same kind of problem is logged again
TIMEOUT = 2.0  # s without camera_info until its lack is logged
NOT_CALIBRATED = "no calibration: see what the node has printed"  # in overlays


class CameraInfoListener:
    """Keeps the newest camera_info of a node's images, whatever its stamp is.

    It also serves images without a stamp. What came before the node was idle is forgotten, because
    the camera may have been calibrated since. The camera_info is expected on the topic camera_info
    if that name is remapped, and otherwise beside the image: for /usb_cam/image_raw on
    /usb_cam/camera_info.

    Args:
        node: The node that processes the images.
        missing: What the node cannot provide without camera_info, for the warning.
    """

    def __init__(self, node: ImageNode, missing: str):
        self.topic = remapped_camera_info() or camera_info_beside(node.topic)
        self._missing = missing
        self._lack = f"no {missing}: camera_info on {self.topic}"
        self._info: Optional[CameraInfo] = None
        self._arrived = threading.Event()
        self._used: Tuple[Any, ...] = ()  # the values that the camera was made from
        self._camera: Optional[CameraModel] = None
        self._error = ""  # the problem of the newest camera_info
        self._logged_problem = ""  # the problem logged last
        self._lacks = False  # whether camera() has returned None, and camera_info is not on its way
        self._reports = Repeats(REPEAT_PERIOD)
        self._first_asked = 0.0  # s of the monotonic clock
        node.subscriber(self.topic, CameraInfo, self._on_info)
        node.on_idle(self._forget)

    def camera(self, size: Tuple[int, int], rectified: bool = False) -> Optional[CameraModel]:
        """Returns the camera model for images of `size`, (width, height) in px.

        The same object is returned until the camera changes. If the camera is not known, None is
        returned, and one warning gives the reason. See camera_model() for `rectified`.
        """
        info = self._info
        if info is None:
            self._report_missing()
            return None
        lens = (info.P,) if rectified else (info.K, info.D, info.distortion_model)
        used = (size, *window_of(info), *lens)
        if used != self._used:
            self._used = used
            self._camera, self._error = None, ""
            try:
                self._camera = camera_model(info, size, rectified)
            except ValueError as error:
                self._error = str(error)
        self._report(self._error)
        return self._camera

    def refuse(self) -> None:
        """Has a frame counted as refused for which camera() has returned None and said the reason.

        It is not as long as nothing is said, because the first camera_info is on its way.

        Raises:
            ReportedFrameError: The frame is refused.
        """
        if not self.is_on_its_way:
            raise ReportedFrameError(self.problem)

    def wait(self, seconds: float) -> None:
        """Waits at most `seconds` for the first camera_info; the node has to be working.

        It does not wait once its lack is said.
        """
        if self.is_on_its_way:
            self._arrived.wait(seconds)

    @property
    def is_on_its_way(self) -> bool:
        """Whether the first camera_info may still come, when camera() has returned None."""
        return not self._lacks

    @property
    def problem(self) -> str:
        """What is missing and why, when camera() has returned None."""
        error = self._error if self._info else ""
        return f"{self._lack}: {error or 'there is none'}"

    @property
    def frame_id(self) -> str:
        """The frame_id of the camera by its camera_info, or "" if that is not known."""
        return self._info.header.frame_id if self._info else ""

    def camera_at_once(self, size: Tuple[int, int]) -> CameraModel:
        """Returns the camera model for a single image; nothing is remembered or logged.

        Raises:
            ValueError: The camera is not known; the message gives the reason.
        """
        with about(self._lack):
            if self._info is None:
                raise ValueError("there is none")
            return camera_model(self._info, size)

    def _on_info(self, info: CameraInfo) -> None:
        self._info = info
        self._arrived.set()

    def _forget(self) -> None:
        self._info = None
        self._arrived.clear()
        self._first_asked = 0.0
        self._lacks = False

    def _report_missing(self) -> None:
        now = time.monotonic()
        self._first_asked = self._first_asked or now
        if now - self._first_asked > TIMEOUT:
            self._report("there is none")

    def _report(self, problem: str) -> None:
        self._lacks = bool(problem)
        kind = problem.split(" is ")[0]  # A value that follows may change with every message.
        if problem == self._logged_problem or not self._reports.news([kind], time.monotonic()):
            return
        self._logged_problem = problem
        if problem:
            rospy.logwarn("%s: %s", self._lack, problem)
        else:
            rospy.loginfo("%s from now on: camera_info on %s", self._missing, self.topic)


def window_of(info: CameraInfo) -> Tuple[Any, ...]:
    """Returns the values that tell which pixels of the sensor its images have."""
    return info.width, info.height, info.binning_x, info.binning_y, info.roi


def image_size(info: CameraInfo) -> Tuple[int, int]:
    """Returns the size of the images in px, (width, height), by their binning and region.

    The camera_info of a driver that bins pixels, or gives a region, is that of the whole sensor
    (REP 104).
    """
    whole = not (info.roi.width and info.roi.height)
    width, height = (info.width, info.height) if whole else (info.roi.width, info.roi.height)
    return width // max(info.binning_x, 1), height // max(info.binning_y, 1)


def cameras_of(info: CameraInfo) -> Dict[Tuple[int, int], CameraModel]:
    """Returns the cameras that images may have, by the sizes of these, (width, height) in px.

    Some drivers tell the binning, or the region, although camera_info is of the images themselves.

    Raises:
        ValueError: The camera is not calibrated, or its distortion model is not known here.
    """
    return {
        size: camera_model(info, size) for size in (image_size(info), (info.width, info.height))
    }


def size_words(sizes: Iterable[Tuple[int, int]]) -> str:
    """Returns sizes of which images have one, for messages: 320x240 or 640x480."""
    return " or ".join("{}x{}".format(*size) for size in sizes)


def camera_model(info: CameraInfo, size: Tuple[int, int], rectified: bool = False) -> CameraModel:
    """Returns the camera model for images of `size`, (width, height) in px.

    Args:
        info: The calibration, of images of this size, or of the sensor that they are a part of by
            binning and region, as image_geometry takes them.
        size: Of the images.
        rectified: Whether the images are rectified: then their camera is P, without distortion.

    Raises:
        ValueError: The camera is not calibrated, camera_info belongs to images of another size,
            or its distortion model is not known here.
    """
    matrix = np.reshape(info.P, (3, 4))[:, :3] if rectified else np.reshape(info.K, (3, 3))
    if not is_calibrated(matrix):
        raise ValueError(f"the camera is not calibrated{' for rectified images' * rectified}")
    if (info.width, info.height) != size:
        own = image_size(info)
        if own != size:
            raise ValueError(f"camera_info is of {own[0]}x{own[1]}, the image {size[0]}x{size[1]}")
        matrix = _of_window(info) @ matrix
    lens = () if rectified else (info.D, info.distortion_model)
    return CameraModel(*size, matrix, *lens)


def _of_window(info: CameraInfo) -> np.ndarray:
    """Returns the 3x3 matrix from pixels of the whole sensor to those of the images."""
    region = np.eye(3)
    region[:2, 2] = -info.roi.x_offset, -info.roi.y_offset
    return np.diag([1.0 / max(info.binning_x, 1), 1.0 / max(info.binning_y, 1), 1.0]) @ region
