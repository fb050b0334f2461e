"""The node code_reader, which reads QR codes and bar codes."""

from typing import Any, Dict, List, Optional

import numpy as np
import rospy
from geometry_msgs.msg import Point

from .. import Code, CodeReaderParams, draw_outline, keeps_bytes, to_bgr
from .. import CodeReader as Reader
from ..common.plain_text import to_ascii
from ..common.polygons import area_of
from ..common.repeats import Repeats
from ..msg import Detection, DetectionArray
from ..ros.configs import CodeReaderConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import box_around, detection_array, points
from ..ros.startup import run_node
from ..ros.transport import Frame

MAX_LABEL_LENGTH = 60


class CodeReader:
    """Publishes ~codes and ~processed_image (the gray image with outlines, types and texts).

    Subscribes to image.
    """

    def __init__(self) -> None:
        if not keeps_bytes():
            rospy.logwarn(
                "zbar is older than 0.23.1: what is not ASCII in a QR code may be changed"
            )
        self._repeats = Repeats()
        self._reader_params: Optional[CodeReaderParams] = None
        self._params = LiveParams(CodeReaderConfig, self._configure)
        self._node = ImageNode(self._process, encoding="mono8", idle=self._repeats.clear)
        self._codes = self._node.publisher("~codes", DetectionArray)
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        params = filled(CodeReaderParams(), config)
        params.background = True
        if params != self._reader_params:  # Another period of reports does not begin anew.
            self._reader = Reader(params)
            self._reader_params = params
        self._repeats.period = config["repeat_period"]

    def _process(self, frame: Frame) -> None:
        codes = self._reader.update(frame.time, frame.image, "mono8")
        if self._codes.get_num_connections():
            self._publish_news(frame, codes)
        if self._processed.get_num_connections():
            self._publish_overlay(frame, codes)

    def _publish_news(self, frame: Frame, codes: List[Code]) -> None:
        """Publishes codes that are not repetitions; with a period of 0 each frame is answered."""
        news = self._repeats.news(((code.type, code.data) for code in codes), frame.time)
        if news or not self._repeats.period:
            told = [code for code in codes if (code.type, code.data) in news]
            found = (code_detection(code, frame.image) for code in told)
            self._codes.publish(detection_array(frame, found))

    def _publish_overlay(self, frame: Frame, codes: List[Code]) -> None:
        overlay = to_bgr(frame.image, "mono8")
        for code in codes:
            label = to_ascii(f"{code.type}: {text_of(code)}", MAX_LABEL_LENGTH)
            draw_outline(overlay, np.rint(code.polygon).astype(int), label)
        self._processed.publish(overlay, "bgr8", frame.header)


def text_of(code: Code) -> str:
    """Returns a code's content as text; bytes that are not UTF-8 become U+FFFD."""
    return code.data.decode("utf-8", "replace")


def code_detection(code: Code, image: np.ndarray) -> Detection:
    """Returns a code as a Detection, whose box is clipped to the image."""
    return Detection(
        label=text_of(code),
        id=-1,
        score=code.score,
        box=box_around(code.polygon, image),
        center=Point(*code.polygon.mean(axis=0), 0.0),
        outline=points(code.polygon),
        area=area_of(code.polygon),
        code_type=code.type,
        code_data=code.data,
    )


def main() -> None:
    run_node("code_reader", CodeReader)
