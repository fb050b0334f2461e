"""The service ~detect, which searches a single image for tags."""

import os
import threading
from typing import Any, Callable, Optional, Tuple

import numpy as np
import rospy
from std_msgs.msg import Header

from ..common.image_files import load_image, sensor_pixels
from ..common.plain_text import error_text, printable
from ..msg import TagDetectionArray
from ..ros.camera_info import CameraInfoListener
from ..ros.context import current
from ..ros.depth_input import DepthFrame
from ..ros.frame_calls import FrameCalls
from ..ros.image_node import ImageNode
from ..ros.transport import Frame
from ..srv import DetectTags, DetectTagsResponse

TIMEOUT = 10.0  # s that a call waits for a frame
CALIBRATION_TIMEOUT = 2.0  # s that a call waits for camera_info once it has an image

# Searches an image of an encoding, with its depth if there is one; returns the tags, and the reason
# if they have no poses.
Detect = Callable[[np.ndarray, str, Header, Optional[DepthFrame]], Tuple[TagDetectionArray, str]]


class DetectService:
    """~detect searches a file, or the next frame, for which the node works for a moment.

    Args:
        node: The node that processes the frames.
        calibration: The calibration of its camera, which is also used for files.
        detect: A function that searches an image; any thread may call it.
    """

    def __init__(self, node: ImageNode, calibration: CameraInfoListener, detect: Detect):
        self._calibration = calibration
        self._detect = detect
        self._calls = FrameCalls(node)
        self._searching = threading.Lock()  # Large images need much memory: one at a time.
        current().service("~detect", DetectTags, self._on_detect)

    def offer(self, taken: float, frame: Frame, depth: Optional[DepthFrame] = None) -> None:
        """Offers calls a frame, taken at this time (s of the monotonic clock), and its depth."""
        self._calls.offer(lambda: (frame.image, frame.encoding, frame.header, depth), taken)

    def _on_detect(self, request: Any) -> DetectTagsResponse:
        try:
            with self._calls.working():
                seen = None if request.file else self._next_frame()
                # In this thread, so that frames go on meanwhile.
                with self._searching:
                    tags, problem = self._detect(*(seen or self._of_file(request.file)))
        except Exception as error:  # Of any kind, because rospy would answer without a reason.
            reason = error_text(error)
            rospy.logerr("no tags detected: %s", reason)
            return DetectTagsResponse(False, reason, TagDetectionArray())
        return DetectTagsResponse(True, problem, tags)

    def _next_frame(self) -> Tuple[np.ndarray, str, Header, Optional[DepthFrame]]:
        seen = self._calls.wait(TIMEOUT)
        self._calibration.wait(CALIBRATION_TIMEOUT)  # which may come after the first frame
        return seen

    def _of_file(self, path: str) -> Tuple[np.ndarray, str, Header, None]:
        if not os.path.isabs(path):  # A node and its caller run in different folders.
            raise ValueError(f"file is '{printable(path)}', must be an absolute path")
        image = load_image(path, sensor_pixels)
        self._calibration.wait(CALIBRATION_TIMEOUT)
        header = Header(stamp=rospy.Time.now(), frame_id=self._calibration.frame_id)
        return image, "bgr8", header, None
