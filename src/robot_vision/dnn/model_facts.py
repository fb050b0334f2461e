"""What is known of a network without running it."""

import dataclasses
from typing import Dict, NamedTuple, Optional, Sequence, Tuple

KINDS = "ONNX (.onnx), darknet (.cfg and .weights), Caffe (.prototxt and .caffemodel) and "
KINDS += "TensorFlow (.pb and .pbtxt) can be read"

MAX_LISTED = 8  # of what a model may have any number of, in one line


class Tensor(NamedTuple):
    """An input or output of a network."""

    name: str
    shape: Tuple[Optional[int], ...]  # None: any size
    type: str  # NumPy's name of the type of its numbers

    def __str__(self) -> str:
        return f"{self.name} {shape_text(self.shape)} {self.type}"


@dataclasses.dataclass(frozen=True)
class ModelFile:
    """The content of a model's files, and what is known of the network."""

    path: str
    kind: str  # onnx, darknet, caffe or tensorflow
    data: bytes  # the ONNX file, or the weights
    description: bytes = b""  # the text that describes the network; of ONNX nothing
    inputs: Tuple[Tensor, ...] = ()
    outputs: Tuple[Tensor, ...] = ()  # nothing, where only a run tells
    metadata: Dict[str, str] = dataclasses.field(default_factory=dict)
    producer: str = ""
    opset: int = 0  # of ONNX' own operators; 0: it has none
    operators: Dict[str, int] = dataclasses.field(default_factory=dict)  # and how many of each
    custom: Tuple[str, ...] = ()  # operators that are no part of ONNX
    parameters: Optional[int] = None  # how many numbers it has learned
    half: bool = False  # whether it computes with 16 bits
    warnings: Tuple[str, ...] = ()  # what is odd, but does not keep it from running

    @property
    def dynamic(self) -> bool:
        """Whether a size of the input is open."""
        return any(None in one.shape for one in self.inputs)


def shape_text(shape: Tuple[Optional[int], ...]) -> str:
    """Returns a shape as text, such as 1x3x640x640; what is open is a question mark."""
    sides = ["?" if side is None else str(side) for side in shape[:MAX_LISTED]]
    return "x".join(sides + ["..."] * (len(shape) > MAX_LISTED)) or "scalar"


def joined(texts: Sequence[str]) -> str:
    """Returns texts between commas; of very many the first."""
    more = [f"and {len(texts) - MAX_LISTED} more"] if len(texts) > MAX_LISTED else []
    return ", ".join([*texts[:MAX_LISTED], *more])
