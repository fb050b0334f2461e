"""The layers of a darknet network: what each gives to the next, and how much it has learned.

https://github.com/AlexeyAB/darknet/wiki/CFG-Parameters-in-the-different-layers says what their
parameters mean.
"""

import math
from typing import Callable, Dict, List, NamedTuple, Optional, Tuple

from ..common.plain_text import brief

Values = Dict[str, str]
MAX_DIGITS = 20  # that are looked at, of which no number is in range: time grows with their square
MAX_OUTPUT = 1 << 28  # numbers that a layer gives, which are 1 GB
SAME = ("shortcut", "dropout", "yolo", "region", "softmax", "cost", "sam", "scale_channels")


class Shape(NamedTuple):
    """What a layer gives to the next."""

    channels: int
    height: int
    width: int


class Layer(NamedTuple):
    """A section of a .cfg file."""

    kind: str
    values: Values

    def number(self, key: str, default: int = 0) -> int:
        """A parameter; raises ValueError if it is no number from 0 to 1048576."""
        text = self.values.get(key, str(default))
        try:
            number = int(text[:MAX_DIGITS])
        except ValueError:
            number = -1
        if not 0 <= number <= 1 << 20:
            raise ValueError(f"{key} of [{self.kind}] is {brief(text)}, must be from 0 to 1048576")
        return number

    def side(self, key: str, default: int) -> int:
        """A number that something is divided by, or that must not be nothing."""
        return max(1, self.number(key, default))


def count_weights(layers: List[Layer], shape: Shape) -> Optional[int]:
    """Returns how many numbers the layers learn; None: one has a kind that is not known here.

    Raises:
        ValueError: A parameter is out of range, or a layer gives nothing or too much.
    """
    made: List[Shape] = []
    total = 0
    for layer in layers:
        if layer.kind in SAME:
            count = 0
        elif layer.kind in _STEPS:
            shape, count = _STEPS[layer.kind](layer, shape, made)
        else:
            return None
        if not all(0 < side < 1 << 20 for side in shape):
            raise ValueError(f"nothing is left of the image in layer {len(made)}, [{layer.kind}]")
        if math.prod(shape) > MAX_OUTPUT:
            raise ValueError(
                f"layer {len(made)}, [{layer.kind}], gives {math.prod(shape)} numbers, must give "
                f"at most {MAX_OUTPUT}"
            )
        made.append(shape)
        total += count
    return total


def _convolutional(layer: Layer, shape: Shape, _: List[Shape]) -> Tuple[Shape, int]:
    filters, size = layer.side("filters", 1), layer.side("size", 1)
    stride = layer.side("stride", 1)
    pad = size // 2 if layer.number("pad") else layer.number("padding")
    per_filter = shape.channels // layer.side("groups", 1) * size * size
    count = filters * (per_filter + 1 + (3 if layer.number("batch_normalize") else 0))
    height, width = ((side + 2 * pad - size) // stride + 1 for side in shape[1:])
    return Shape(filters, height, width), count


def _connected(layer: Layer, shape: Shape, _: List[Shape]) -> Tuple[Shape, int]:
    output = layer.side("output", 1)
    extra = 1 + (3 if layer.number("batch_normalize") else 0)
    return Shape(output, 1, 1), output * (math.prod(shape) + extra)


def _maxpool(layer: Layer, shape: Shape, _: List[Shape]) -> Tuple[Shape, int]:
    stride = layer.side("stride", 1)
    size = layer.side("size", stride)
    pad = layer.number("padding", size - 1)
    height, width = ((side + pad - size) // stride + 1 for side in shape[1:])
    return Shape(shape.channels, height, width), 0


def _avgpool(_layer: Layer, shape: Shape, _: List[Shape]) -> Tuple[Shape, int]:
    return Shape(shape.channels, 1, 1), 0


def _upsample(layer: Layer, shape: Shape, _: List[Shape]) -> Tuple[Shape, int]:
    stride = layer.side("stride", 2)
    return Shape(shape.channels, shape.height * stride, shape.width * stride), 0


def _reorg(layer: Layer, shape: Shape, _: List[Shape]) -> Tuple[Shape, int]:
    stride = layer.side("stride", 1)
    side = Shape(shape.channels * stride * stride, shape.height // stride, shape.width // stride)
    return side, 0


def _route(layer: Layer, _shape: Shape, made: List[Shape]) -> Tuple[Shape, int]:
    sources = []
    for text in layer.values.get("layers", "").split(","):
        try:
            number = int(text[:MAX_DIGITS])
            sources.append(made[number if number >= 0 else len(made) + number])
        except (ValueError, IndexError):
            raise ValueError(
                f"layers of [route] is {brief(layer.values.get('layers', ''))}, must be layers "
                f"before it, which is layer {len(made)}"
            ) from None
    channels = sum(one.channels for one in sources) // layer.side("groups", 1)
    return Shape(channels, *sources[0][1:]), 0


_STEPS: Dict[str, Callable[[Layer, Shape, List[Shape]], Tuple[Shape, int]]] = {
    "convolutional": _convolutional,
    "connected": _connected,
    "maxpool": _maxpool,
    "avgpool": _avgpool,
    "upsample": _upsample,
    "reorg": _reorg,
    "route": _route,
}
