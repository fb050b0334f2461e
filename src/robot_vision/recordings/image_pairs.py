"""Pairs of images of two cameras for a command: from files, bags and topics."""

import collections
import contextlib
import functools
import os
import re
import threading
from typing import Callable, Deque, Iterator, Sequence, Tuple

import numpy as np

from ..ros.transport import Frame, ImageSubscriber
from .bag_images import IMAGE_TYPES, entries_on, opened, require_topic, topics_of
from .gray_images import gray_message, gray_pixels
from .recorded_images import images_in, newest_of, paths_of
from .stamp_pairs import StampPairs

Images = Tuple[np.ndarray, np.ndarray]  # left and right, (height, width) uint8
# The name of a pair, and a function that reads it or raises OSError or ValueError.
NamedPair = Tuple[str, Callable[[], Images]]
MAX_DIGITS = 6  # of a number that counts images; longer ones are times


def pairs_from_files(names: Sequence[str]) -> Iterator[NamedPair]:
    """Yields the first image of both cameras, then the second of both, ..., sorted by name.

    Args:
        names: Of the left and the right camera a folder, a glob pattern, an image or a video.

    Raises:
        ValueError: There are not as many files of both, their names have numbers that differ, or
            one of them is no image and no video.
        OSError: A file cannot be read, or is not a regular file.
    """
    paths = [paths_of(name) for name in names]
    if len(paths[0]) != len(paths[1]):
        raise ValueError(
            f"{names[0]} and {names[1]} have {len(paths[0])} and {len(paths[1])} files, must have "
            "one image of each pair"
        )
    for left, right in zip(*paths):
        if _count_apart(os.path.basename(left), os.path.basename(right)):
            raise ValueError(f"{left} and {right} are no pair: no number in their names is equal")
        for (name, read_left), (other, read_right) in zip(images_in(left), images_in(right)):
            yield f"{name} + {other}", functools.partial(_both, read_left, read_right)


def pairs_from_bag(path: str, topics: Sequence[str], slop: float) -> Iterator[NamedPair]:
    """Yields the pairs on a left and a right topic of a bag, whose stamps are `slop` s apart.

    Raises:
        ValueError: There is no such bag or topic, or there are no pairs.
        OSError: The bag cannot be opened.
    """
    pairs: StampPairs = StampPairs(topics, slop)
    with opened(path) as bag:
        kinds = topics_of(bag)
        for topic in topics:
            require_topic(path, kinds, topic, IMAGE_TYPES, "images")
        for topic, message in entries_on(bag, topics):
            pair = pairs.add(topics.index(topic), message.header.stamp, message)
            if pair:
                reads = (functools.partial(gray_message, one) for one in pair)
                yield f"pair {pairs.found - 1}", functools.partial(_both, *reads)
    if not pairs.found:
        raise ValueError(f"{path} has no pairs: {pairs.problem()}")


def pairs_from_topics(topics: Sequence[str], slop: float) -> Iterator[NamedPair]:
    """Yields the newest pairs of two topics until this process, a node, shuts down."""
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
        print("waiting: no pair comes:", problem, flush=True)

    with contextlib.ExitStack() as stack:
        for side, topic in enumerate(topics):
            subscriber = ImageSubscriber(topic, functools.partial(keep, side))
            stack.callback(subscriber.unregister)
        for number, pair in enumerate(newest_of(newest, arrived, report)):
            reads = (functools.partial(gray_pixels, one.image, one.encoding) for one in pair)
            yield f"pair {number}", functools.partial(_both, *reads)


def _both(left: Callable[[], np.ndarray], right: Callable[[], np.ndarray]) -> Images:
    return left(), right()


def _count_apart(left: str, right: str) -> bool:
    """Whether two names count images, and none of their numbers is the same."""
    of_left, of_right = (re.findall(r"\d+", name) for name in (left, right))
    count = all(len(number) <= MAX_DIGITS for number in of_left + of_right)
    return (
        bool(of_left and of_right)
        and count
        and not any(int(a) == int(b) for a, b in zip(of_left, of_right))
    )
