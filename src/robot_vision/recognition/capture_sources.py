"""Frames of a color camera and their depths for object_capture.py: from topics, bags, folders."""

import functools
import os
from typing import Any, Callable, Dict, Iterator, NamedTuple, Sequence, Tuple

import numpy as np
from sensor_msgs.msg import Image

from .. import CameraModel, is_equidistant, to_bgr
from ..calibration.known_cameras import known_cameras
from ..common import opencv as cv2
from ..common.depth_encodings import require_depths
from ..common.files import MAX_IMAGE, read_file
from ..common.image_files import sensor_pixels
from ..recordings.depth_images import depth_pixels
from ..recordings.image_pixels import pixels_of
from ..recordings.paired_images import paired_frames, paired_messages
from ..recordings.recorded_images import paths_of
from ..ros.transport import Frame

CAMERA_FILE = "camera.yaml"
FRAME_PERIOD = 1.0  # s, between two files: they have no times, and none waits for the next one

Images = Tuple[np.ndarray, np.ndarray]  # BGR, and its depths as uint16 in mm or float32 in m


class Shot(NamedTuple):
    """A frame.

    Attributes:
        name: For messages.
        time: s.
        read: A function that returns its images, or raises OSError or ValueError.
    """

    name: str
    time: float
    read: Callable[[], Images]


def capture_cameras(camera_info: str, bag: str, folder: str) -> Dict[Tuple[int, int], CameraModel]:
    """Returns the camera by its images' size: of a topic, in a bag if there is one, or of a file.

    Raises:
        OSError: A file or the bag cannot be read.
        ValueError: There is no calibration, or it has a lens that observations cannot tell.
    """
    if folder and not camera_info:
        camera_info = os.path.join(folder, CAMERA_FILE)
    cameras = known_cameras(camera_info, bag or None)
    for camera in cameras.values():
        if is_equidistant(camera.distortion_model):
            raise ValueError(
                f"camera_info of {camera_info}: the lens is {camera.distortion_model}, must be "
                "plumb_bob or rational_polynomial: take rectified images"
            )
    return cameras


def shots_from_folder(folder: str) -> Iterator[Shot]:
    """Yields the frames of a folder with rgb/NAME.png and depth/NAME.png, sorted by name.

    Raises:
        OSError: The folder cannot be read.
        ValueError: There are no images, or not as many depths.
    """
    colors, depths = (paths_of(os.path.join(folder, part)) for part in ("rgb", "depth"))
    stems = [
        [os.path.splitext(os.path.basename(path))[0] for path in one] for one in (colors, depths)
    ]
    if stems[0] != stems[1]:
        raise ValueError(f"{folder}: the files in rgb and depth must have the same names")
    for number, (color, depth) in enumerate(zip(colors, depths)):
        yield Shot(color, FRAME_PERIOD * number, functools.partial(_read_files, color, depth))


def shots_from_bag(path: str, topics: Sequence[str], slop: float) -> Iterator[Shot]:
    """Yields the frames on two topics of a bag, of images and of their depths.

    Raises:
        OSError: The bag cannot be opened.
        ValueError: There is no such bag or topic, or nothing on the topics belongs together.
    """
    for number, pair in enumerate(paired_messages(path, topics, slop, "images with depths")):
        time = pair[0].header.stamp.to_sec()
        yield Shot(f"frame {number}", time, functools.partial(_read_messages, *pair))


def shots_from_topics(topics: Sequence[str], slop: float) -> Iterator[Shot]:
    """Yields the newest frames of two topics until this process, a node, shuts down."""
    for number, pair in enumerate(paired_frames(topics, slop, "image with depths")):
        time = pair[0].header.stamp.to_sec()
        yield Shot(f"frame {number}", time, functools.partial(_read_frames, *pair))


def _read_files(color: str, depth: str) -> Images:
    depths = sensor_pixels(read_file(depth, MAX_IMAGE), cv2.IMREAD_UNCHANGED)
    if depths.dtype != np.uint16 or depths.ndim != 2:
        raise ValueError(f"{depth} must have one channel of 16 bits, mm")
    return sensor_pixels(read_file(color, MAX_IMAGE)), depths


def _read_messages(color: Any, depth: Any) -> Images:
    if color._type == Image._type:
        return to_bgr(pixels_of(color), color.encoding), depth_pixels(depth)
    return sensor_pixels(color.data), depth_pixels(depth)


def _read_frames(color: Frame, depth: Frame) -> Images:
    require_depths(depth.encoding)
    return to_bgr(color.image, color.encoding), depth.image
