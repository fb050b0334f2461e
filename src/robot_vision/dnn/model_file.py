"""What is known of a model's file without running it.

A model is one file (ONNX) or two: a text that describes the network, and its weights. Either of the
two names the other, which is looked for beside it under the same name. The files are read whole, so
that what was checked is what is run, and only if they are regular ones.
"""

import os
from typing import List, Tuple

from ..common.errors import about
from ..common.files import read_file
from .darknet_file import read_darknet
from .model_facts import KINDS, ModelFile
from .onnx_file import read_onnx
from .text_models import read_caffe, read_tensorflow

MAX_MODEL = 1 << 30  # bytes, largest model or weights
MAX_DESCRIPTION = 16 << 20  # bytes, largest text that describes a network
# Suffixes of the description and of the weights.
PAIRS = {
    "darknet": (".cfg", ".weights"),
    "caffe": (".prototxt", ".caffemodel"),
    "tensorflow": (".pbtxt", ".pb"),
}
READERS = {"darknet": read_darknet, "caffe": read_caffe, "tensorflow": read_tensorflow}


def read_model(path: str, weights: str = "") -> ModelFile:
    """Reads the files of a model.

    Args:
        path: The model, or one of its two files.
        weights: The other file; empty: the one of the same name beside it.

    Raises:
        OSError: A file is not there, no regular file, too large, or cannot be read.
        ValueError: It is no model that can be read; one line says which file, and why.
    """
    suffix = os.path.splitext(path)[1].lower()
    kind = next((one for one, suffixes in PAIRS.items() if suffix in suffixes), "")
    if kind:
        description, data = _pair(kind, path, weights)
        return READERS[kind](path, description, data)
    content = read_file(path, MAX_MODEL)
    with about(path):
        if weights:
            raise ValueError(f"it takes no file of weights, such as {weights}")
        foreign = _foreign(content)
        if foreign:
            raise ValueError(f"it is {foreign}; {KINDS}")
        return read_onnx(path, content, suffix == ".onnx")


def _pair(kind: str, path: str, other: str) -> Tuple[bytes, bytes]:
    """Returns the description and the weights of a model of two files."""
    stem, suffix = os.path.splitext(path)
    suffixes = PAIRS[kind]
    is_description = suffix.lower() == suffixes[0]
    if not other:
        other = stem + suffixes[1 if is_description else 0]
    text, data = (path, other) if is_description else (other, path)
    found: List[bytes] = []
    for name, limit in ((text, MAX_DESCRIPTION), (data, MAX_MODEL)):
        try:
            found.append(read_file(name, limit))
        except OSError as error:
            if name != other:
                raise
            raise type(error)(f"{error} (the other file of {path})") from error
    for name, content in zip((text, data), found):
        if not content:
            raise ValueError(f"{name}: it is empty")
    return found[0], found[1]


def _foreign(content: bytes) -> str:
    """Returns what a file is whose kind is known but not read here, or nothing."""
    if not content:
        return "empty"
    if content[:4] == b"PK\x03\x04":
        return "an archive, as PyTorch's checkpoints are (.pt): export the network to ONNX"
    if content[4:8] == b"TFL3":
        return "of TensorFlow Lite: convert it to ONNX"
    if content[:8] == b"\x89HDF\r\n\x1a\n":
        return "of Keras (HDF5): export the network to ONNX"
    if content.lstrip()[:5] == b"<?xml":
        return "an XML file, as OpenVINO's networks are: take the ONNX file it was made of"
    return ""
