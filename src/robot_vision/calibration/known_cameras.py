"""Cameras that are calibrated already, from files, topics and bags."""

from typing import Dict, Optional, Tuple

import rospy
from sensor_msgs.msg import CameraInfo

from .. import CameraModel
from ..common.errors import about
from ..recordings.bag_images import messages_on, opened, require_topic, topics_of
from ..ros.camera_info import cameras_of
from .camera_file import read_camera

TIMEOUT = 10.0  # s, longest wait for a camera_info
SUFFIXES = (".yaml", ".yml")


def is_camera_file(source: str) -> bool:
    """Returns whether known_cameras() takes this for a file, and not for a topic."""
    return source.endswith(SUFFIXES)


def known_cameras(source: str, bag: Optional[str] = None) -> Dict[Tuple[int, int], CameraModel]:
    """Returns the camera of a calibration file, or of a topic of camera_info, by its images' size.

    A camera_info may be of images of two sizes, see cameras_of().

    Args:
        source: The path of a file that ends in .yaml or .yml, or a topic.
        bag: The path of the bag with the topic. None: somebody publishes it, and this process is
            a node.

    Raises:
        ValueError: There is no camera_info, or the camera is not calibrated.
        OSError: The file or the bag cannot be read.
    """
    if is_camera_file(source):
        camera = read_camera(source)
        return {(camera.width, camera.height): camera}
    info = _recorded(source, bag) if bag else _published(source)
    with about(f"camera_info on {source}"):
        return cameras_of(info)


def _recorded(topic: str, bag: str) -> CameraInfo:
    with opened(bag) as messages:
        require_topic(bag, topics_of(messages), topic, [CameraInfo._type], "camera_info")
        return next(messages_on(messages, topic))


def _published(topic: str) -> CameraInfo:
    try:
        return rospy.wait_for_message(topic, CameraInfo, TIMEOUT)
    except rospy.ROSException:
        raise ValueError(f"no camera_info comes on {topic}") from None
