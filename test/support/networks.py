"""Tiny networks of each family that find coloured squares, and an image to find them in.

Class 0 is red, 1 green and 2 blue. The image is cut into cells of 8 px, or as many as a stride has.
The score of a class in a cell is the mean of its colour there, and the box of a cell is a constant:
so it is known what each network finds. All are written with python3-onnx, but those of darknet and
Caffe, whose files are text and plain numbers.
"""

from typing import Any, NamedTuple, Sequence

import numpy as np
from network_graph import CLASSES, SIZE, STRIDES, Graph

COLORS = ((0, 0, 255), (0, 255, 0), (255, 0, 0))  # of the classes, BGR
NAMES = ("red", "green", "blue")
ULTRALYTICS = {"names": str(dict(enumerate(NAMES))), "stride": "32", "imgsz": f"[{SIZE}, {SIZE}]"}
KEYPOINTS = 2
MASKS = 32  # coefficients of a mask


class Square(NamedTuple):
    """A coloured square that fills a cell: its class, column and row in cells, and stride in px."""

    class_id: int
    column: int
    row: int
    stride: int = 8


def image_of(squares: Sequence[Square], size: int = SIZE) -> np.ndarray:
    """A black image with squares, (size, size, 3) uint8 BGR."""
    image = np.zeros((size, size, 3), np.uint8)
    for class_id, column, row, stride in squares:
        x, y = column * stride, row * stride
        image[y : y + stride, x : x + stride] = COLORS[class_id]
    return image


def cells(strides: Sequence[int] = STRIDES, size: int = SIZE) -> np.ndarray:
    """Column, row and stride of all cells, (n, 3), in the order in which networks have them."""
    found = [
        (column, row, stride)
        for stride in strides
        for row in range(size // stride)
        for column in range(size // stride)
    ]
    return np.array(found, np.float32)


def centers(of: np.ndarray) -> np.ndarray:
    """The centres of cells, (n, 2) px."""
    return (of[:, :2] + 0.5) * of[:, 2:]


def boxes_of(of: np.ndarray) -> np.ndarray:
    """Centre, width and height of the boxes of cells, (n, 4) px: twice as wide as the cell."""
    return np.hstack([centers(of), of[:, 2:] * 2, of[:, 2:]])


def corners_of(boxes: np.ndarray) -> np.ndarray:
    """Left, top, right and bottom of boxes with centre, width and height, (n, 4)."""
    return np.hstack([boxes[:, :2] - boxes[:, 2:] / 2, boxes[:, :2] + boxes[:, 2:] / 2])


def by_row(graph: Graph, value: str) -> str:
    """(1, a, n) as (1, n, a)."""
    return graph.node("Transpose", value, perm=[0, 2, 1])


def yolov8(task: str = "detect", metadata: Any = (), graph: Any = None) -> bytes:
    """(1, 4 + C, n), with what the task adds: masks, keypoints or an angle."""
    graph = graph or Graph()
    of = cells()
    parts = [graph.constant(boxes_of(of).T[None]), graph.scores()]
    rows = 4 + CLASSES
    if task == "segment":
        parts.append(graph.constant(coefficients(len(of)).T[None]))
    elif task == "pose":
        parts.append(graph.constant(keypoints_of(of).reshape(len(of), -1).T[None]))
    elif task == "oriented":
        parts.append(graph.constant(np.full((1, 1, len(of)), np.pi / 2, np.float32)))
    rows += {"segment": MASKS, "pose": 3 * KEYPOINTS, "oriented": 1}.get(task, 0)
    graph.output(graph.node("Concat", *parts, axis=1), "output0", [1, rows, len(of)])
    if task == "segment":
        prototypes(graph)
    return graph.bytes(metadata)


def coefficients(count: int) -> np.ndarray:
    """Of masks, (count, MASKS): only the first prototype counts."""
    values = np.zeros((count, MASKS), np.float32)
    values[:, 0] = 1.0
    return values


def prototypes(graph: Graph) -> None:
    """The output of prototypes, a quarter of the input: the left half of the image is masked."""
    side = SIZE // 4
    values = np.zeros((1, MASKS, side, side), np.float32)
    values[0, 0] = np.where(np.arange(side) < side // 2, 10.0, -10.0)
    graph.output(graph.varying(values), "output1", values.shape)


def keypoints_of(of: np.ndarray) -> np.ndarray:
    """Keypoints of cells, (n, KEYPOINTS, 3): the corners at the left top and the right bottom."""
    corners = of[:, :2] * of[:, 2:]
    one = np.hstack([corners, np.full((len(of), 1), 0.75, np.float32)])
    other = np.hstack([corners + of[:, 2:], np.full((len(of), 1), 0.25, np.float32)])
    return np.stack([one, other], axis=1)


def yolov5(task: str = "detect", metadata: Any = (), graph: Any = None) -> bytes:
    """(1, 3 n, 5 + C): three anchors for each cell, of which the second has an object."""
    graph = graph or Graph()
    of = [cells([stride]) for stride in STRIDES]
    boxes = np.vstack([boxes_of(np.tile(one, (3, 1))) for one in of])
    objectness = np.concatenate([np.repeat([0.0, 1.0, 0.0], len(one)) for one in of])
    scores = [graph.node("Concat", *[graph.scores([s])] * 3, axis=2) for s in STRIDES]
    parts = [
        graph.constant(boxes.T[None]),
        graph.constant(objectness[None, None]),
        graph.node("Concat", *scores, axis=2),
    ]
    if task == "segment":
        parts.append(graph.constant(coefficients(len(boxes)).T[None]))
    values = by_row(graph, graph.node("Concat", *parts, axis=1))
    rows = 5 + CLASSES + (MASKS if task == "segment" else 0)
    graph.output(values, "output0", [1, len(boxes), rows])
    if task == "segment":
        prototypes(graph)
    return graph.bytes(metadata)


def each_class(of: np.ndarray) -> np.ndarray:
    """Corners of the boxes of all cells, once for each class, (CLASSES n, 4) px."""
    return np.tile(corners_of(boxes_of(of)), (CLASSES, 1))


def class_column(count: int, first: int = 0) -> np.ndarray:
    """The classes that belong to each_class(), (CLASSES count)."""
    return np.repeat(np.arange(first, first + CLASSES, dtype=np.float32), count)


def yolov10(metadata: Any = (), graph: Any = None) -> bytes:
    """(1, n, 6): corners, score and class."""
    graph = graph or Graph()
    of = cells([8])
    count = CLASSES * len(of)
    parts = [
        graph.constant(each_class(of).T[None]),
        graph.shaped(graph.scores([8]), 1, 1, count),
        graph.constant(class_column(len(of))[None, None]),
    ]
    values = by_row(graph, graph.node("Concat", *parts, axis=1))
    graph.output(values, "output0", [1, count, 6])
    return graph.bytes(metadata)


def yolox(decoded: bool = False, metadata: Any = (), graph: Any = None) -> bytes:
    """(1, n, 5 + C): offsets of half a cell, the logarithm of 2 and 1 as size; or boxes in px."""
    graph = graph or Graph()
    of = cells()
    raw = np.tile(np.array([0.5, 0.5, np.log(2.0), 0.0, 1.0], np.float32), (len(of), 1))
    if decoded:
        raw[:, :4] = boxes_of(of)
        raw[:, 4] = 1.0 - 1e-6  # as of a sigmoid
    # YOLOX wants blue first, and values from 0 to 255.
    scale = graph.constant(np.array(1.0 / 255.0))
    scores = graph.node("Mul", graph.scores(order="bgr"), scale)
    values = graph.node("Concat", graph.constant(raw.T[None]), scores, axis=1)
    graph.output(by_row(graph, values), "output", [1, len(of), 5 + CLASSES])
    return graph.bytes(metadata)


def yolov6(metadata: Any = (), graph: Any = None) -> bytes:
    """(1, n, 5 + C): centre and size in px, always 1 as objectness, scores; a row for each cell."""
    graph = graph or Graph()
    of = cells()
    boxes = graph.constant(np.hstack([boxes_of(of), np.ones((len(of), 1), np.float32)]).T[None])
    values = graph.node("Concat", boxes, graph.scores(), axis=1)
    graph.output(by_row(graph, values), "outputs", [1, len(of), 5 + CLASSES])
    return graph.bytes(metadata)


IMAGENET_MEAN, IMAGENET_STD = (123.675, 116.28, 103.53), (58.395, 57.12, 57.375)  # RGB


def of_imagenet(graph: Graph, scores: str) -> str:
    """Scores of an input that was normalised by ImageNet's colours, as they are without."""
    std = graph.constant(np.float32(np.array(IMAGENET_STD) / 255.0)[None, :, None])
    mean = graph.constant(np.float32(np.array(IMAGENET_MEAN) / 255.0)[None, :, None])
    return graph.node("Add", graph.node("Mul", scores, std), mean)


NANODET_STRIDES = (8, 16, 32, 64)
NANODET_BINS = 8


def nanodet(
    metadata: Any = (), graph: Any = None, strides: Sequence[int] = NANODET_STRIDES
) -> bytes:
    """(1, n, C + 32): distances of one stride to each side, as bins of which one is certain."""
    graph = graph or Graph()
    of = cells(strides)
    bins = np.full((len(of), 4, NANODET_BINS), -50.0, np.float32)
    bins[:, :, 1] = 50.0
    scores = of_imagenet(graph, graph.scores(strides, "bgr"))
    values = graph.node("Concat", scores, graph.constant(bins.reshape(len(of), -1).T[None]), axis=1)
    graph.output(by_row(graph, values), "output", [1, len(of), CLASSES + 4 * NANODET_BINS])
    return graph.bytes(metadata)


def ssd(metadata: Any = (), graph: Any = None) -> bytes:
    """Three outputs: boxes of 0 to 1, classes from 1 on, and scores."""
    graph = graph or Graph()
    of = cells([8])
    count = CLASSES * len(of)
    boxes = graph.varying(each_class(of)[None] / SIZE)
    labels = graph.varying(class_column(len(of), first=1)[None])
    scores = graph.shaped(of_imagenet(graph, graph.scores([8])), 1, count)
    graph.output(boxes, "bboxes", [1, count, 4])
    graph.output(labels, "labels", [1, count])
    graph.output(scores, "scores", [1, count])
    return graph.bytes(metadata)


def ssd_rows(metadata: Any = (), graph: Any = None) -> bytes:
    """(1, 1, n, 7): image, class from 1 on, score, and corners of 0 to 1."""
    graph = graph or Graph()
    of = cells([8])
    count = CLASSES * len(of)
    # Caffe's networks want blue first, and are normalised to -1 to 1.
    half = graph.constant(np.array(0.5))
    scores = graph.node("Mul", graph.scores([8], "bgr"), half)
    scores = graph.node("Add", scores, half)
    parts = [
        graph.constant(np.vstack([np.zeros(count), class_column(len(of), first=1)])[None]),
        graph.shaped(scores, 1, 1, count),
        graph.constant(each_class(of).T[None] / SIZE),
    ]
    values = by_row(graph, graph.node("Concat", *parts, axis=1))
    graph.output(graph.shaped(values, 1, 1, count, 7), "detection_out", [1, 1, count, 7])
    return graph.bytes(metadata)


def detr(metadata: Any = (), graph: Any = None) -> bytes:
    """Logits (1, n, C + 1), of which the last is no object, and boxes (1, n, 4) of 0 to 1."""
    graph = graph or Graph()
    of = cells([8])
    scores = of_imagenet(graph, graph.scores([8]))
    logits = graph.node("Mul", scores, graph.constant(np.array(40.0)))
    nothing = graph.constant(np.full((1, 1, len(of)), 20.0))
    logits = by_row(graph, graph.node("Concat", logits, nothing, axis=1))
    graph.output(logits, "logits", [1, len(of), CLASSES + 1])
    graph.output(graph.varying(boxes_of(of)[None] / SIZE), "pred_boxes", [1, len(of), 4])
    return graph.bytes(metadata)


def rtdetr(outputs: int = 1, metadata: Any = (), graph: Any = None) -> bytes:
    """(1, n, 4 + C) with boxes and scores of 0 to 1; of two outputs logits and boxes."""
    graph = graph or Graph()
    of = cells([8])
    boxes = graph.varying(boxes_of(of)[None] / SIZE)
    scores = by_row(graph, graph.scores([8]))
    if outputs == 1:
        values = graph.node("Concat", boxes, scores, axis=2)
        graph.output(values, "output0", [1, len(of), 4 + CLASSES])
    else:
        logits = graph.node("Sub", scores, graph.constant(np.array(0.5)))
        logits = graph.node("Mul", logits, graph.constant(np.array(40.0)))
        graph.output(logits, "logits", [1, len(of), CLASSES])
        graph.output(boxes, "pred_boxes", [1, len(of), 4])
    return graph.bytes(metadata)
