"""The depth images of a node that also works without, which belong to its images."""

import functools
import time
from typing import Any, Callable, List, NamedTuple, Optional, Tuple

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

from .. import CameraModel
from ..common.errors import about
from ..common.plain_text import brief
from ..common.throttle import Throttle
from .camera_info import camera_model
from .depth_frames import DepthLook
from .depth_pairs import DepthPairs
from .image_node import ImageNode
from .params import read_param
from .transport import KEPT, Frame, FrameError, camera_info_beside, remapped

START_TIMEOUT = 2.0  # s of work, until the first depth counts as missing
INFO_TIMEOUT = 2.0  # s with depths, until camera_info that is needed counts as missing


class DepthFrame(NamedTuple):
    """A depth image that can be used.

    Attributes:
        header: Its header.
        image: (height, width) uint16 in mm, or float32 in m.
        camera: The camera of its pixels; None: that of the images.
    """

    header: Header
    image: np.ndarray
    camera: Optional[CameraModel]


class _Waiting(NamedTuple):
    """A frame that waits for its depth, and what goes on with it."""

    frame: Frame
    image: Any

    @property
    def header(self) -> Header:
        return self.frame.header


class DepthInput:
    """Gives each image the depth image of its time, if the name `depth` is remapped to a topic.

    A depth image has the optical frame of the images. Its size may be another one: then the
    camera_info beside it tells its camera. Images go on without depth that cannot be used. Depths
    that are odd are told and used.

    Args:
        node: The node whose images get depths.
        go_on: A function that gets each image, in the order in which they come, with its depth or
            None. The thread of the images calls it.
        without: What becomes of images without depth, for warnings.

    Raises:
        ValueError: ~depth_image_transport is not a string, or no transport.
    """

    def __init__(
        self, node: ImageNode, go_on: Callable[[Any, Optional[DepthFrame]], None], without: str
    ):
        self._without = without
        self.topic = remapped("depth")
        self.info_topic = camera_info_beside(self.topic)
        self._node = node
        self._go_on = go_on
        self._look = DepthLook(self.topic)
        self._pairs: DepthPairs = DepthPairs()
        self._of_images: Optional[Tuple[str, Tuple[int, int]]] = None  # frame_id and size
        self._info: Optional[CameraInfo] = None
        self._rectified = False
        self._first: Optional[float] = None  # s of the monotonic clock, of the first depth
        self._has_begun = False  # whether a depth could be compared with the images
        self._refusal = ""  # what is wrong with the newest depth that could be compared
        self._is_missing = False  # whether that was said
        self._missing, self._apart = Throttle(60.0), Throttle(10.0)
        transport = read_param("depth_image_transport", "auto")
        if self.topic:
            node.image_subscriber("depth", self._on_depth, transport)
            node.subscriber(self.info_topic, CameraInfo, self._on_info)

    def set_slop(self, slop: float) -> None:
        """Sets by how much the stamps of an image and its depth may differ, in s."""
        self._pairs.slop = slop

    def set_rectified(self, rectified: bool) -> None:
        """Sets whether depth images are rectified: see camera_model()."""
        self._rectified = rectified

    def offer(self, frame: Frame, image: Any) -> Any:
        """Takes the next image, by the callback of its frame, which is to return what this returns.

        Args:
            frame: The frame, which is kept if the image waits for its depth.
            image: What goes on with a depth.
        """
        if not self.topic:
            return self._go_on(image, None)
        self._of_images = frame.header.frame_id, frame.image.shape[1::-1]
        newest = _Waiting(frame, image)
        ready = self._pairs.add_image(newest, time.monotonic())
        self._report()
        is_ready = bool(ready) and ready[-1][0] is newest
        self._go_on_with(ready[:-1] if is_ready else ready)
        return self._go_on(image, ready[-1][1]) if is_ready else KEPT

    def may_begin(self) -> bool:
        """Returns whether images go on alone only because the first depth is still on its way."""
        if not self.topic or self._has_begun:
            return False
        return not self._node.missing(START_TIMEOUT, only="depth")

    def problem(self) -> str:
        """Returns, in a line that names the topic, why images have no depth; empty if they have."""
        apart = self._pairs.problem(self._node.topic, self.topic)
        return self._node.missing(only="depth") or self._refusal or apart

    def clear(self) -> None:
        """Forgets the images that wait."""
        self._pairs.clear()
        self._has_begun, self._refusal = False, ""
        self._of_images = self._info = self._first = None

    def _on_info(self, info: CameraInfo) -> None:
        self._info = info

    def _on_depth(self, frame: Frame) -> None:
        now = time.monotonic()
        self._first = self._first or now
        if self._of_images is None:  # It cannot be compared with the images yet.
            return
        frame_id, size = self._of_images
        waits = self._info is None and frame.image.shape[1::-1] != size
        if waits and now - self._first < INFO_TIMEOUT:
            return
        self._has_begun = True
        try:
            depth = self._usable(frame, frame_id, size)
        except FrameError as error:
            self._refusal = f"depth on {self.topic}: {error}"
            raise
        self._refusal = ""
        if self._is_missing:
            self._is_missing = False
            rospy.loginfo("depth from now on: %s", self.topic)
        self._go_on_with(self._pairs.add_depth(depth, now))

    def _go_on_with(self, ready: List[Tuple[_Waiting, Optional[DepthFrame]]]) -> None:
        for (frame, image), depth in ready:
            self._node.go_on(frame, functools.partial(self._go_on, image, depth))

    def _usable(self, frame: Frame, frame_id: str, size: Tuple[int, int]) -> DepthFrame:
        """Returns a depth image and its camera.

        Raises:
            FrameError: The image cannot be used; the message says what was expected.
        """
        self._look.check(frame)
        own = frame.header.frame_id
        # A slash that a name begins with is of times of tf_prefix, and says nothing.
        if own and frame_id and own.lstrip("/") != frame_id.lstrip("/"):
            raise FrameError(
                f"its frame is {brief(own)}, must be that of the images on {self._node.topic}, "
                f"{brief(frame_id)}: is it registered?"
            )
        try:
            camera = self._camera(frame.image.shape[1::-1], size)
        except ValueError as error:
            raise FrameError(error) from None
        return DepthFrame(frame.header, frame.image, camera)

    def _camera(self, own: Tuple[int, int], size: Tuple[int, int]) -> Optional[CameraModel]:
        info = self._info
        if info is not None:
            with about(f"camera_info on {self.info_topic}"):
                return camera_model(info, own, self._rectified)
        if own == size:
            return None
        sizes = ["{}x{}".format(*one) for one in (own, size)]
        raise ValueError(
            f"it is of {sizes[0]}, the images on {self._node.topic} of {sizes[1]}: expected the "
            f"same, or a camera_info of {sizes[0]} on {self.info_topic}, where there is none"
        )

    def _report(self) -> None:
        """Says, not too often, if no depth comes, or none that belongs to the images."""
        missing = self._node.missing(only="depth")
        if missing and self._missing.due():
            self._is_missing = True
            rospy.logwarn("%s: %s", missing, self._without)
        apart = self._pairs.problem(self._node.topic, self.topic)
        if apart and self._apart.due():
            rospy.logwarn("%s: %s", apart, self._without)
