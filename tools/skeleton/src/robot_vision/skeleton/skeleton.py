"""The node skeleton, which measures how much of the image is bright."""

from typing import Any, Dict

from std_msgs.msg import Float64

from .. import SkeletonParams, draw_text, measure_skeleton
from ..ros.configs import SkeletonConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams, filled
from ..ros.startup import run_node
from ..ros.transport import Frame


class Skeleton:
    """Publishes ~share (0 to 1) and ~processed_image (the image with the share in it).

    Subscribes to image.
    """

    def __init__(self) -> None:
        self._params = LiveParams(SkeletonConfig, self._configure)
        self._node = ImageNode(self._process)
        self._share = self._node.publisher("~share", Float64)
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        self._skeleton_params = filled(SkeletonParams(), config)

    def _process(self, frame: Frame) -> None:
        share = measure_skeleton(frame.image, "bgr8", self._skeleton_params)
        self._share.publish(share)
        if self._processed.get_num_connections():
            overlay = frame.image.copy()
            draw_text(overlay, f"{share:.0%} bright", (10, 20))
            self._processed.publish(overlay, "bgr8", frame.header)


def main() -> None:
    run_node("skeleton", Skeleton)
