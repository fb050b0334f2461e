"""The node hsv_tracker, which finds regions of named colours."""

from typing import Any, Dict, List, Tuple

import numpy as np

from .. import (
    ColorMask,
    Region,
    RegionFinder,
    RegionParams,
    _transport,
    draw_outline,
    mask_picture,
)
from ..common.plain_text import to_ascii
from ..msg import DetectionArray
from ..ros.configs import HsvTrackerConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.messages import detection, detection_array
from ..ros.startup import run_node
from ..ros.transport import Frame
from .color_file import edit_colors
from .named_colors import SHOWN, NamedColors


class HsvTracker:
    """Publishes ~objects, ~mask (mono8) and ~processed_image (the image where the mask is set).

    Subscribes to image.
    """

    def __init__(self) -> None:
        self._colors = NamedColors()
        self._params = LiveParams(HsvTrackerConfig, self._configure, self._edit)
        self._node = ImageNode(self._process)
        self._objects = self._node.publisher("~objects", DetectionArray)
        self._mask = self._node.image_publisher("~mask")
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        finder = RegionFinder(filled(RegionParams(), config))
        self._colors.update(config)
        masks = {name: ColorMask(color) for name, color in self._colors.ranges.items()}
        self._tools = masks, finder  # replaced in one step: another thread may process a frame

    def _process(self, frame: Frame) -> None:
        mask, found = self._find(frame.image)
        if self._objects.get_num_connections():
            detections = (detection(region, name) for name, region in found)
            self._objects.publish(detection_array(frame, detections))
        self._mask.publish(mask, "mono8", frame.header)
        if self._processed.get_num_connections():
            overlay = mask_picture(frame.image, mask)
            for name, region in found:
                draw_outline(overlay, region.outline, to_ascii(name))
            self._processed.publish(overlay, "bgr8", frame.header)

    def _find(self, image: np.ndarray) -> Tuple[np.ndarray, List[Tuple[str, Region]]]:
        """Returns the mask of all colours, and their regions, largest first."""
        masks, finder = self._tools
        union = np.zeros(0)
        found: List[Tuple[str, Region]] = []
        for name, mask in masks.items():
            cleaned, regions = finder.apply(mask.apply(image))
            union = union | cleaned if union.size else cleaned
            found += [(name, region) for region in regions]
        return union, sorted(found, key=lambda entry: -entry[1].area)

    def _edit(self, path: str, text: str, values: Dict[str, Any]) -> str:
        others = {name: value for name, value in values.items() if name not in SHOWN}
        return edit_colors(path, _transport.edit_params(path, text, others), self._colors.ranges)


def main() -> None:
    run_node("hsv_tracker", HsvTracker)
