"""The images in the gallery of a node, which runs on the same machine."""

import base64
import os

import rospkg

from ..common import opencv as cv2
from ..common.files import read_file
from ..common.image_files import upright
from ..common.plain_text import brief, printable
from ..faces.gallery_files import MAX_FILE, folder_of, image_paths, inside
from ..ros.graph_master import graph_name, server_param

MAX_SIDE = 96  # px of an image that the page gets
JPEG_QUALITY = 80


def gallery_of(node: str) -> str:
    """Returns the folder of a node's gallery, by its parameter ~gallery.

    Raises:
        ValueError: The parameter is no path.
        OSError: The master does not answer.
    """
    folder = server_param(f"{graph_name(node)}/gallery") or ""
    if not isinstance(folder, str) or "\0" in folder:
        raise ValueError(f"{node}/gallery is {brief(folder)}, must be a folder")
    default = os.path.join(rospkg.get_ros_home(), "robot_vision", "faces")
    return os.path.abspath(os.path.expanduser(folder or default))


def small_picture(gallery: str, name: str, index: int) -> str:
    """Returns a small copy of one of a person's images: JPEG in base64.

    Args:
        gallery: The folder of the gallery.
        name: The person's name, as valid_name() returns it.
        index: The number of the image, from 0.

    Raises:
        ValueError: There is no such image, or it leads out of the gallery, or it is none.
        OSError: It cannot be read.
    """
    paths = image_paths(folder_of(gallery, name))
    if index >= len(paths):
        raise ValueError(f"index is {index}, there are {len(paths)} images of '{printable(name)}'")
    image = upright(read_file(inside(gallery, paths[index]), MAX_FILE))
    scale = MAX_SIDE / max(image.shape[:2])
    if scale < 1.0:
        size = tuple(max(round(side * scale), 1) for side in image.shape[1::-1])
        image = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    jpeg = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1]
    return base64.b64encode(jpeg.tobytes()).decode()
