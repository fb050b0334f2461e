"""What a network takes: the size of its input, the order of its axes and its type of numbers."""

from typing import List, NamedTuple, Tuple

from .metadata import image_size
from .model_facts import ModelFile, Tensor, joined, shape_text

MAX_SIDE = 4096  # px
TYPES = ("float32", "float16", "uint8")


class NetworkInput(NamedTuple):
    """The one input of a network, with all its sizes."""

    name: str
    width: int  # px
    height: int  # px
    layout: str  # nchw or nhwc
    type: str  # NumPy's name: float32, float16 or uint8

    @property
    def shape(self) -> Tuple[int, int, int, int]:
        """The sizes of the axes."""
        if self.layout == "nhwc":
            return 1, self.height, self.width, 3
        return 1, 3, self.height, self.width


def input_of(model: ModelFile, width: int = 0, height: int = 0) -> NetworkInput:
    """Returns the input of a model.

    Args:
        model: The model.
        width: Of the input where the model leaves it open, in px; 0: as its metadata say.
        height: The same.

    Raises:
        ValueError: The model does not take one image, or its size is not known, or another.
    """
    if len(model.inputs) != 1:
        found = joined([str(one) for one in model.inputs]) or "none"
        raise ValueError(f"it has {len(model.inputs)} inputs ({found}), must have one, an image")
    tensor = model.inputs[0]
    layout = _layout(tensor)
    if tensor.type not in TYPES:
        raise ValueError(f"its input {tensor} must be of {', '.join(TYPES)}")
    if tensor.shape[0] not in (None, 1):
        raise ValueError(f"its input {tensor} takes {tensor.shape[0]} images, must take one")
    sides = tensor.shape[1:3] if layout == "nhwc" else tensor.shape[2:]
    told = image_size(model.metadata) or (0, 0)
    # A darknet network is convolutions, whose size the .cfg only proposes; others are made for it.
    free = model.kind == "darknet"
    chosen: List[int] = []
    for name, fixed, wanted, says in zip(
        ("width", "height"), (sides[1], sides[0]), (width, height), told
    ):
        if fixed is not None and wanted not in (0, fixed) and not free:
            raise ValueError(
                f"input_{name} is {wanted}, must be 0 or {fixed}, as the model is made for that"
            )
        side = (wanted or fixed or says) if free else (fixed or wanted or says)
        if not side:
            raise ValueError(
                f"its input {tensor} has no fixed size: set input_{name}, in pixels, usually a "
                "multiple of 32"
            )
        if not 1 <= side <= MAX_SIDE:
            raise ValueError(f"the {name} of its input is {side}, must be from 1 to {MAX_SIDE}")
        chosen.append(side)
    return NetworkInput(tensor.name, chosen[0], chosen[1], layout, tensor.type)


def _layout(tensor: Tensor) -> str:
    shape = tensor.shape
    if len(shape) != 4:
        raise ValueError(
            f"its input {tensor} must have four axes: image, channel, row and column, or image, "
            "row, column and channel"
        )
    if shape[1] == 3:
        return "nchw"
    if shape[3] == 3:
        return "nhwc"
    if shape[1] is None:
        return "nchw"
    channels = shape[1] if shape[1] <= 4 else shape[3]
    raise ValueError(
        f"its input {tensor.name} {shape_text(shape)} takes {channels} channels, must take 3, the "
        "colours"
    )
