"""What a .cfg and a .weights file of darknet say of a network.

https://github.com/AlexeyAB/darknet/wiki/CFG-Parameters-in-the-different-layers says what is in the
text. The weights are plain numbers in its order, and nothing in them says what they belong to:
OpenCV takes too few of them without a word. So they are counted here.
"""

import struct
from collections import Counter
from typing import List, Optional

from ..common.errors import about
from ..common.plain_text import brief, printable
from .darknet_layers import Layer, Shape, count_weights
from .model_facts import ModelFile, Tensor

MAX_LAYERS = 10000  # of the largest networks a few hundred are known


def read_darknet(path: str, description: bytes, data: bytes) -> ModelFile:
    """Returns what the two files of a darknet network say.

    Raises:
        ValueError: The text is no network, or there are too few weights for it.
    """
    with about(path):
        layers = _layers(description.decode(errors="replace"))
        net = layers[0]
        shape = Shape(net.number("channels", 3), net.number("height"), net.number("width"))
        if not all(shape):
            raise ValueError("[net] must have width, height and channels")
        counted = count_weights(layers[1:], shape)
        warning = _compare(counted, data)
        for layer in layers:
            if layer.kind == "yolo":
                _require_anchors(layer)
        told = [one.number("classes") for one in layers if "classes" in one.values]
    classes = max(told, default=0)
    return ModelFile(
        path,
        "darknet",
        data,
        description,
        inputs=(Tensor("data", (1, *shape), "float32"),),
        metadata={"classes": str(classes)} if classes else {},
        producer="darknet",
        operators=dict(Counter(one.kind for one in layers[1:])),
        parameters=counted,
        warnings=(warning,) if warning else (),
    )


def _layers(text: str) -> List[Layer]:
    layers: List[Layer] = []
    for number, line in enumerate(text.splitlines(), 1):
        line = line.partition("#")[0].partition(";")[0].strip()
        if line.startswith("[") and line.endswith("]"):
            layers.append(Layer(printable(line[1:-1].strip(), 40), {}))
            if len(layers) > MAX_LAYERS:
                raise ValueError(f"it has more than {MAX_LAYERS} layers")
        elif line and layers and "=" in line:
            key, _, value = line.partition("=")
            layers[-1].values[key.strip()] = value.strip()
        elif line:
            raise ValueError(f"line {number} is neither [layer] nor key=value: {printable(line)}")
    if not layers or layers[0].kind not in ("net", "network"):
        raise ValueError("it is no network of darknet: its first section must be [net]")
    if len(layers) == 1:
        raise ValueError("it has no layers")
    return layers


def _require_anchors(layer: Layer) -> None:
    """Raises ValueError for a mask of anchors that there are not, which OpenCV would look for."""
    mask = layer.values.get("mask", "")
    count = len(layer.values.get("anchors", "").split(",")) // 2
    try:
        fits = all(0 <= int(number) < count for number in mask.split(",") if mask)
    except ValueError:
        fits = False
    if not fits:
        raise ValueError(f"mask of [yolo] is {brief(mask)}, must be some of its {count} anchors")


def _compare(counted: Optional[int], data: bytes) -> str:
    """Returns a warning if there are too many weights, and raises ValueError if too few."""
    if counted is None:
        return ""
    try:
        major, minor = struct.unpack_from("<ii", data)
    except struct.error:
        major, minor = 0, 0
    expected = (20 if 10 * major + minor >= 2 else 16) + 4 * counted
    if len(data) < expected:
        raise ValueError(
            f"its weights have {len(data)} bytes, must have {expected}: they are not complete, or "
            "belong to another network"
        )
    if len(data) > expected:
        return (
            f"its weights have {len(data)} bytes, and only {expected} belong to this network: "
            "they may be another one's"
        )
    return ""
