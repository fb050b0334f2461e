"""The node contours, which finds contours, measures them and names their shapes."""

from typing import Any, Dict, Optional, Tuple

import numpy as np

from .. import ContourFinder, ContourParams
from ..common.image_files import load_parameter, upright
from ..common.plain_text import brief
from ..msg import Click, ContourArray, DetectionArray
from ..ros.configs import ContoursConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import detection_array
from ..ros.startup import run_node
from ..ros.transport import Frame, FrameError
from .contour_drawing import DRAWN, draw_contours
from .contour_messages import contour_array, contour_detection, label_of


class Contours:
    """Publishes ~contours, ~objects, ~mask (mono8) and ~processed_image (what ~draw names).

    Subscribes to image, and to ~click (robot_vision/Click), such as the viewer's clicks: from then
    on each contour comes with its distance from the pixel that was clicked last.
    """

    def __init__(self) -> None:
        self._pattern: Optional[np.ndarray] = None  # the image of the template
        self._path = ""  # of its file
        self._point: Optional[Tuple[float, float]] = None  # px, clicked last
        self._params = LiveParams(ContoursConfig, self._configure)
        self._node = ImageNode(self._process)
        self._node.subscriber("~click", Click, self._on_click)
        self._contours = self._node.publisher("~contours", ContourArray)
        self._objects = self._node.publisher("~objects", DetectionArray)
        self._mask = self._node.image_publisher("~mask")
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        drawn, path = config["draw"], config["template_file"]
        if drawn not in DRAWN:
            *names, last = DRAWN
            raise ValueError(f"draw is {brief(drawn)}, must be {', '.join(names)} or {last}")
        pattern = self._pattern
        if path != self._path:
            pattern = load_parameter("template_file", path, upright) if path else None
        finder = ContourFinder(filled(ContourParams(), config), pattern)
        # Replaced in one step, because another thread may be processing a frame.
        self._tools = finder, drawn
        self._pattern, self._path = pattern, path

    def _on_click(self, click: Click) -> None:
        self._point = float(click.x), float(click.y)

    def _process(self, frame: Frame) -> None:
        (finder, drawn), point = self._tools, self._point
        try:
            result = finder.apply(frame.image, "bgr8", point)
        except ValueError as error:  # Noise in a large image would take too long.
            raise FrameError(error) from None
        if self._contours.get_num_connections():
            self._contours.publish(contour_array(frame, result.contours, point))
        if self._objects.get_num_connections():
            detections = (contour_detection(contour) for contour in result.contours)
            self._objects.publish(detection_array(frame, detections))
        self._mask.publish(result.mask, "mono8", frame.header)
        if self._processed.get_num_connections():
            overlay = frame.image.copy()
            labelled = ((contour, label_of(contour)) for contour in result.contours)
            draw_contours(overlay, labelled, drawn)
            self._processed.publish(overlay, "bgr8", frame.header)


def main() -> None:
    run_node("contours", Contours)
