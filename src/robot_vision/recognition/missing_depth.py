"""Why the images of a node have no depth, which some in between may lack at any time."""

import time
from typing import Optional

from ..ros.depth_input import DepthInput
from ..ros.image_node import ImageNode

TIMEOUT = 2.0  # s of images without depth until that is a problem


class MissingDepth:
    """Tells that no image has depth any more. For one thread at a time.

    Args:
        node: The node.
        depth: Its depth images.
        without: What becomes of images without depth.
    """

    def __init__(self, node: ImageNode, depth: DepthInput, without: str) -> None:
        self._node = node
        self._depth = depth
        self._without = without
        self._since: Optional[float] = None  # s of the monotonic clock

    def end(self) -> None:
        """Takes note of an image with depth, or that there are no images for a while."""
        self._since = None

    def reason(self) -> str:
        """Takes note of an image without; returns the reason, or "" if it may be an accident."""
        now = time.monotonic()
        self._since = self._since or now
        if now - self._since < TIMEOUT:
            return ""
        missing = self._node.missing(only="depth")
        lack = missing or f"no depth on {self._depth.topic} can be used with the images"
        return f"{lack}: {self._without}"
