"""Requests with the URLs of web_video_server: what they ask for, as its README says."""

from typing import Mapping, NamedTuple, Tuple

from ..common.plain_text import brief
from ..ros.graph_master import graph_name
from .channels import JPEG, PNG
from .pictures import Wish

MAX_SIDE = 8192  # px
TYPES = ("mjpeg", "png", "ros_compressed")
VIDEO_TYPES = ("vp8", "vp9", "h264")


class ImageRequest(NamedTuple):
    """What is asked for.

    Attributes:
        topic: The whole name of the topic.
        wish: How it is to be seen.
        passed: Whether what comes compressed is passed on as it is.
        compressed: Whether that is asked for, by type ros_compressed.
    """

    topic: str
    wish: Wish
    passed: bool
    compressed: bool


def parse_image_request(arguments: Mapping[str, str], quality: int) -> ImageRequest:
    """Returns what the arguments of a URL ask for.

    default_transport, qos_profile, and what only videos need, mean nothing here.

    Args:
        arguments: topic, and maybe type, width, height, quality and invert.
        quality: That of JPEGs if nothing else is asked for.

    Raises:
        ValueError: Something cannot be what it is.
    """
    topic = arguments.get("topic", "")
    if not topic:
        raise ValueError("topic is missing, must be that of images: ?topic=/usb_cam/image_raw")
    topic = graph_name(topic if topic.startswith("/") else "/" + topic)
    kind = arguments.get("type", "mjpeg") or "mjpeg"
    if kind in VIDEO_TYPES:
        raise ValueError(
            f"type is {kind}, which would be encoded for each viewer; must be one of "
            f"{', '.join(TYPES)}, which a page shows by <img>"
        )
    if kind not in TYPES:
        raise ValueError(f"type is {brief(kind)}, must be one of {', '.join(TYPES)}")
    wish = Wish(
        width=_number(arguments, "width", 0, MAX_SIDE),
        height=_number(arguments, "height", 0, MAX_SIDE),
        quality=_number(arguments, "quality", quality, 100),
        kind=PNG if kind == "png" else JPEG,
        turned="invert" in arguments,
    )
    compressed = kind == "ros_compressed"
    as_it_is = wish == Wish(quality=quality) and "quality" not in arguments
    return ImageRequest(topic, wish, compressed or as_it_is, compressed)


def _number(arguments: Mapping[str, str], name: str, default: int, high: int) -> int:
    text = arguments.get(name, "")
    if not text or (text == "-1" and name != "quality"):  # -1 is its default
        return default
    if not (text.isascii() and text.isdigit() and len(text) < 10 and 1 <= int(text) <= high):
        raise ValueError(f"{name} is {brief(text)}, must be from 1 to {high}")
    return int(text)


def part_of(data: bytes, mime: str, stamp: float) -> Tuple[bytes, bytes, bytes]:
    """Returns a part of a multipart/x-mixed-replace: what comes before and behind the bytes.

    The boundary comes at once, as browsers show a part only when it has ended.
    """
    head = (
        f"Content-Type: {mime}\r\nX-Timestamp: {stamp:.6f}\r\nContent-Length: {len(data)}\r\n\r\n"
    )
    return head.encode(), data, b"\r\n--" + BOUNDARY + b"\r\n"


BOUNDARY = b"boundarydonotcross"
