"""Clicks into images, as simple_camera_view publishes them."""

from typing import Any

from .. import to_space
from ..msg import Click
from .color_pixels import bgr_around
from .select_topics import NodeTopics

SPACES = ("hsv", "hls", "lab", "ycrcb")  # of a Click, besides BGR


class Clicks:
    """Sends clicks to the topic ~click of nodes."""

    def __init__(self) -> None:
        self._topics = NodeTopics()

    def close(self) -> None:
        self._topics.close()

    def send(self, node: str, frame: Any, x: int, y: int) -> str:
        """Sends the colour and the place of a pixel of a Frame; returns that in words.

        Raises:
            ValueError: The pixel is not in the image, or the image has no colours.
            OSError: The node takes no clicks.
        """
        bgr = tuple(bgr_around(frame, x, y, 0)[0, 0].tolist())
        colors = {space: to_space(bgr, space) for space in SPACES}
        return self._topics.send(
            node, "click", Click(header=frame.header, x=x, y=y, bgr=bgr, **colors)
        )
