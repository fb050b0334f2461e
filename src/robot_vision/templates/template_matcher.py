"""The node template_matcher, which finds images of files, or what is selected, in the image."""

import threading
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
import rospy
from geometry_msgs.msg import Point

from .. import TemplateMatch, TemplateMatches, TemplateParams, draw_outline, response_image
from .. import TemplateMatcher as Matcher
from ..common.errors import about
from ..common.plain_text import to_ascii
from ..common.throttle import Throttle
from ..msg import Detection, DetectionArray
from ..ros.configs import TemplateMatcherConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import Box, box_detection, corners, detection_array
from ..ros.selections import Selection, Selections
from ..ros.startup import run_node
from ..ros.transport import Frame, FrameError
from .template_files import Template, load_templates

SELECTED = "selected"  # name of the template that was selected in the image


class Work(NamedTuple):
    """What the present parameters and templates make of frames."""

    matcher: Matcher
    names: List[str]
    method: str


class TemplateMatcher:
    """Publishes ~objects, ~response (mono8, white where a template fits) and ~processed_image.

    Subscribes to image. A region that comes on ~select (sensor_msgs/RegionOfInterest), as the
    viewer sends it, is cut out of the next frame, and is a template from then on.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards all attributes below but the outputs
        self._files: Tuple[str, List[Template]] = "", []
        self._selected: Optional[Template] = None
        self._throttle = Throttle()
        self._params = LiveParams(TemplateMatcherConfig, self._configure)
        self._node = ImageNode(self._process)
        self._selections = Selections(self._node, self._lock)
        self._objects = self._node.publisher("~objects", DetectionArray)
        self._response = self._node.image_publisher("~response")
        self._processed = self._node.image_publisher("~processed_image")
        self._selections.subscribe()
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        files = self._files  # which only this function changes
        if config["templates"] != files[0]:
            files = config["templates"], load_templates(config["templates"])
        with self._lock:
            self._work = work_of(config, files[1], self._selected)
            self._files, self._config = files, config

    def _process(self, frame: Frame) -> None:
        with self._lock:
            for wanted in self._selections.take():
                self._cut_out(frame.image, wanted)
            self._selections.keep_working()
            work = self._work
        wants_response = self._response.get_num_connections() > 0
        try:
            found = work.matcher.match(frame.image, response=wants_response)
        except ValueError as error:  # All templates would take too long in such a large image.
            raise FrameError(error) from None
        self._warn_of_large(work, found)
        if self._objects.get_num_connections():
            detections = [detection_of(one, work.names) for one in found.matches]
            self._objects.publish(detection_array(frame, detections))
        if wants_response and found.response.size:
            image = response_image(found.response, work.method)
            self._response.publish(image, "mono8", frame.header)
        if self._processed.get_num_connections():
            overlay = frame.image.copy()
            for one in found.matches:
                label = f"{to_ascii(work.names[one.index])} {one.score:.2f}"
                draw_outline(overlay, corners(one.box), label)
            self._processed.publish(overlay, "bgr8", frame.header)

    def _cut_out(self, image: np.ndarray, wanted: Selection) -> None:
        """Makes a region of the image a template, or forgets it. The lock must be held."""
        try:
            selected = cut_out(image, wanted.box)
            self._work = work_of(self._config, self._files[1], selected)
            self._selected = selected
        except ValueError as error:
            self._selections.refuse(wanted, error)

    def _warn_of_large(self, work: Work, found: TemplateMatches) -> None:
        if found.too_large and self._throttle.due():
            names = ", ".join(work.names[index] for index in found.too_large[:5])
            rospy.logwarn("larger than the image on %s: %s", self._node.topic, names)


def work_of(
    config: Dict[str, Any], templates: List[Template], selected: Optional[Template]
) -> Work:
    """Returns a matcher with all templates.

    Raises:
        ValueError: A parameter is out of range, or a template cannot be found anywhere.
    """
    matcher = Matcher(filled(TemplateParams(), config))
    everything = [*templates, *([selected] if selected else [])]
    for template in everything:
        with about(template.name):
            matcher.add(template.pixels, mask=template.mask)
    return Work(matcher, [template.name for template in everything], config["method"])


def cut_out(image: np.ndarray, box: Box) -> Optional[Template]:
    """Returns a region of the image as a template, None for a region without pixels.

    Raises:
        ValueError: The region is not inside of the image.
    """
    x, y, width, height = box
    if not width or not height:
        return None
    rows, columns = image.shape[:2]
    if x + width > columns or y + height > rows:
        raise ValueError(
            f"region of {width}x{height} px at ({x}, {y}) is not inside the image of "
            f"{columns}x{rows}"
        )
    return Template(SELECTED, image[y : y + height, x : x + width].copy())


def detection_of(match: TemplateMatch, names: List[str]) -> Detection:
    """Returns a match as a Detection with its sub-pixel centre."""
    made = box_detection(match.box, names[match.index], score=match.score)
    made.center = Point(*match.center, 0.0)
    return made


def main() -> None:
    run_node("template_matcher", TemplateMatcher)
