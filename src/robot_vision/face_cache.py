"""Faces that have been found in pictures, in one file: a start need not search them all again."""

import hashlib
import json
import os
from typing import Dict, Mapping

import cv2
import numpy as np

from .face_picture import SIDE
from .files import replace_file

# Of another version the faces might look otherwise.
HEAD = f"robot_vision faces 1, {SIDE} px, OpenCV {cv2.__version__}\n".encode()
DIGEST = 64  # bytes, of a SHA-256 in hexadecimal digits


def write_faces(path: str, faces: Mapping[str, np.ndarray]) -> None:
    """Writes faces, (SIDE, SIDE) uint8, by the digests of their pictures; whole or not at all.

    Raises:
        OSError: the file cannot be written.
    """
    body = json.dumps(list(faces)).encode() + b"\n"
    body += b"".join(face.tobytes() for face in faces.values())
    replace_file(path, HEAD + hashlib.sha256(body).hexdigest().encode() + body)


def read_faces(path: str) -> Dict[str, np.ndarray]:
    """What write_faces() has written; nothing if there is no such file.

    Raises:
        ValueError: it is damaged, or of another version.
        OSError: it cannot be read.
    """
    if not os.path.lexists(path):
        return {}
    with open(path, "rb") as file:
        data = file.read()
    if not data.startswith(HEAD):
        raise ValueError("it is of another version, or no such file")
    digest, body = data[len(HEAD) : len(HEAD) + DIGEST], data[len(HEAD) + DIGEST :]
    if hashlib.sha256(body).hexdigest().encode() != digest:
        raise ValueError("it is damaged")
    names, _, pixels = body.partition(b"\n")
    faces = np.frombuffer(pixels, np.uint8).reshape(-1, SIDE, SIDE)
    return dict(zip(json.loads(names), faces))
