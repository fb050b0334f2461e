"""What the texts say that describe networks of Caffe and TensorFlow, in protobuf's text format.

Only the size of the input, the operators and the number of classes are looked for; OpenCV reads the
rest.
"""

import re
from collections import Counter
from typing import Dict, List, Optional

from ..common.errors import about
from ..common.plain_text import printable
from .model_facts import ModelFile, Tensor

MAX_SIDE = 1 << 20


def read_caffe(path: str, description: bytes, data: bytes) -> ModelFile:
    """Returns what the two files of a Caffe network say.

    Raises:
        ValueError: The text describes no network.
    """
    text = _text(description)
    operators = Counter(re.findall(r'\btype\s*:\s*"?(\w+)', text))
    with about(path):
        if not re.search(r"\blayers?\s*\{", text):
            raise ValueError("it is no network of Caffe: it has no layers")
        return ModelFile(
            path,
            "caffe",
            data,
            description,
            inputs=(_tensor("data", _caffe_shape(text)),),
            metadata=_classes(re.search(r"\bnum_classes\s*:\s*(\d{1,6})\b", text)),
            producer="Caffe",
            operators=dict(operators),
        )


def _caffe_shape(text: str) -> List[int]:
    """Returns the sides of the input, which Caffe has in one of three ways; [] if it has none."""
    dims = re.findall(r"\binput_dim\s*:\s*(\d{1,9})\b", text)[:4]
    # Neither has two repetitions that can share a space, as these take quadratic time.
    shape = r"shape(?:\s*:)?\s*\{([^{}]*)\}"
    layer = text.find('"Input"')
    for pattern, part in (
        (r"\binput_" + shape, text),
        (r"\b" + shape, text[layer : layer + 1000] if layer >= 0 else ""),
    ):
        found = re.search(pattern, part)
        if not dims and found:
            dims = re.findall(r"\bdim\s*:\s*(\d{1,9})\b", found[1])
    return list(map(int, dims))


def read_tensorflow(path: str, description: bytes, data: bytes) -> ModelFile:
    """Returns what the two files of a TensorFlow network say, the text as OpenCV's tools write it.

    Raises:
        ValueError: The text describes no network.
    """
    text = _text(description)
    nodes = re.split(r"\bnode\s*\{", text)[1:]
    with about(path):
        if not nodes:
            raise ValueError("it is no text of a TensorFlow graph: it has no nodes")
        name, sides = "image_tensor", [0]
        for node in nodes:
            if re.search(r'\bop\s*:\s*"Placeholder"', node):
                named = re.search(r'\bname\s*:\s*"([^"]*)"', node)
                name = printable(named[1]) if named else name
                sides = [int(side) for side in re.findall(r"\bsize\s*:\s*(-?\d{1,9})\b", node)]
                break
        if len(sides) == 4:  # OpenCV takes all images with the channels first
            sides = [sides[0], sides[3], sides[1], sides[2]]
        operators = Counter(re.findall(r'\bop\s*:\s*"(\w+)"', text))
        classes = re.search(r'"num_classes"\s*value(?:\s*:)?\s*\{\s*i\s*:\s*(\d{1,6})\b', text)
        return ModelFile(
            path,
            "tensorflow",
            data,
            description,
            inputs=(_tensor(name, sides),),
            metadata=_classes(classes),
            producer="TensorFlow",
            operators=dict(operators),
        )


def _text(description: bytes) -> str:
    """Returns a description without its comments."""
    return re.sub(r"#[^\n]*", "", description.decode(errors="replace"))


def _classes(found: "Optional[re.Match[str]]") -> Dict[str, str]:
    """Returns the number of classes without the first, which is no object."""
    return {"classes": str(max(0, int(found[1]) - 1))} if found else {}


def _tensor(name: str, sides: List[int]) -> Tensor:
    if len(sides) != 4:
        sides = [1, 3, -1, -1]
    shape = tuple(side if 0 < side < MAX_SIDE else None for side in [1, *sides[1:]])
    return Tensor(name, shape, "float32")
