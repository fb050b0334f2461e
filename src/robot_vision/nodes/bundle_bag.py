"""Tags in the pictures of a bag, for calibrate_bundle.py."""

import time
from typing import Any, Dict, Tuple

import cv2
import cv_bridge
import numpy as np
import rosbag

from .. import CameraModel, TagDetector, TagDetectorParams
from ..frame_collection import FrameCollection
from ..transport import camera_info_beside
from .calibration import camera_model

PICTURES = ("sensor_msgs/Image", "sensor_msgs/CompressedImage")
CAMERA_INFO = ("sensor_msgs/CameraInfo",)
PROGRESS = 1.0  # s between lines


def collect_from_bag(
    path: str, image: str, camera_info: str, family: str, collection: FrameCollection
) -> CameraModel:
    """Offers the pictures of a topic to the collection, until it is full or on Ctrl-C.

    Args:
        camera_info: the topic; empty: the one beside the picture's.

    Returns:
        The camera that they are from.

    Raises:
        ValueError: there is no such bag, topic or calibration, or a picture cannot be used.
        OSError: the bag cannot be opened.
    """
    try:
        with rosbag.Bag(path) as bag:
            kinds = {
                name: topic.msg_type for name, topic in bag.get_type_and_topic_info()[1].items()
            }
            _require_topic(path, kinds, image, PICTURES, "pictures")
            camera_info = camera_info or _beside(image, kinds[image])
            _require_topic(path, kinds, camera_info, CAMERA_INFO, "camera_info")
            _, info, _ = next(bag.read_messages(camera_info))
            try:
                camera = camera_model(info, (info.width, info.height))
            except ValueError as error:
                raise ValueError(f"{path}: camera_info on {camera_info}: {error}") from None
            _collect(bag, image, family, camera, collection)
            return camera
    except rosbag.ROSBagUnindexedException:
        raise ValueError(f"{path} has no index: try rosbag reindex {path}") from None
    except rosbag.ROSBagException as error:
        raise ValueError(f"{path} cannot be read: {error}") from None


def _collect(
    bag: rosbag.Bag, image: str, family: str, camera: CameraModel, collection: FrameCollection
) -> None:
    params = TagDetectorParams()
    params.families = [family]
    detector = TagDetector(params)
    told = time.monotonic()
    try:
        for number, (_, message, _) in enumerate(bag.read_messages(image)):
            try:
                picture, encoding = _picture(message)
                tags = detector.detect(picture, encoding)
            except (cv_bridge.CvBridgeError, TypeError, ValueError) as error:
                raise ValueError(f"picture {number} on {image} cannot be used: {error}") from None
            size = picture.shape[1::-1]
            if size != (camera.width, camera.height):
                raise ValueError(
                    f"camera_info is of {camera.width}x{camera.height}, "
                    f"picture {number} on {image} {size[0]}x{size[1]}"
                )
            collection.add(camera.width, [(tag.id, np.asarray(tag.corners)) for tag in tags])
            if collection.full:
                return
            if time.monotonic() - told > PROGRESS:
                told = time.monotonic()
                print(collection.summary(), flush=True)
    except KeyboardInterrupt:
        return


def _picture(message: Any) -> Tuple[np.ndarray, str]:
    """The pixels of a message, and their encoding.

    Raises:
        ValueError: they are none.
    """
    data = np.frombuffer(message.data, np.uint8)
    if message._type == PICTURES[1]:
        picture = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE) if data.size else None
        if picture is None:
            raise ValueError("no picture that OpenCV can read")
        return picture, "mono8"
    # cv_bridge itself may take the bytes between two rows for pixels.
    kind, channels = cv_bridge.CvBridge().encoding_to_dtype_with_channels(message.encoding)
    dtype = np.dtype(kind).newbyteorder(">" if message.is_bigendian else "<")
    rows = data.reshape(message.height, message.step)
    pixels = rows[:, : message.width * channels * dtype.itemsize].copy().view(dtype)
    shape = (message.height, message.width) + ((channels,) if channels > 1 else ())
    return pixels.reshape(shape).astype(kind), message.encoding


def _beside(image: str, kind: str) -> str:
    """The topic of the camera_info that belongs to one of pictures."""
    return camera_info_beside(image if kind == PICTURES[0] else image.rsplit("/", 1)[0])


def _require_topic(path: str, kinds: Dict[str, str], topic: str, wanted: Any, what: str) -> None:
    if kinds.get(topic) not in wanted:
        there = sorted(name for name, kind in kinds.items() if kind in wanted)
        raise ValueError(
            f"{path} has no {what} on '{topic}', but on {', '.join(there) or 'no topic'}"
        )
