"""The service ~detect, which searches a single image for objects."""

import os
import threading
from typing import Any, Callable

import numpy as np
import rospy
from std_msgs.msg import Header

from ..common.image_files import load_image, sensor_pixels
from ..common.plain_text import error_text, printable
from ..msg import DetectionArray
from ..ros.context import current
from ..ros.frame_calls import FrameCalls
from ..srv import DetectObjects, DetectObjectsResponse

TIMEOUT = 10.0  # s that a call waits for a frame, without those in which the network runs


class DetectService:
    """~detect searches a file, or the next frame, for which the node works for a moment.

    Args:
        calls: What waits for the next frame; the node offers it DetectionArrays.
        search: A function that searches an image (BGR); any thread may call it.
    """

    def __init__(self, calls: FrameCalls, search: Callable[[np.ndarray, Header], DetectionArray]):
        self._calls = calls
        self._search = search
        self._reading = threading.Lock()  # large images take much memory, so one is read at a time
        current().service("~detect", DetectObjects, self._on_detect)

    def _on_detect(self, request: Any) -> DetectObjectsResponse:
        try:
            if request.file:
                found = self._of_file(request.file)
            else:
                with self._calls.working():
                    found = self._calls.wait(TIMEOUT)
        except Exception as error:  # Of any kind, because rospy would answer without a reason.
            reason = error_text(error)
            rospy.logerr("no objects detected: %s", reason)
            return DetectObjectsResponse(False, reason, DetectionArray())
        return DetectObjectsResponse(True, "", found)

    def _of_file(self, path: str) -> DetectionArray:
        if not os.path.isabs(path):  # A node and its caller run in different folders.
            raise ValueError(f"file is '{printable(path)}', must be an absolute path")
        with self._reading:
            return self._search(load_image(path, sensor_pixels), Header(stamp=rospy.Time.now()))
