"""A network of the size of the smallest that people run on a CPU, with random weights.

1.06 GFLOP for an image of 416x416: plain and depthwise convolutions with SiLU, residual blocks, a
pyramid of three levels with a head on each, and YOLOv8's output (1, 84, 3549). It knows nothing,
but its weights are fixed: it finds some dozens of things in a photograph, the same ones each time,
by about a hundred boxes of which many overlap.
"""

from pathlib import Path
from typing import List, Tuple

import measuring  # noqa: F401  # by which network_graph is found
import numpy as np
from network_graph import Graph

SIDE = 416  # px
CLASSES = 80
STRIDES = (8, 16, 32)
WIDTH = 76  # channels of each level of the pyramid
VARIANCE = 2.8  # of the weights, times what they sum up: after SiLU about what keeps values alike
BOX_GAIN, SCORE_GAIN = 10.0, 15.0  # so that boxes differ, and few scores are high
SCORE_BIAS = -5.0
METADATA = {
    "names": str({number: f"class {number}" for number in range(CLASSES)}),
    "imgsz": str([SIDE, SIDE]),
    "stride": str(STRIDES[-1]),
}


class Layers:
    """Makes layers one after the other, with random weights that are always the same."""

    def __init__(self) -> None:
        self.graph = Graph((1, 3, SIDE, SIDE))
        self._random = np.random.RandomState(1)  # whose numbers no version of NumPy changes

    def conv(
        self,
        value: str,
        shape: Tuple[int, int, int],
        stride: int = 1,
        gain: float = 1.0,
        bias: float = 0.0,
    ) -> str:
        """A convolution; shape: filters, channels that each of them sees, and side."""
        filters, channels, side = shape
        spread = np.sqrt(VARIANCE / (channels * side * side))
        weights = self._random.normal(0.0, gain * spread, (filters, channels, side, side))
        if channels > 1:  # or the mean of what SiLU gives would grow from layer to layer
            weights -= weights.mean(axis=(1, 2, 3), keepdims=True)
        return self.graph.node(
            "Conv",
            value,
            self.graph.constant(weights),
            self.graph.constant(np.full(filters, bias)),
            kernel_shape=[side, side],
            strides=[stride, stride],
            pads=[side // 2] * 4,
            group=filters if channels == 1 else 1,
        )

    def silu(self, value: str) -> str:
        return self.graph.node("Mul", value, self.graph.node("Sigmoid", value))

    def plain(self, value: str, channels: int, filters: int, side: int = 1, stride: int = 1) -> str:
        return self.silu(self.conv(value, (filters, channels, side), stride))

    def separable(self, value: str, channels: int, filters: int, side: int, stride: int = 1) -> str:
        """A depthwise convolution, and one of 1x1 after it."""
        depthwise = self.silu(self.conv(value, (channels, 1, side), stride))
        return self.plain(depthwise, channels, filters)

    def stage(self, value: str, channels: int, blocks: int) -> str:
        """Halves the sides, doubles the channels, and adds residual blocks."""
        value = self.separable(value, channels, 2 * channels, 3, stride=2)
        for _ in range(blocks):
            inner = self.plain(value, 2 * channels, channels)
            value = self.graph.node("Add", value, self.plain(inner, channels, 2 * channels, 3))
        return value


def backbone(layers: Layers) -> List[str]:
    """The levels of the strides, with 64, 128 and 256 channels."""
    value = layers.plain("images", 3, 16, 3, stride=2)
    levels = []
    for channels, blocks in ((16, 1), (32, 2), (64, 2), (128, 1)):
        value = layers.stage(value, channels, blocks)
        levels.append(value)
    return levels[1:]


def pyramid(layers: Layers, levels: List[str]) -> List[str]:
    """Levels of WIDTH channels, each with what those above it have seen."""
    graph = layers.graph
    found = [layers.plain(one, 64 << number, WIDTH) for number, one in enumerate(levels)]
    region = graph.constant(np.zeros(0))  # an input of the operator that is not used
    scales = graph.constant(np.array([1.0, 1.0, 2.0, 2.0]))
    for number in (1, 0):
        above = graph.node(
            "Resize",
            found[number + 1],
            region,
            scales,
            mode="nearest",
            coordinate_transformation_mode="asymmetric",
            nearest_mode="floor",
        )
        both = graph.node("Concat", found[number], above, axis=1)
        found[number] = layers.separable(both, 2 * WIDTH, WIDTH, 5)
    return found


def head(layers: Layers, value: str, stride: int) -> str:
    """Of each cell the centre and size of its box in px, and its scores: (1, 4 + CLASSES, n)."""
    graph, cells = layers.graph, SIDE // stride
    for _ in range(2):
        value = layers.separable(value, WIDTH, WIDTH, 5)
    raw = graph.node("Sigmoid", layers.conv(value, (4, WIDTH, 1), gain=BOX_GAIN))
    logits = layers.conv(value, (CLASSES, WIDTH, 1), gain=SCORE_GAIN, bias=SCORE_BIAS)
    # The centre is anywhere in the cell, and the sides are from 4 to 20 cells long.
    row, column = np.mgrid[:cells, :cells]
    least = np.stack([column, row, np.full_like(row, 4), np.full_like(row, 4)])[None] * stride
    span = np.array([1.0, 1.0, 16.0, 16.0]).reshape(1, 4, 1, 1) * stride
    boxes = graph.node("Mul", raw, graph.constant(span))
    boxes = graph.node("Add", boxes, graph.constant(least.astype(np.float32)))
    both = graph.node("Concat", boxes, graph.node("Sigmoid", logits), axis=1)
    return graph.shaped(both, 1, 4 + CLASSES, cells * cells)


def nano_network() -> bytes:
    """The content of the ONNX file."""
    layers = Layers()
    levels = pyramid(layers, backbone(layers))
    parts = [head(layers, level, stride) for level, stride in zip(levels, STRIDES)]
    cells = sum((SIDE // stride) ** 2 for stride in STRIDES)
    output = layers.graph.node("Concat", *parts, axis=2)
    layers.graph.output(output, "output0", [1, 4 + CLASSES, cells])
    return layers.graph.bytes(METADATA)


def nano_file(folder: Path) -> Path:
    """The file in this folder, which is written unless it is there."""
    path = folder / "nano.onnx"
    if not path.exists():
        path.write_bytes(nano_network())
    return path
