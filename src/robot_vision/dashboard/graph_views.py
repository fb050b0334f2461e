"""What people want to see of each node: the image that it works on, and what it finds there."""

from typing import Any, Dict, List, Mapping

from .graph_state import IMAGE, IMAGE_TYPES, State, base_of, is_image, of_nodes, shown_topic
from .graph_status import Status

PROCESSED = "processed_image"  # the topic of a node of this package on which it draws its results
RAW = "image_raw"  # the image of a camera that others are made from
CAMERA_INFO = "sensor_msgs/CameraInfo"
# The types of topics that hold what can be drawn over an image.
OVERLAYS = {
    *(
        f"robot_vision/{name}"
        for name in (
            "ContourArray",
            "Detection3DArray",
            "DetectionArray",
            "FaceIdentityArray",
            "Flow",
            "Histogram",
            "KeypointMatches",
            "Keypoints",
            "LaneState",
            "Line",
            "MotionState",
            "RecognizedObjectArray",
            "TableArray",
            "TagDetectionArray",
            "TrackStateArray",
        )
    ),
    "apriltag_ros/AprilTagDetectionArray",
    "darknet_ros_msgs/BoundingBoxes",
    "vision_msgs/Detection2DArray",
    "vision_msgs/Detection3DArray",
}


class Views:
    """Makes the views, and remembers on which image each node worked.

    A node that nobody looks at does not subscribe, and so tells its image only while it works.
    """

    def __init__(self) -> None:
        self._images: Dict[str, str] = {}  # by node

    def of(self, state: State, statuses: Mapping[str, Status]) -> List[Dict[str, Any]]:
        """Returns the views of all nodes, sorted by their names.

        Args:
            state: With nodelets.
            statuses: The newest statuses by node.
        """
        publishes, subscribes = of_nodes(state.publishers), of_nodes(state.subscribers)
        self._images = {node: one for node, one in self._images.items() if node in state.nodes}
        found = []
        for node in sorted(publishes):
            topics = publishes[node]
            overlays = [topic for topic in topics if state.types.get(topic) in OVERLAYS]
            processed = f"{node}/{PROCESSED}"
            if processed not in topics or state.types.get(processed) != IMAGE:
                processed = ""
            status = statuses.get(node)
            image = self._image_of(node, state, subscribes.get(node, []), status)
            if overlays or processed:
                found.append(_view(node, node, image, overlays, processed))
            else:
                found += _cameras(node, topics, state)
        return found

    def _image_of(self, node: str, state: State, topics: List[str], status: Any) -> str:
        """Returns the topic of the images that a node works on, or has worked on; "" if unknown."""
        image = status.image if status else ""
        if not image:
            bases = {base_of(topic) for topic in topics if state.types.get(topic) in IMAGE_TYPES}
            image = bases.pop() if len(bases) == 1 else ""
        if image:
            self._images[node] = image
        return shown_topic(self._images.get(node, ""), state)


def _cameras(node: str, topics: List[str], state: State) -> List[Dict[str, Any]]:
    """Returns a view for each camera_info that a node publishes, of the best image beside it."""
    found: Dict[str, str] = {}  # images by the namespace
    for topic in topics:
        folder, _, name = base_of(topic).rpartition("/")
        info = f"{folder}/camera_info"
        if (
            name.startswith("image")
            and is_image(topic, state.types, state.publishers)
            and state.types.get(info) == CAMERA_INFO
            and node in state.publishers.get(info, ())
            and (folder not in found or name == RAW)
        ):
            found[folder] = topic
    titles = {topic: node if len(found) == 1 else topic for topic in found.values()}
    return [_view(node, title, topic, [], "") for topic, title in titles.items()]


def _view(node: str, title: str, image: str, overlays: List[str], processed: str) -> Dict[str, Any]:
    return {
        "node": node,
        "title": title.lstrip("/"),
        "image": image,
        "overlays": overlays,
        "processed": processed,
    }
