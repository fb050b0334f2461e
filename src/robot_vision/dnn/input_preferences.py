"""How the images must be that a family of networks was trained with.

The values are those of the families' own programs; networks that were trained with others have them
as parameters of the node.
"""

import dataclasses
import math
from typing import Any, Tuple

from ..common.plain_text import brief
from ..common.ranges import require_range
from .head import Head
from .model_facts import ModelFile
from .network_input import NetworkInput

Three = Tuple[float, float, float]
IMAGENET_MEAN: Three = (123.675, 116.28, 103.53)  # RGB
IMAGENET_STD: Three = (58.395, 57.12, 57.375)
UNIT: Three = (255.0, 255.0, 255.0)
NONE: Three = (0.0, 0.0, 0.0)
ONE: Three = (1.0, 1.0, 1.0)


FITS = ("letterbox", "stretch", "corner")
ORDERS = ("rgb", "bgr")


@dataclasses.dataclass(frozen=True)
class InputPreferences:
    """As InputParams names them."""

    fit: str = "letterbox"  # letterbox, stretch or corner
    pad: int = 114  # 0 to 255
    order: str = "rgb"  # or bgr
    mean: Three = NONE  # of values from 0 to 255, in the order above
    std: Three = UNIT

    def __str__(self) -> str:
        padded = "" if self.fit == "stretch" else f" with {self.pad}"
        mean, std = (
            f"{values[0]:g}"
            if len(set(values)) == 1
            else f"({', '.join(map('{:g}'.format, values))})"
            for values in (self.mean, self.std)
        )
        return f"{self.fit}{padded}, {self.order}, (value - {mean}) / {std}"


def chosen(
    model: ModelFile, head: Head, network_input: NetworkInput, settings: Any
) -> InputPreferences:
    """Returns how a network wants its images: as its family does, but for what the user has set.

    Args:
        model: The model.
        head: Its head.
        network_input: What it takes.
        settings: fit, pad, order, mean and std as NetworkSettings has them.

    Raises:
        ValueError: A setting is out of range.
    """
    image = _of_family(model, head, network_input)
    for name, allowed in (("fit", FITS), ("order", ORDERS)):
        value = getattr(settings, name)
        if value != "auto":
            if value not in allowed:
                raise ValueError(f"{name} is {brief(value)}, must be auto, {', '.join(allowed)}")
            image = dataclasses.replace(image, **{name: value})
    if settings.pad != -1:
        require_range("pad", settings.pad, 0, 255)
        image = dataclasses.replace(image, pad=settings.pad)
    for name in ("mean", "std"):
        values = tuple(getattr(settings, name))
        if values:
            if len(values) != 3 or not all(map(math.isfinite, values)):
                raise ValueError(f"{name} is {brief(values)}, must be three numbers, or none")
            if name == "std" and min(values) <= 0:
                raise ValueError(f"std is {brief(values)}, must be above 0")
            image = dataclasses.replace(image, **{name: values})
    return image


def _of_family(model: ModelFile, head: Head, network_input: NetworkInput) -> InputPreferences:
    """Returns how a network of this family wants its images."""
    family = head.trained_as or head.head
    if network_input.type == "uint8":  # it normalises by itself
        return InputPreferences(fit="stretch", std=ONE)
    if family == "yolov3":
        return InputPreferences(pad=127)
    if family == "yolox":
        return InputPreferences(fit="corner", order="bgr", std=ONE)
    if family == "nanodet":
        return InputPreferences("stretch", 0, "bgr", IMAGENET_MEAN[::-1], IMAGENET_STD[::-1])
    if family == "detr":
        return InputPreferences("stretch", 0, "rgb", IMAGENET_MEAN, IMAGENET_STD)
    if family == "rtdetr":
        return InputPreferences(fit="stretch")
    if family == "ssd":
        return _of_ssd(model, head)
    return InputPreferences()


def _of_ssd(model: ModelFile, head: Head) -> InputPreferences:
    if model.kind == "tensorflow":  # the text that OpenCV reads has the normalisation in it
        return InputPreferences("stretch", std=ONE)
    if model.kind == "onnx" and head.order:
        return InputPreferences("stretch", 0, "rgb", IMAGENET_MEAN, IMAGENET_STD)
    if b"/dw" in model.description or model.kind == "onnx":  # MobileNet's, of depthwise layers
        return InputPreferences("stretch", 0, "bgr", (127.5,) * 3, (127.5,) * 3)
    return InputPreferences("stretch", 0, "bgr", (104.0, 117.0, 123.0), ONE)
