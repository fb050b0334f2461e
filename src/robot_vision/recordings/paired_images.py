"""Images of two topics that belong together by their stamps: of a bag, and as they come."""

import collections
import contextlib
import functools
import threading
from typing import Any, Deque, Iterator, Sequence, Tuple

from ..ros.transport import Frame, ImageSubscriber
from .bag_images import IMAGE_TYPES, entries_on, opened, require_topic, topics_of
from .recorded_images import newest_of
from .stamp_pairs import StampPairs


def paired_messages(
    path: str, topics: Sequence[str], slop: float, what: str
) -> Iterator[Tuple[Any, Any]]:
    """Yields the messages on two topics of a bag whose stamps are at most `slop` s apart.

    Args:
        path: The bag.
        topics: The two topics, of images.
        slop: s.
        what: What a bag has that has such messages, for the error: "pairs".

    Raises:
        OSError: The bag cannot be opened.
        ValueError: There is no such bag or topic, or nothing on the topics belongs together.
    """
    pairs: StampPairs = StampPairs(topics, slop)
    with opened(path) as bag:
        kinds = topics_of(bag)
        for topic in topics:
            require_topic(path, kinds, topic, IMAGE_TYPES, "images")
        for topic, message in entries_on(bag, topics):
            pair = pairs.add(topics.index(topic), message.header.stamp, message)
            if pair:
                yield pair
    if not pairs.found:
        raise ValueError(f"{path} has no {what}: {pairs.problem()}")


def paired_frames(topics: Sequence[str], slop: float, what: str) -> Iterator[Tuple[Frame, Frame]]:
    """Yields the newest frames of two topics until this process, a node, shuts down.

    Args:
        topics: The two topics, of images.
        slop: s, between the stamps.
        what: What the two are together, for the line that nothing comes: "pair".
    """
    pairs: StampPairs = StampPairs(topics, slop)
    lock = threading.Lock()  # guards the pairs
    newest: Deque[Tuple[Frame, Frame]] = collections.deque(maxlen=1)
    arrived = threading.Event()

    def keep(side: int, frame: Frame) -> None:
        with lock:
            pair = pairs.add(side, frame.header.stamp, frame)
        if pair:
            newest.append(pair)
            arrived.set()

    def report() -> None:
        with lock:
            problem = pairs.problem()
        print(f"waiting: no {what} comes:", problem, flush=True)

    with contextlib.ExitStack() as stack:
        for side, topic in enumerate(topics):
            subscriber = ImageSubscriber(topic, functools.partial(keep, side))
            stack.callback(subscriber.unregister)
        yield from newest_of(newest, arrived, report)
