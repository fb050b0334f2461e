"""Which topics have images, and where those of a topic are best taken from."""

import contextlib
from typing import Any, Dict, FrozenSet, List, NamedTuple, Tuple

from ..common.plain_text import printable
from ..ros.graph_master import MasterCalls, server_param
from .graph_state import base_of

IMAGE, COMPRESSED_IMAGE = "sensor_msgs/Image", "sensor_msgs/CompressedImage"
BESIDE = "/compressed"  # what follows the name of a topic for its JPEGs
DEPTHS = "compressedDepth"  # the transport of depths, which no browser can decode


class Route(NamedTuple):
    """Where the images of a topic are taken from.

    Attributes:
        topic: What is subscribed to, or the base of it.
        transport: That of an ImageSubscriber, or "" if messages are passed on as they are.
    """

    topic: str
    transport: str = ""


class ImageTopics:
    """What the master knows of topics; not thread-safe."""

    def __init__(self) -> None:
        self._types: Dict[str, str] = {}
        self._publishers: Dict[str, FrozenSet[str]] = {}
        self._mjpeg: Dict[Tuple[str, FrozenSet[str]], bool] = {}

    def refresh(self) -> None:
        """Asks the master.

        Raises:
            OSError: It does not answer; what was known stays.
        """
        with contextlib.closing(MasterCalls()) as master:
            types = dict(map(tuple, master.call("getTopicTypes")))
            published = master.call("getSystemState")[0]
        self._types = types
        self._publishers = {topic: frozenset(nodes) for topic, nodes in published}

    def images(self) -> List[str]:
        """Returns the names of all topics with images that are published, sorted.

        Of a topic that is published itself, compressedDepth shows nothing else.
        """
        return sorted(
            topic
            for topic, kind in self._types.items()
            if topic in self._publishers
            and kind in (IMAGE, COMPRESSED_IMAGE)
            and not (topic.endswith(f"/{DEPTHS}") and base_of(topic) in self._publishers)
        )

    def is_published(self, topic: str) -> bool:
        return topic in self._publishers

    def route(self, topic: str, passed: bool) -> Any:
        """Returns the Route to the images of a topic, or None while nothing is known of it.

        Args:
            topic: Its whole name.
            passed: Whether JPEGs may be passed on as they are; else pixels are needed.

        Raises:
            ValueError: It has no images that can be shown.
        """
        kind = self._types.get(topic)
        if kind in (None, "*"):
            return None
        if kind == IMAGE:
            jpeg = passed and self._is_mjpeg(topic)
            return Route(topic + BESIDE) if jpeg else Route(topic, "auto")
        if kind != COMPRESSED_IMAGE:
            raise ValueError(
                f"the topic is of {printable(kind)}, must be of {IMAGE} or {COMPRESSED_IMAGE}"
            )
        if topic.endswith(f"/{DEPTHS}"):
            return Route(base_of(topic), DEPTHS)
        if passed:
            return Route(topic)
        if not topic.endswith(BESIDE):
            raise ValueError(f"the topic must end in {BESIDE}, or its pixels cannot be used")
        return Route(topic[: -len(BESIDE)], "compressed")

    def _is_mjpeg(self, topic: str) -> bool:
        """Whether a camera sends JPEGs, which its node publishes as they are beside the topic."""
        nodes = self._publishers.get(topic, frozenset())
        nodes &= self._publishers.get(topic + BESIDE, frozenset())
        if self._types.get(topic + BESIDE) != COMPRESSED_IMAGE:
            return False
        key = (topic, nodes)
        if key not in self._mjpeg:
            for old in [old for old in self._mjpeg if old[0] == topic]:
                del self._mjpeg[old]
            self._mjpeg[key] = any(
                topic == f"{node}/image_raw" and server_param(f"{node}/pixel_format") == "mjpeg"
                for node in nodes
            )
        return self._mjpeg[key]
