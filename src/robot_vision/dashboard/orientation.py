"""Takes out of JPEG and PNG what says that they are to be turned.

Browsers turn an image as its EXIF data says, and decoders of this package do not: what nodes find
and what people select is in pixels as the sensor had them.
"""

import re
import struct
from typing import Iterator, Tuple

from .channels import PNG

_APP1, _SCAN = 0xE1, 0xDA  # JPEG's markers of what may be EXIF, and of the pixels
_EXIF = b"Exif\0\0"
_FILL = re.compile(b"\xff+")
_PNG_BEGIN = 8  # bytes before the first chunk
_PNG_AROUND = 12  # bytes of a chunk that are not its data
_CHUNK = struct.Struct(">I4s")


def without_exif(kind: int, data: bytes) -> bytes:
    """Returns an image without EXIF data, or the same bytes if it has none.

    Args:
        kind: channels.JPEG or channels.PNG.
        data: The whole file. Where it is damaged, what follows stays as it is.
    """
    parts = _png_exif(data) if kind == PNG else _jpeg_exif(data)
    kept, begin = [], 0
    for at, end in parts:
        kept.append(data[begin:at])
        begin = end
    return b"".join([*kept, data[begin:]]) if begin else data


def _jpeg_exif(data: bytes) -> Iterator[Tuple[int, int]]:
    """Yields where EXIF data begin and end."""
    at = 2
    while at + 4 <= len(data) and data[at] == 0xFF and data[at + 1] != _SCAN:
        if data[at + 1] == 0xFF:  # before a marker there may be any number of these
            at = _FILL.match(data, at).end() - 1
            continue
        end = at + 2 + int.from_bytes(data[at + 2 : at + 4], "big")
        if data[at + 1] == _APP1 and data.startswith(_EXIF, at + 4):
            yield at, end
        at = end


def _png_exif(data: bytes) -> Iterator[Tuple[int, int]]:
    if b"eXIf" not in data:  # as in nearly all, which may have hundreds of chunks
        return
    at = _PNG_BEGIN
    while at + _CHUNK.size <= len(data):
        length, name = _CHUNK.unpack_from(data, at)
        end = at + length + _PNG_AROUND
        if name == b"eXIf":
            yield at, end
        at = end
