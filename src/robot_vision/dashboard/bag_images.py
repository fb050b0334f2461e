"""The form in which images are recorded: the smallest one that keeps what is in them.

It depends on what the images hold, which only one of them tells. JPEG makes 8 bits of 16, and
compressedDepth keeps nothing but depths up to some metres.
"""

import contextlib
import functools
import threading
from typing import Any, Dict, List, Mapping, Sequence

from sensor_msgs.msg import Image

from ..ros.graph_master import MasterCalls
from .image_topics import BESIDE, COMPRESSED_IMAGE, DEPTHS
from .message_topics import RawMessage, RawTopic

TIMEOUT = 2.0  # s for an image to come
COLORS = ("mono8", "bgr8", "rgb8", "bgra8", "rgba8", "yuv422", "yuv422_yuy2")
MAYBE_DEPTHS = ("16UC1", "32FC1")  # which may be temperatures, disparities or distances as well


def recorded_topics(topics: Sequence[str], timeout: float = TIMEOUT) -> List[str]:
    """Returns what is recorded of topics of images, in their order.

    Args:
        topics: Whole names of topics of sensor_msgs/Image.
        timeout: How long is waited for an image of each, in s. Without one the topic itself is
            recorded, which loses nothing.

    Raises:
        ValueError: A topic has no such name.
        OSError: The master does not answer.
    """
    if not topics:
        return []
    encodings = _encodings(list(dict.fromkeys(topics)), timeout)
    with contextlib.closing(MasterCalls()) as master:
        published = dict(map(tuple, master.call("getPublishedTopics", "")))
    return [recorded_topic(topic, encodings.get(topic, ""), published) for topic in topics]


def recorded_topic(topic: str, encoding: str, published: Mapping[str, str]) -> str:
    """Returns the topic that is recorded of one of images.

    Args:
        topic: Its whole name.
        encoding: That of its images, "" if it is unknown.
        published: The types of topics by name.
    """
    end = ""
    if encoding in COLORS:
        end = BESIDE
    elif encoding in MAYBE_DEPTHS and "depth" in "/".join(topic.split("/")[-2:]):
        end = f"/{DEPTHS}"
    return topic + end if published.get(topic + end) == COMPRESSED_IMAGE else topic


def _encodings(topics: Sequence[str], timeout: float) -> Dict[str, str]:
    """Returns the encodings of those topics that send an image in time."""
    found: Dict[str, str] = {}
    complete = threading.Event()

    def take(topic: str, raw: RawMessage) -> None:
        message: Any = raw.decoded()
        if isinstance(message, Image):
            found[topic] = message.encoding
        if len(found) == len(topics):
            complete.set()

    with contextlib.ExitStack() as stack:
        for topic in topics:
            callback = functools.partial(take, topic)
            stack.enter_context(contextlib.closing(RawTopic(topic, callback)))
        complete.wait(timeout)
        return dict(found)
