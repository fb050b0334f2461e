"""What networks of each family give for one box in an image, made from the box."""

import numpy as np
from head_outputs import CLASSES, HEIGHT, WIDTH, grid_of


def with_box(head, box, score=0.75, class_id=2):
    """Outputs with one box, corners in px of the input, and nothing else."""
    x0, y0, x1, y1 = box
    centered = np.array([(x0 + x1) / 2, (y0 + y1) / 2, x1 - x0, y1 - y0])
    scale = np.array([WIDTH, HEIGHT, WIDTH, HEIGHT])
    scores = np.zeros(CLASSES)
    scores[class_id] = score
    if head == "yolov3":
        rows = np.zeros((9, 5 + CLASSES))
        rows[4] = [*centered / scale, 0.9, *scores]
        return [np.zeros((0, 5 + CLASSES), np.float32), rows.astype(np.float32)]
    if head in ("yolov5", "yolox"):
        rows = np.zeros((len(grid_of("yolox")), 5 + CLASSES))
        i = 7
        if head == "yolox":
            x, y, stride = grid_of("yolox")[i]
            centered = np.array(
                [
                    centered[0] / stride - x,
                    centered[1] / stride - y,
                    *np.log(centered[2:] / stride),
                ]
            )
        rows[i] = [*centered, 0.8, *scores / 0.8]
        return [rows[None].astype(np.float32)]
    if head == "yolov8":
        columns = np.zeros((1, 4 + CLASSES, 21), np.float32)
        columns[0, :, 13] = [*centered, *scores]
        return [columns]
    if head == "yolov10":
        rows = np.zeros((1, 6, 6), np.float32)
        rows[0, 0] = [*box, score, class_id]
        return [rows]
    if head == "nanodet":
        return [nanodet_with_box(box, scores)]
    if head == "ssd":
        rows = np.full((1, 1, 4, 7), -1, np.float32)
        rows[0, 0, 0] = [0, class_id + 1, score, *np.array(box) / scale]
        return [rows]
    boxes = np.tile(centered / scale, (1, 3, 1)).astype(np.float32)
    if head == "detr":
        logits = np.full((1, 3, CLASSES + 1), -30, np.float32)
        logits[..., CLASSES] = 0
        logits[0, 1, class_id] = np.log(score / (1 - score))
        return [logits, boxes]
    rows = np.zeros((1, 3, 4 + CLASSES), np.float32)
    rows[0, 1] = [*centered / scale, *scores]
    return [rows]


def nanodet_with_box(box, scores):
    """Distances between two bins, in the cell of stride 16 in the middle of the box."""
    grid = grid_of("nanodet")
    rows = np.full((1, len(grid), CLASSES + 32), -40, np.float32)
    x, y = int((box[0] + box[2]) / 32), int((box[1] + box[3]) / 32)
    row = rows[0, np.flatnonzero((grid == (x, y, 16)).all(axis=1))[0]]
    row[:CLASSES] = scores
    for side, far in enumerate(
        np.array([16 * x - box[0], 16 * y - box[1], box[2] - 16 * x, box[3] - 16 * y])
    ):
        whole, share = divmod(far / 16, 1)
        bins = row[CLASSES + 8 * side : CLASSES + 8 * side + 8]
        bins[int(whole)], bins[int(whole) + 1] = np.log([1 - share, max(share, 1e-12)])
    return rows
