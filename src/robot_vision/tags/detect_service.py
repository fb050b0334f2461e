"""The service ~detect, which searches a single image for tags."""

import os
import threading
import time
from concurrent import futures
from typing import Any, Callable, List, Optional, Tuple

import numpy as np
import rospy
from std_msgs.msg import Header

from ..common.image_files import load_image, sensor_pixels
from ..common.plain_text import printable
from ..msg import TagDetectionArray
from ..ros.camera_info import CameraInfoListener
from ..ros.image_node import ImageNode
from ..ros.transport import Frame
from ..srv import DetectTags, DetectTagsResponse
from .depth_input import DepthFrame

TIMEOUT = 5.0  # s that a call waits for a frame
CALIBRATION_TIMEOUT = 1.0  # s that a call for a file waits for camera_info
MAX_ERROR_LENGTH = 1000  # characters of an error, which may name a path
FRAME_PERIOD = 1.0  # s after a frame during which the next one may be on its way already

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
        self._node = node
        self._calibration = calibration
        self._detect = detect
        self._lock = threading.Lock()  # guards all attributes below
        self._calls: List[futures.Future] = []  # that get the next frame
        self._later_calls: List[futures.Future] = []  # that get the one after it
        self._working = 0  # number of calls for which the node has to work
        self._last_frame = -FRAME_PERIOD  # s of the monotonic clock
        rospy.Service("~detect", DetectTags, self._on_detect)

    def offer(self, frame: Frame, depth: Optional[DepthFrame] = None) -> None:
        """Offers a frame, and its depth, to the calls that wait for one."""
        with self._lock:
            self._last_frame = time.monotonic()
            ready, self._calls, self._later_calls = self._calls, self._later_calls, []
        for call in ready:
            try:
                call.set_result(self._detect(frame.image, frame.encoding, frame.header, depth))
            except Exception as error:
                call.set_exception(error)

    def _on_detect(self, request: Any) -> DetectTagsResponse:
        self._count(1)
        try:
            found = self._of_file(request.file) if request.file else self._of_next_frame()
        except Exception as error:  # Of any kind, because rospy would answer without a reason.
            reason = printable(str(error), MAX_ERROR_LENGTH) or type(error).__name__
            rospy.logerr("no tags detected: %s", reason)
            return DetectTagsResponse(False, reason, TagDetectionArray())
        finally:
            self._count(-1)
        tags, problem = found
        return DetectTagsResponse(True, problem, tags)

    def _count(self, change: int) -> None:
        with self._lock:
            self._working += change
            self._node.keep_working(self._working > 0)

    def _of_file(self, path: str) -> Tuple[TagDetectionArray, str]:
        if not os.path.isabs(path):  # A node and its caller run in different folders.
            raise ValueError(f"file is '{printable(path)}', must be an absolute path")
        image = load_image(path, sensor_pixels)
        self._calibration.wait(CALIBRATION_TIMEOUT)
        header = Header(stamp=rospy.Time.now(), frame_id=self._calibration.frame_id)
        return self._detect(image, "bgr8", header, None)

    def _of_next_frame(self) -> Tuple[TagDetectionArray, str]:
        call: futures.Future = futures.Future()
        with self._lock:
            # A frame that was taken before the call may be on its way.
            on_its_way = time.monotonic() - self._last_frame < FRAME_PERIOD
            (self._later_calls if on_its_way else self._calls).append(call)
        try:
            return call.result(TIMEOUT)
        except futures.TimeoutError:
            raise RuntimeError(self._node.no_frame(TIMEOUT)) from None
        finally:
            with self._lock:
                for calls in (self._calls, self._later_calls):
                    if call in calls:
                        calls.remove(call)
