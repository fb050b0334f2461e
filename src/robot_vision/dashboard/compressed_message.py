"""Bytes of a sensor_msgs/CompressedImage, taken out of the message without decoding anything."""

import struct
from typing import Any, Tuple

from .. import compressed_info
from ..common.plain_text import printable
from .channels import JPEG, PNG
from .image_topics import COMPRESSED_IMAGE, DEPTHS
from .orientation import without_exif
from .pictures import Picture

KINDS = {"jpeg": JPEG, "png": PNG}
_STAMP = struct.Struct("<III")  # seq, secs, nsecs
_LENGTH = struct.Struct("<I")


def picture_of(raw: Any) -> Picture:
    """Returns the picture of a message, whose bytes have no EXIF data.

    Args:
        raw: A RawMessage of any topic.

    Raises:
        ValueError: It is no JPEG or PNG, or damaged.
    """
    if raw.type != COMPRESSED_IMAGE:
        raise ValueError(f"a message is of {printable(raw.type)}, must be of {COMPRESSED_IMAGE}")
    if raw.message is None:
        stamp, form, data = _fields(raw.data)
    else:
        message = raw.message
        stamp, form, data = message.header.stamp.to_sec(), message.format, bytes(message.data)
    if DEPTHS in form:
        raise ValueError("what is compressed by compressedDepth cannot be shown")
    name, width, height = compressed_info(data)
    kind = KINDS[name]
    data = without_exif(kind, data)
    return Picture(stamp or raw.ros_time, raw.received, width, height, None, kind, data)


def _fields(message: bytes) -> Tuple[float, str, bytes]:
    """Returns stamp, format and data of a serialized message."""
    try:
        _, secs, nsecs = _STAMP.unpack_from(message, 0)
        at = _behind(message, _STAMP.size)[1]
        begin, at = _behind(message, at)
        form = message[begin:at].decode("utf-8", "replace")
        begin, end = _behind(message, at)
    except struct.error:
        raise ValueError("a message is cut off") from None
    if end != len(message):
        raise ValueError(f"a message has {len(message)} bytes, must have {end}")
    return secs + nsecs * 1e-9, form, message[begin:end]


def _behind(message: bytes, at: int) -> Tuple[int, int]:
    """Returns begin and end of the text or the array whose length is at a place."""
    (length,) = _LENGTH.unpack_from(message, at)
    begin = at + _LENGTH.size
    if length > len(message) - begin:
        raise struct.error
    return begin, begin + length
