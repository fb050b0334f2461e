"""The topics on which object_detector publishes what its network finds."""

from typing import Any, Callable, List, Tuple

from ..msg import BoundingBoxes, Detection2DArray, DetectionArray, ObjectCount
from ..ros.image_node import ImageNode
from .compatible_messages import bounding_boxes, detections_2d, object_count

DARKNET = "darknet_ros/"  # what the names of darknet_ros begin with


class DetectionOutputs:
    """Publishes detections on ~detections, and as the messages of other packages.

    Args:
        node: The node, which works while one of the topics has a subscriber.
        darknet_names: Whether those of darknet_ros have its names, too.
    """

    def __init__(self, node: ImageNode, darknet_names: bool):
        kinds: List[Tuple[str, Any, Callable[[DetectionArray], Any]]] = [
            ("~detections", DetectionArray, lambda detections: detections),
            ("~detections_2d", Detection2DArray, detections_2d),
        ]
        for prefix in ("~", DARKNET) if darknet_names else ("~",):
            kinds.append((prefix + "bounding_boxes", BoundingBoxes, bounding_boxes))
            kinds.append((prefix + "found_object", ObjectCount, object_count))
        self._outputs = [(node.publisher(name, kind), made) for name, kind, made in kinds]

    @property
    def wanted(self) -> bool:
        """Whether somebody subscribes to one of them."""
        return any(output.get_num_connections() for output, _ in self._outputs)

    def publish(self, detections: DetectionArray) -> None:
        """Publishes what was found in a frame."""
        for output, made in self._outputs:
            if output.get_num_connections():
                output.publish(made(detections))
