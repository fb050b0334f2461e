"""A file of the faces found in a gallery's images, so that a start need not search them again."""

import hashlib
import os
from typing import Dict, Mapping

import cv2
import numpy as np

from ..common.files import read_file, replace_file
from .face_images import SIDE

# Another version may find or normalize the faces differently.
HEAD = f"robot_vision faces 2, {SIDE} px, OpenCV {cv2.__version__}\n".encode()
DIGEST = 64  # bytes of a SHA-256 in hexadecimal digits
RECORD = DIGEST + SIDE * SIDE  # bytes of a face after the digest of its image file
MAX_SIZE = 1 << 30  # bytes, largest file: a hundred thousand faces


def write_faces(path: str, faces: Mapping[str, np.ndarray]) -> None:
    """Writes faces, (SIDE, SIDE) uint8, by the digests of their images; in one step or not at all.

    Raises:
        OSError: The file cannot be written.
    """
    body = b"".join(digest.encode() + face.tobytes() for digest, face in faces.items())
    replace_file(path, HEAD + hashlib.sha256(body).hexdigest().encode() + body)


def read_faces(path: str) -> Dict[str, np.ndarray]:
    """Reads what write_faces() wrote; returns nothing if there is no such file.

    Raises:
        ValueError: The file is damaged, or of another version.
        OSError: The path is not a regular file, or the file is too large or cannot be read.
    """
    if not os.path.lexists(path):
        return {}
    data = read_file(path, MAX_SIZE)
    if not data.startswith(HEAD):
        raise ValueError("it is of another version, or no such file")
    digest, body = data[len(HEAD) : len(HEAD) + DIGEST], data[len(HEAD) + DIGEST :]
    if hashlib.sha256(body).hexdigest().encode() != digest or len(body) % RECORD:
        raise ValueError("it is damaged")
    records = np.frombuffer(body, np.uint8).reshape(-1, RECORD)
    digests = (record[:DIGEST].tobytes().decode("latin-1") for record in records)
    return dict(zip(digests, records[:, DIGEST:].reshape(-1, SIDE, SIDE)))
