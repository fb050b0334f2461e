"""Recorded depth images, raw or compressed."""

from typing import Any, Iterator, Tuple

import numpy as np
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from .. import decompress_depth
from ..common.depth_encodings import require_depths
from .bag_images import IMAGE_TYPES, messages_on, opened, require_topic, topics_of
from .image_pixels import pixels_of


def depth_pixels(message: Any) -> np.ndarray:
    """Returns the depths of a sensor_msgs/Image, or of a CompressedImage of compressedDepth.

    Returns:
        (height, width) uint16 in mm, 0 where there is none, or float32 in m, NaN where there is
        none.

    Raises:
        ValueError: The message has no depths, or is damaged.
    """
    if message._type != Image._type:
        return decompress_depth(message.format, message.data)
    require_depths(message.encoding)
    return pixels_of(message)


def depths_of_bag(path: str, topic: str) -> Iterator[Tuple[Header, np.ndarray]]:
    """Yields the header and the depths of each image on a topic of a bag, as depth_pixels() does.

    Raises:
        ValueError: There is no such bag or topic, or an image has no depths or is damaged.
        OSError: The bag cannot be opened.
    """
    with opened(path) as bag:
        require_topic(path, topics_of(bag), topic, IMAGE_TYPES, "images")
        for number, message in enumerate(messages_on(bag, topic)):
            try:
                depths = depth_pixels(message)
            except ValueError as error:
                raise ValueError(f"{path}: image {number} on {topic}: {error}") from None
            yield message.header, depths
