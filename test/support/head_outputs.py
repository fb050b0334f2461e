"""What networks of each family give, and a plain decoding of it in NumPy.

Boxes are (x0, y0, x1, y1) in px of the network's input.
"""

import math

import numpy as np

import robot_vision as rv

WIDTH, HEIGHT = 160, 96  # px, of the networks' input
SIZE = (WIDTH, HEIGHT)  # of an image that is the input itself
CLASSES = 5
HEADS = ("yolov3", "yolov5", "yolov8", "yolov10", "yolox", "nanodet", "ssd", "detr", "rtdetr")
OWN_SUPPRESSION = ("yolov10", "ssd", "detr", "rtdetr")
REG_MAX = 7
STRIDES = {"yolox": (8, 16, 32), "nanodet": (8, 16, 32, 64)}


def head_params(head, **values):
    params = rv.HeadParams()
    params.head, params.classes = head, CLASSES
    params.input_width, params.input_height = WIDTH, HEIGHT
    for name, value in values.items():
        setattr(params, name, value)
    return params


def found_in(params, outputs, placement=None, size=SIZE):
    return rv.HeadDecoder(params).decode(outputs, placement or rv.InputPlacement(), size)


def grid_of(head, width=WIDTH, height=HEIGHT):
    """(n, 3) of the column, row and stride of each cell."""
    cells = []
    for stride in STRIDES[head]:
        side = math.ceil if head == "nanodet" else math.floor
        for y in range(side(height / stride)):
            for x in range(side(width / stride)):
                cells.append((x, y, stride))
    return np.array(cells)


def softmax(logits):
    weights = np.exp(logits - logits.max(axis=-1, keepdims=True))
    return weights / weights.sum(axis=-1, keepdims=True)


def random_outputs(head, seed=0, boxes=77):
    """Numbers of which many make boxes that overlap, of all classes."""
    rng = np.random.default_rng(seed)
    scale = np.array([WIDTH, HEIGHT, WIDTH, HEIGHT])
    if head in STRIDES:
        boxes = len(grid_of(head))
    size = rng.uniform(5, 40, (boxes, 2))
    center = rng.uniform(10, 80, (boxes, 2))
    centered = np.concatenate([center, size], axis=1)
    corners = np.concatenate([center - size / 2, center + size / 2], axis=1)
    scores = rng.uniform(0, 1, (boxes, CLASSES)) ** 4
    objectness = rng.uniform(0, 1, (boxes, 1))
    class_id = rng.integers(0, CLASSES, (boxes, 1))
    best = scores.max(axis=1, keepdims=True)
    if head == "yolov3":
        rows = np.concatenate([centered / scale, objectness, scores * objectness], axis=1)
        made = [rows[:40], rows[40:]]
    elif head == "yolov5":
        made = [np.concatenate([centered, objectness, scores], axis=1)[None]]
    elif head == "yolov8":
        made = [np.concatenate([centered, scores], axis=1).T[None]]
    elif head == "yolov10":
        made = [np.concatenate([corners, best, class_id], axis=1)[None]]
    elif head == "yolox":
        offsets = np.concatenate(
            [rng.normal(0, 2, (boxes, 2)), rng.normal(0.5, 0.5, (boxes, 2))], 1
        )
        made = [np.concatenate([offsets, objectness, scores], axis=1)[None]]
    elif head == "nanodet":
        bins = rng.normal(0, 2, (boxes, 4 * (REG_MAX + 1)))
        made = [np.concatenate([scores, bins], axis=1)[None]]
    elif head == "ssd":
        number = np.zeros((boxes, 1))
        made = [np.concatenate([number, class_id + 1, best, corners / scale], axis=1)[None, None]]
    elif head == "detr":
        made = [rng.normal(0, 3, (1, boxes, CLASSES + 1)), (centered / scale)[None]]
    else:
        made = [np.concatenate([centered / scale, scores], axis=1)[None]]
    return [np.ascontiguousarray(output, np.float32) for output in made]


def raw_boxes(head, outputs):
    """(boxes, scores of each class, objectness or None) before thresholds, of random_outputs()."""
    outputs = [np.asarray(output, np.float64) for output in outputs]
    scale = np.array([WIDTH, HEIGHT, WIDTH, HEIGHT])

    def corners(centered):
        return np.concatenate(
            [
                centered[:, :2] - centered[:, 2:4] / 2,
                centered[:, :2] + centered[:, 2:4] / 2,
            ],
            axis=1,
        )

    def named(class_id, score):
        scores = np.full((len(score), CLASSES), -1.0)
        there = (class_id >= 0) & (class_id < CLASSES) & (class_id == np.floor(class_id))
        scores[np.flatnonzero(there), class_id[there].astype(int)] = score[there]
        return scores

    if head == "yolov3":
        rows = np.concatenate(outputs)
        return corners(rows[:, :4] * scale), rows[:, 5:], rows[:, 4]
    first = outputs[0].reshape(outputs[0].shape[-2:])
    if head == "yolov5":
        return corners(first[:, :4]), first[:, 4:5] * first[:, 5:], first[:, 4]
    if head == "yolov8":
        return corners(first[:4].T), first[4:].T, None
    if head == "yolov10":
        return first[:, :4], named(first[:, 5], first[:, 4]), None
    if head == "yolox":
        grid = grid_of(head)
        centered = np.concatenate(
            [
                (first[:, :2] + grid[:, :2]) * grid[:, 2:],
                np.exp(first[:, 2:4]) * grid[:, 2:],
            ],
            axis=1,
        )
        return corners(centered), first[:, 4:5] * first[:, 5:], first[:, 4]
    if head == "nanodet":
        grid = grid_of(head)
        bins = first[:, CLASSES:].reshape(len(first), 4, REG_MAX + 1)
        sides = softmax(bins) @ np.arange(REG_MAX + 1) * grid[:, 2:]
        center = grid[:, :2] * grid[:, 2:]
        boxes = np.concatenate([center - sides[:, :2], center + sides[:, 2:]], axis=1)
        return np.clip(boxes, 0, scale), first[:, :CLASSES], None
    if head == "ssd":
        return first[:, 3:] * scale, named(first[:, 1] - 1, first[:, 2]), None
    if head == "detr":
        return corners(outputs[1][0] * scale), softmax(first)[:, :-1], None
    return corners(first[:, :4] * scale), first[:, 4:], None


def iou(a, b):
    width = min(a[2], b[2]) - max(a[0], b[0])
    height = min(a[3], b[3]) - max(a[1], b[1])
    shared = max(width, 0.0) * max(height, 0.0)
    areas = [(box[2] - box[0]) * (box[3] - box[1]) for box in (a, b)]
    return shared / (sum(areas) - shared)


def kept(found, params, overlap=iou):
    """What is left of (class, score, box, ...) after non-maximum suppression, the surest first."""
    left = []
    for one in sorted(found, key=lambda one: -one[1]):  # a stable order
        hides = [
            other
            for other in left
            if (params.class_agnostic or other[0] == one[0])
            and overlap(other[2], one[2]) > params.iou_threshold
        ]
        if params.head in OWN_SUPPRESSION or not hides:
            left.append(one)
    return left[: params.max_detections]


def decoded(params, outputs):
    """[(class, score, box)] in px of the input, as plain loops find them."""
    boxes, scores, objectness = raw_boxes(params.head, outputs)
    thresholds = params.class_thresholds or [params.score_threshold] * CLASSES
    found = []
    for i, box in enumerate(boxes):
        class_id = int(np.argmax(scores[i]))
        score = scores[i][class_id]
        if score < np.float32(thresholds[class_id]):
            continue
        if objectness is not None and objectness[i] < np.float32(min(thresholds)):
            continue
        seen = np.clip(box, 0, [WIDTH, HEIGHT, WIDTH, HEIGHT])
        if seen[2] > seen[0] and seen[3] > seen[1]:
            found.append((class_id, score, box))
    return kept(found, params)


def with_extras(head, extras, seed=0):
    """Random outputs of a head with other numbers behind the scores: (n, k)."""
    (output,) = random_outputs(head, seed, len(extras))
    if head == "yolov8":
        return np.concatenate([output, extras.T[None]], axis=1).astype(np.float32)
    return np.concatenate([output, extras[None]], axis=2).astype(np.float32)
