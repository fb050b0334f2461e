"""Tags in the images of a bag, for calibrate_bundle.py."""

import argparse
import time
from typing import Dict, Tuple

import numpy as np
import rosbag
from sensor_msgs.msg import CameraInfo

from .. import CameraModel, TagDetector, TagDetectorParams
from ..common.errors import about
from ..common.progress import Progress
from ..recordings.bag_images import (
    IMAGE_TYPES,
    images_on,
    messages_on,
    opened,
    require_topic,
    topics_of,
)
from ..ros.camera_info import cameras_of, size_words
from ..ros.transport import camera_info_beside
from .frame_collection import FrameCollection

PROGRESS = 1.0  # s between lines of progress


def collect_from_bag(
    arguments: argparse.Namespace, collection: FrameCollection, progress: Progress
) -> CameraModel:
    """Offers the images of a topic to the collection, until it is full or the user presses Ctrl-C.

    Args:
        arguments: The bag, the topics `image` and `camera_info` in it ("": beside the images), and
            the family of the tags.
        collection: The collection.
        progress: The printer of progress messages.

    Returns:
        The camera of the images.

    Raises:
        ValueError: There is no such bag, topic or calibration, or an image cannot be used.
        OSError: The bag cannot be opened.
    """
    path, image = arguments.bag, arguments.image
    with opened(path) as bag:
        kinds = topics_of(bag)
        require_topic(path, kinds, image, IMAGE_TYPES, "images")
        camera_info = arguments.camera_info or _beside(image, kinds[image])
        require_topic(path, kinds, camera_info, [CameraInfo._type], "camera_info")
        info = next(messages_on(bag, camera_info))
        with about(f"{path}: camera_info on {camera_info}"):
            cameras = cameras_of(info)
        _collect(bag, arguments, cameras, collection, progress)
        return next(iter(cameras.values()))


def _collect(
    bag: rosbag.Bag,
    arguments: argparse.Namespace,
    cameras: Dict[Tuple[int, int], CameraModel],
    collection: FrameCollection,
    progress: Progress,
) -> None:
    """Offers the images to the collection, and leaves that camera which is of their size."""
    params = TagDetectorParams()
    params.families = [arguments.family]
    detector, image = TagDetector(params), arguments.image
    last_progress = time.monotonic()
    try:
        for name, read in images_on(bag, image):
            with about(f"{name} on {image} cannot be used"):
                gray = read()
                tags = detector.detect(gray, "mono8")
            size = gray.shape[1::-1]
            if size not in cameras:
                sizes = size_words(cameras), size_words([size])
                raise ValueError(f"camera_info is of {sizes[0]}, {name} on {image} {sizes[1]}")
            for other in cameras.keys() - {size}:
                del cameras[other]
            collection.add(cameras[size], [(tag.id, np.asarray(tag.corners)) for tag in tags])
            if collection.full:
                return
            if time.monotonic() - last_progress > PROGRESS:
                last_progress = time.monotonic()
                progress.tell(collection.summary())
    except KeyboardInterrupt:
        return


def _beside(image: str, kind: str) -> str:
    """Returns the topic of the camera_info that belongs to an image topic of this type."""
    return camera_info_beside(image if kind == IMAGE_TYPES[0] else image.rsplit("/", 1)[0])
