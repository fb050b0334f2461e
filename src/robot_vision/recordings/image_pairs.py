"""Pairs of images of two cameras for a command: from files, bags and topics."""

import functools
import os
import re
from typing import Callable, Iterator, Sequence, Tuple

import numpy as np

from .gray_images import gray_message, gray_pixels
from .paired_images import paired_frames, paired_messages
from .recorded_images import images_in, paths_of, shown

Images = Tuple[np.ndarray, np.ndarray]  # left and right, (height, width) uint8
# The name of a pair, to be shown, and a function that reads it or raises OSError or ValueError.
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
            names_of_both = f"{shown(left)} and {shown(right)}"
            raise ValueError(f"{names_of_both} are no pair: no number in their names is equal")
        for (name, read_left), (other, read_right) in zip(images_in(left), images_in(right)):
            yield f"{name} + {other}", functools.partial(_both, read_left, read_right)


def pairs_from_bag(path: str, topics: Sequence[str], slop: float) -> Iterator[NamedPair]:
    """Yields the pairs on a left and a right topic of a bag, whose stamps are `slop` s apart.

    Raises:
        ValueError: There is no such bag or topic, or there are no pairs.
        OSError: The bag cannot be opened.
    """
    for number, pair in enumerate(paired_messages(path, topics, slop, "pairs")):
        reads = (functools.partial(gray_message, one) for one in pair)
        yield f"pair {number}", functools.partial(_both, *reads)


def pairs_from_topics(topics: Sequence[str], slop: float) -> Iterator[NamedPair]:
    """Yields the newest pairs of two topics until this process, a node, shuts down."""
    for number, pair in enumerate(paired_frames(topics, slop, "pair")):
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
