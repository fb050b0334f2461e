"""The service that searches one picture for tags."""

import os
import threading
from typing import Any, Callable, List

import cv2
import numpy as np
import rospy
from std_msgs.msg import Header

from ..msg import TagDetectionArray
from ..srv import DetectTags, DetectTagsResponse
from ..transport import Frame
from .image_node import ImageNode

TIMEOUT = 5.0  # s that a call waits for a frame

Detect = Callable[[np.ndarray, str, Header], TagDetectionArray]


class _Call:
    def __init__(self) -> None:
        self.done = threading.Event()
        self.error = "the frame failed"
        self.tags = TagDetectionArray()


class DetectService:
    """~detect: of a file, or of the next frame, for which the node works for a moment.

    Args:
        node: whose frames they are.
        detect: searches a picture of an encoding; may be called by any thread.
    """

    def __init__(self, node: ImageNode, detect: Detect):
        self._node = node
        self._detect = detect
        self._lock = threading.Lock()  # guards the list
        self._calls: List[_Call] = []
        rospy.Service("~detect", DetectTags, self._on_detect)

    def offer(self, frame: Frame) -> None:
        """A frame, for the calls that wait for one."""
        with self._lock:
            calls, self._calls = self._calls, []
        for call in calls:
            try:
                call.tags = self._detect(frame.image, frame.encoding, frame.header)
                call.error = ""
            except ValueError as error:
                call.error = str(error)
            finally:
                call.done.set()

    def _on_detect(self, request: Any) -> DetectTagsResponse:
        try:
            tags = self._of_file(request.file) if request.file else self._of_next_frame()
        except (OSError, RuntimeError, ValueError) as error:
            rospy.logerr("no tags detected: %s", error)
            return DetectTagsResponse(False, str(error), TagDetectionArray())
        return DetectTagsResponse(True, "", tags)

    def _of_file(self, path: str) -> TagDetectionArray:
        if not os.path.isabs(path):  # a node has another folder than its caller
            raise ValueError(f"file is '{path}', must be an absolute path")
        with open(path, "rb") as file:
            encoded = np.frombuffer(file.read(), np.uint8)
        image = cv2.imdecode(encoded, cv2.IMREAD_COLOR) if encoded.size else None
        if image is None:
            raise ValueError(f"{path} is no picture")
        return self._detect(image, "bgr8", Header(stamp=rospy.Time.now()))

    def _of_next_frame(self) -> TagDetectionArray:
        call = _Call()
        with self._lock:
            self._calls.append(call)
            self._node.keep_working(True)
        arrived = call.done.wait(TIMEOUT)
        with self._lock:
            if call in self._calls:
                self._calls.remove(call)
            self._node.keep_working(bool(self._calls))
        if not arrived:
            raise RuntimeError(f"no frame on {self._node.topic} within {TIMEOUT:g} s")
        if call.error:
            raise RuntimeError(call.error)
        return call.tags
