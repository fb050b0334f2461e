"""Images in bags, for commands."""

import contextlib
import functools
from typing import Any, Callable, Dict, Iterator, Sequence, Tuple

import numpy as np
import rosbag

from ..common.files import require_file
from ..common.plain_text import printable
from .gray_images import gray_message

# The name of an image, to be shown, and a function that reads it as (height, width) uint8 or
# raises ValueError.
NamedImage = Tuple[str, Callable[[], np.ndarray]]
MAX_MESSAGE = 200  # characters of an error message
IMAGE_TYPES = ("sensor_msgs/Image", "sensor_msgs/CompressedImage")


@contextlib.contextmanager
def opened(path: str) -> Iterator[rosbag.Bag]:
    """Opens a bag for reading.

    Raises:
        ValueError: The file is not a bag, or is truncated.
        OSError: The file cannot be opened.
    """
    require_file(path)
    with _reading(path):
        bag = rosbag.Bag(path)
    with bag:
        yield bag


def topics_of(bag: rosbag.Bag) -> Dict[str, str]:
    """Returns the message type of each topic that has messages.

    Raises:
        ValueError: The bag is damaged.
    """
    with _reading(bag.filename):
        topics = bag.get_type_and_topic_info()[1]
        return {name: one.msg_type for name, one in topics.items() if one.message_count}


def messages_on(bag: rosbag.Bag, topic: str) -> Iterator[Any]:
    """Yields the messages of a topic.

    Raises:
        ValueError: The bag is damaged.
    """
    for _, message in entries_on(bag, [topic]):
        yield message


def entries_on(bag: rosbag.Bag, topics: Sequence[str]) -> Iterator[Tuple[str, Any]]:
    """Yields the topic and the message of each entry on some topics, in the order of their times.

    Raises:
        ValueError: The bag is damaged.
    """
    entries = bag.read_messages(list(topics))
    while True:
        with _reading(bag.filename):
            entry = next(entries, None)
        if entry is None:
            return
        yield entry.topic, entry.message


@contextlib.contextmanager
def _reading(path: str) -> Iterator[None]:
    """Names the bag in every error of rosbag, which raises many kinds of them for damaged files."""
    try:
        yield
    except rosbag.ROSBagUnindexedException:
        raise ValueError(f"{path} has no index: try rosbag reindex {path}") from None
    except Exception as error:
        what = printable(" ".join(str(error).split()), MAX_MESSAGE) or type(error).__name__
        raise ValueError(f"{path} cannot be read: {what}") from None


def require_topic(
    path: str, kinds: Dict[str, str], topic: str, wanted: Sequence[str], what: str
) -> None:
    """Raises ValueError if the bag has no messages of the types `wanted` on the topic."""
    if kinds.get(topic) not in wanted:
        there = sorted(printable(name) for name, kind in kinds.items() if kind in wanted)
        raise ValueError(
            f"{path} has no {what} on '{topic}', but on {', '.join(there) or 'no topic'}"
        )


def images_on(bag: rosbag.Bag, topic: str) -> Iterator[NamedImage]:
    """Yields the images of a topic."""
    for number, message in enumerate(messages_on(bag, topic)):
        yield f"image {number}", functools.partial(gray_message, message)
