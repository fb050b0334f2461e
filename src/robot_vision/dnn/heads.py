"""Which family of detectors a network belongs to, found from what it gives out.

The shapes are those of a run, in the network's order. The head's name is that of HeadParams.
"""

import dataclasses
from typing import Sequence, Tuple

import numpy as np

from ..common.plain_text import brief, printable
from .head import Head, Seen
from .head_families import FAMILIES
from .metadata import MAX_CLASSES, class_count, value_of
from .model_facts import ModelFile, joined, shape_text
from .network_input import NetworkInput

TASKS = ("detect", "segment", "pose", "oriented")
EXPECTED = {
    "yolov3": "rows (n, 5 + C) of darknet",
    "yolov5": "(1, n, 5 + C) with 3 n for each cell; to segment also (1, M, h, w)",
    "yolov8": "(1, 4 + C, n), also of YOLO11; with masks, keypoints or angles behind the classes",
    "yolov10": "(1, n, 6)",
    "yolox": "(1, n, 5 + C) with one n for each cell",
    "nanodet": "(1, n, C + 32)",
    "ssd": "(1, 1, n, 7); or boxes (1, n, 4), labels (1, n) and scores (1, n)",
    "detr": "logits (1, n, C + 1) and boxes (1, n, 4)",
    "rtdetr": "(1, n, 4 + C); or logits (1, n, C) and boxes (1, n, 4)",
}


def guess_head(
    model: ModelFile,
    network_input: NetworkInput,
    shapes: Sequence[Tuple[int, ...]],
    names: Sequence[str] = (),
    head: str = "auto",
    task: str = "auto",
    counts: Sequence[int] = (),
) -> Head:
    """Returns the head of a network.

    Args:
        model: The model.
        network_input: What it takes.
        shapes: The shapes of its outputs.
        names: Their names, if they are known.
        head: The head that the user has named, or auto.
        task: The task that the user has named, or auto.
        counts: How many classes the user's names may be for.

    Raises:
        ValueError: No head fits, or the one named does not; one line has the shapes.
    """
    if head not in ("auto", *EXPECTED):
        raise ValueError(f"head is {brief(head)}, must be auto, {', '.join(EXPECTED)}")
    if task not in ("auto", *TASKS):
        raise ValueError(f"task is {brief(task)}, must be auto, {', '.join(TASKS)}")
    told = value_of(model.metadata, "task")
    told = {"obb": "oriented"}.get(told, told) if isinstance(told, str) else ""
    if told not in ("", *TASKS):
        raise ValueError(f"its task is {brief(told)}, must be {', '.join(TASKS)}")
    seen = Seen(
        [tuple(one) for one in shapes],
        [printable(name.lower()) for name in names] or [""] * len(shapes),
        model,
        network_input.width,
        network_input.height,
        tuple(filter(None, (class_count(model.metadata),))) or tuple(counts),
        told if task == "auto" else task,
        head != "auto",
    )
    for name, find in FAMILIES.items():
        found = find(seen) if head in ("auto", name) else None
        if found and seen.task and found.task != seen.task and task != "auto":
            raise ValueError(f"task is {task}, must be {found.task}: {found.reason}")
        if found and found.classes > MAX_CLASSES:
            raise ValueError(
                f"it has {found.classes} classes as {found.head}, must have at most {MAX_CLASSES}"
            )
        if found:
            return found
    raise ValueError(_nothing_fits(seen, head))


def by_values(head: Head, output: np.ndarray, network_input: NetworkInput) -> Head:
    """Returns the head that the numbers of a first run tell, where shapes alone do not.

    YOLOX is exported with offsets in cells, or with pixels as YOLOv5. The boxes of a network are
    near their cells, so the half of them tells which it is. YOLOv6 gives pixels, too, and 1 as each
    objectness; it wants its images as YOLOv5.

    Args:
        head: The head by the shapes.
        output: What the network gives for an image of zeros, its first output.
        network_input: What it takes.
    """
    if head.head != "yolox":
        return head
    centers, sides = [], []
    for stride in head.strides:
        columns, rows = network_input.width // stride, network_input.height // stride
        y, x = np.mgrid[:rows, :columns] + 0.5
        centers.append(np.stack([x.ravel(), y.ravel()], axis=1) * stride)
        sides.append(np.full((rows * columns, 1), float(stride)))
    found = output.reshape(-1, output.shape[-1])[:, :2]
    from_cells = np.abs(found - np.vstack(centers)) / np.vstack(sides)
    if not np.median(from_cells) < np.median(np.abs(found - 0.5)):
        return head
    reason = f"{head.reason}, with boxes in pixels already"
    family = "yolox"
    if (output[..., 4] == 1.0).all():
        reason, family = f"{reason} and no objectness, as YOLOv6", "yolov5"
    return dataclasses.replace(head, head="yolov5", reason=reason, strides=(), trained_as=family)


def _nothing_fits(seen: Seen, head: str) -> str:
    named = [f"{name} {shape_text(shape)}".strip() for name, shape in zip(seen.names, seen.shapes)]
    shapes = joined(named)
    if head != "auto":
        return f"head is {head}, which gives {EXPECTED[head]}; the network gives {shapes}"
    if len(seen.shapes) == 1 and len(seen.shapes[0]) == 2 and seen.shapes[0][0] == 1:
        return f"its output {shapes} is that of a network that classifies whole images"
    if len(seen.shapes) > 1 and all(len(shape) >= 4 for shape in seen.shapes):
        return f"its outputs {shapes} are maps of features: export it together with its head"
    known = "; ".join(f"{name} {shape}" for name, shape in EXPECTED.items())
    return (
        f"no head fits its outputs, {shapes}, for an input of {seen.width}x{seen.height} px; "
        f"known are {known}"
    )
