"""Photographs of a camera that lay on its side."""

import struct
import zlib

TURN = 6  # EXIF orientation: the image is to be rotated clockwise for display


def _tiff() -> bytes:
    """EXIF data with an orientation only."""
    entry = struct.pack(">HHIHH", 0x0112, 3, 1, TURN, 0)
    return b"MM\0*" + struct.pack(">IH", 8, 1) + entry + struct.pack(">I", 0)


def sideways(jpeg: bytes) -> bytes:
    """The JPEG with an EXIF segment that contains an orientation only."""
    segment = b"Exif\0\0" + _tiff()
    return jpeg[:2] + b"\xff\xe1" + struct.pack(">H", len(segment) + 2) + segment + jpeg[2:]


def sideways_png(png: bytes, before: bytes = b"IDAT") -> bytes:
    """The PNG with an EXIF chunk that contains an orientation only, before another chunk."""
    chunk = b"eXIf" + _tiff()
    at = png.index(before) - 4
    whole = struct.pack(">I", len(chunk) - 4) + chunk + struct.pack(">I", zlib.crc32(chunk))
    return png[:at] + whole + png[at:]
