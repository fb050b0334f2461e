"""Recorded or live images for a command: from files, bags and topics."""

import collections
import functools
import glob
import os
import threading
from typing import Callable, Deque, Iterator, List, Sequence, TypeVar

import cv2
import numpy as np
import rospy

from ..common.files import MAX_IMAGE, read_file, require_file, trying
from ..common.image_files import has_image_suffix
from ..common.plain_text import printable
from ..ros.transport import Frame, ImageSubscriber
from .bag_images import IMAGE_TYPES, NamedImage, images_on, opened, require_topic, topics_of
from .gray_images import gray_file, gray_pixels

TIMEOUT = 2.0  # s without an image until that is reported
MAX_PATH = 1000  # characters of a path that is shown

Item = TypeVar("Item")


def from_files(names: Sequence[str]) -> Iterator[NamedImage]:
    """Yields the images of folders, glob patterns, image files and videos, sorted by name.

    Raises:
        ValueError: A file that is not named like an image is not a video either, or nothing has
            the name.
        OSError: A file cannot be read, or is not a regular file.
    """
    for name in names:
        for path in paths_of(name):
            yield from images_in(path)


def images_in(path: str) -> Iterator[NamedImage]:
    """Yields the image of an image file, or those of a video.

    Raises:
        ValueError, OSError: As from_files().
    """
    if has_image_suffix(path):
        yield shown(path), functools.partial(_read, path)
    else:
        yield from _video(path)


def from_bag(path: str, topic: str) -> Iterator[NamedImage]:
    """Yields the images on a topic of a bag.

    Raises:
        ValueError: There is no such bag or topic.
        OSError: The bag cannot be opened.
    """
    with opened(path) as bag:
        require_topic(path, topics_of(bag), topic, IMAGE_TYPES, "images")
        yield from images_on(bag, topic)


def from_topic(topic: str) -> Iterator[NamedImage]:
    """Yields the newest images of a topic until this process, which must be a node, shuts down."""
    newest: Deque[Frame] = collections.deque(maxlen=1)
    arrived = threading.Event()

    def keep(frame: Frame) -> None:
        newest.append(frame)
        arrived.set()

    subscriber = ImageSubscriber(topic, keep)
    frames = newest_of(newest, arrived, lambda: print(_missing(subscriber), flush=True))
    try:
        for number, frame in enumerate(frames):
            yield f"image {number}", functools.partial(gray_pixels, frame.image, frame.encoding)
    finally:
        subscriber.unregister()


def newest_of(
    newest: Deque[Item], arrived: threading.Event, report: Callable[[], object]
) -> Iterator[Item]:
    """Yields what other threads put into a deque until this process, a node, shuts down.

    Args:
        newest: The deque.
        arrived: Set after something was put into it.
        report: Called now and then while nothing arrives.
    """
    rospy.on_shutdown(arrived.set)
    while not rospy.core.is_shutdown_requested():
        if newest:
            yield newest.pop()
        elif arrived.wait(TIMEOUT):
            arrived.clear()
        else:
            report()


def _missing(subscriber: ImageSubscriber) -> str:
    nobody = "" if subscriber.get_num_connections() else "; nobody publishes images there"
    return f"waiting: no image comes on {subscriber.topic}{nobody}"


def paths_of(name: str) -> List[str]:
    """Returns the images of a folder, the path of a file, or those of a glob pattern, sorted.

    Raises:
        ValueError: Nothing has the name, or the folder has no images.
        OSError: The folder cannot be read.
    """
    if os.path.isdir(name):
        with trying(name, "read"):
            found = [os.path.join(name, entry) for entry in sorted(os.listdir(name))]
        images = list(filter(has_image_suffix, found))
        if not images:
            raise ValueError(f"{name}: no images in this folder")
        return images
    if os.path.exists(name):
        return [name]
    found = sorted(glob.glob(name))
    if not found:
        raise ValueError(f"{name}: no such file or folder")
    return found


def shown(path: str) -> str:
    """Returns a path as a name: who filled a folder has named its files."""
    return printable(path, MAX_PATH)


def _read(path: str) -> np.ndarray:
    return gray_file(read_file(path, MAX_IMAGE))


def _video(path: str) -> Iterator[NamedImage]:
    require_file(path)
    video = cv2.VideoCapture(path, cv2.CAP_FFMPEG)
    if hasattr(cv2, "CAP_PROP_ORIENTATION_AUTO"):  # Older versions of OpenCV never rotate frames.
        video.set(cv2.CAP_PROP_ORIENTATION_AUTO, 0)
    found, number = True, 0
    while found:
        found, image = video.read()
        if found:
            yield f"{shown(path)}, frame {number}", functools.partial(gray_pixels, image, "bgr8")
            number += 1
    if not number:
        raise ValueError(f"{path}: no image and no video that OpenCV can read")
