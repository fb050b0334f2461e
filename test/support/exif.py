"""Photographs of a camera that lay on its side."""

import struct

TURN = 6  # EXIF orientation: the image is to be rotated clockwise for display


def sideways(jpeg: bytes) -> bytes:
    """The JPEG with an EXIF segment that contains an orientation only."""
    entry = struct.pack(">HHIHH", 0x0112, 3, 1, TURN, 0)
    tiff = b"MM\0*" + struct.pack(">IH", 8, 1) + entry + struct.pack(">I", 0)
    segment = b"Exif\0\0" + tiff
    return jpeg[:2] + b"\xff\xe1" + struct.pack(">H", len(segment) + 2) + segment + jpeg[2:]
