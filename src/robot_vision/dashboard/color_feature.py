"""The operations on colours: what is at a pixel, which colours a node has, and giving it others."""

from typing import Any, Dict, List

from .. import color_channels, color_spaces, range_around
from ..color.colors import median_color, outside
from ..ros.graph_master import graph_name
from .color_names import color_names, range_values
from .color_pixels import bgr_around
from .fields import Field, Number, Text
from .message_topics import SharedTopics
from .operations import Operation
from .parameter_node import ParameterNode
from .select_click import Clicks
from .sessions import Session
from .settings import Settings

IMAGE_TIMEOUT = 3.0  # s until an image must have come
MAX_PIXEL = 65535  # px
SPACES = ("bgr", "hsv", "hls", "lab", "ycrcb")  # that a pixel is told in


class Limits(Field):
    """Three integers from 0 to 255: the limits of a range of colours."""

    def check(self, name: str, value: Any) -> List[int]:
        if not isinstance(value, list) or len(value) != 3:
            raise ValueError(f"{name} must be a list of three integers from 0 to 255")
        number = Number(0, 255, integer=True)
        return [int(number.check(f"{name}[{index}]", entry)) for index, entry in enumerate(value)]


class ColorFeature:
    """Tells the colours of images, gives ranges to nodes, and passes clicks on.

    Args:
        settings: The node's parameters.
        image_hub: Has newest(topic, timeout) for the newest Frame of a topic.
    """

    def __init__(self, settings: Settings, image_hub: Any):
        pixel = {
            "topic": Text(),
            "x": Number(0, MAX_PIXEL, integer=True),
            "y": Number(0, MAX_PIXEL, integer=True),
        }
        color = {
            "node": Text(),
            "name": Text(max_length=60, default=""),
            "space": Text(max_length=20, default="hsv"),
            "low": Limits(),
            "high": Limits(),
        }
        self.operations = [
            Operation("color_at", self._on_color_at, "view", pixel),
            Operation("color_names", self._on_names, "view", {"node": Text()}),
            Operation("use_color", self._on_use, "control", color),
            Operation("click", self._on_click, "control", {"node": Text(), **pixel}),
        ]
        self._hub = image_hub
        self._nodes = SharedTopics(ParameterNode)
        self._clicks = Clicks()

    def close(self) -> None:
        self._clicks.close()

    def _on_color_at(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        frame = self._hub.newest(graph_name(request["topic"]), IMAGE_TIMEOUT)
        part = bgr_around(frame, request["x"], request["y"])
        told: Dict[str, Any] = {space: median_color(part, space) for space in SPACES}
        told["ranges"], told["problems"] = {}, {}
        for space in color_spaces():
            picked = median_color(part, space)
            found = range_around(picked, space)
            told["ranges"][space] = {"low": list(found.low), "high": list(found.high)}
            problem = outside(picked, found)
            if problem:
                told["problems"][space] = problem
        return told

    def _on_names(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        return color_names(request["node"])

    def _on_use(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        space, name = request["space"], request["name"]
        color_channels(space)  # raises ValueError unless it is a space
        node = self._nodes.take(graph_name(request["node"]))
        try:
            limits = request["low"], request["high"]
            values = range_values(node.types(), name, space, limits)
            told: Dict[str, Any] = node.set(values)
        finally:
            self._nodes.give_back(request["node"])
        if told["values"].get("color") == name:
            told["refused"].pop("color", None)  # The node leaves out what says that it is given.
        return told

    def _on_click(self, _session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        frame = self._hub.newest(graph_name(request["topic"]), IMAGE_TIMEOUT)
        return {"message": self._clicks.send(request["node"], frame, request["x"], request["y"])}
