"""What each family of detectors gives out, and how its networks are told from the others'.

Each function returns the head if what was seen of a network fits it, and else None.
"""

from typing import Callable, Dict, Optional, Tuple

from .head import UNCOUNTED, Head, Seen
from .metadata import is_end_to_end, keypoint_shape
from .model_facts import shape_text

MIN_QUERIES, MAX_QUERIES = 10, 1000  # objects that a network without cells gives out
BINS = 4 * 8  # numbers of NanoDet for the four sides of a box


def _darknet(seen: Seen) -> Optional[Head]:
    rows = {shape[1] for shape in seen.shapes if len(shape) == 2}
    if not (seen.forced or seen.model.kind == "darknet") or len(rows) != 1:
        return None
    classes = rows.pop() - 5
    if classes < 1 or any(len(shape) != 2 for shape in seen.shapes):
        return None
    return Head("yolov3", f"rows of 5 + {classes} classes, as darknet's layers give them", classes)


def _ssd(seen: Seen) -> Optional[Head]:
    shapes = seen.shapes
    if len(shapes) == 1 and len(shapes[0]) == 4 and shapes[0][:2] == (1, 1) and shapes[0][3] == 7:
        reason = f"{shape_text(shapes[0])} is a list of detections with 7 numbers each"
        return Head("ssd", reason, seen.told_count, bool(seen.counts))
    boxes = [k for k, shape in enumerate(shapes) if len(shape) == 3 and shape[2] == 4]
    lists = [k for k, shape in enumerate(shapes) if len(shape) == 2]
    if len(shapes) != 3 or len(boxes) != 1 or len(lists) != 2:
        return None
    labels, scores = lists
    if "score" in seen.names[labels] or "label" in seen.names[scores]:
        labels, scores = scores, labels
    order = (boxes[0], labels, scores)
    reason = "boxes, labels and scores"
    return Head("ssd", reason, seen.told_count, bool(seen.counts), order=order)


def _detr(seen: Seen, name: str) -> Optional[Head]:
    shapes = seen.shapes
    if len(shapes) != 2 or any(len(shape) != 3 for shape in shapes) or shapes[0][1] != shapes[1][1]:
        return None
    fours = [k for k in (0, 1) if shapes[k][2] == 4]
    if not fours:
        return None
    named = [k for k in fours if "box" in seen.names[k]]
    boxes = (named or fours)[-1]
    count, width = shapes[boxes][1], shapes[1 - boxes][2]
    if count > MAX_QUERIES and not seen.forced:
        return None
    by_cells = "GridSample" in seen.model.operators or seen.mentions("rtdetr")
    # Of DETR one more is no object.
    if (width in seen.counts) != (width - 1 in seen.counts):
        by_cells = width in seen.counts
    elif not by_cells:
        by_cells = count == 300
    if not seen.forced and by_cells != (name == "rtdetr"):
        return None
    classes = width if name == "rtdetr" else width - 1
    if classes < 1:
        return None
    what = "" if name == "rtdetr" else " and no object"
    reason = f"boxes and logits of {classes} classes{what} for {count} queries"
    return Head(name, reason, classes, order=(1 - boxes, boxes))


def _masked(seen: Seen) -> Tuple[Optional[Tuple[int, ...]], Tuple[int, ...], int]:
    """Returns the shape of the objects, the order of the outputs, and coefficients of masks."""
    flat = [k for k, shape in enumerate(seen.shapes) if len(shape) == 3 and shape[0] == 1]
    maps = [k for k, shape in enumerate(seen.shapes) if len(shape) == 4 and shape[0] == 1]
    if len(flat) == len(seen.shapes) == 1:
        return seen.shapes[flat[0]], (), 0
    if len(flat) == len(maps) == 1 and len(seen.shapes) == 2:
        return seen.shapes[flat[0]], (flat[0], maps[0]), seen.shapes[maps[0]][1]
    return None, (), 0


def _yolov8(seen: Seen) -> Optional[Head]:
    shape, order, masks = _masked(seen)
    if shape is None or is_end_to_end(seen.model.metadata):
        return None
    rows, count = shape[1:]
    known = [seen.cells(8, 16, 32), seen.cells(8, 16, 32, 64), seen.cells(4, 8, 16, 32)]
    if not seen.forced and count not in known:
        return None
    task = seen.task if seen.task in ("pose", "oriented") else "detect"
    task, keypoints, values = "segment" if masks else task, 0, 3
    extra = masks + (task == "oriented")
    if task == "pose" or (not seen.task and not seen.counts and rows == 56):
        task = "pose"
        keypoints, values = keypoint_shape(seen.model.metadata) or (17, 3)
        extra += keypoints * values
    classes = rows - 4 - extra
    if classes < 1:
        return None
    behind = {
        "segment": f" and {masks} of a mask",
        "pose": f" and {keypoints} keypoints of {values} numbers",
        "oriented": " and an angle",
    }.get(task, "")
    reason = f"{shape_text(shape)} has columns of 4 + {classes} classes{behind} for {count} cells"
    return Head(
        "yolov8",
        reason,
        classes,
        task=task,
        keypoints=keypoints,
        keypoint_values=values,
        order=order,
    )


def _yolov5(seen: Seen) -> Optional[Head]:
    shape, order, masks = _masked(seen)
    if shape is None:
        return None
    count, columns = shape[1:]
    known = [3 * seen.cells(8, 16, 32), 3 * seen.cells(8, 16, 32, 64)]
    classes = columns - 5 - masks
    if classes < 1 or not (seen.forced or count in known):
        return None
    behind = f" and {masks} of a mask" if masks else ""
    reason = f"{shape_text(shape)} has rows of 5 + {classes} classes{behind} for 3 boxes a cell"
    task = "segment" if masks else "detect"
    return Head("yolov5", reason, classes, task=task, order=order)


def _grid(seen: Seen, name: str) -> Optional[Head]:
    """YOLOX or NanoDet: a row for each cell."""
    if len(seen.shapes) != 1 or len(seen.shapes[0]) != 3 or seen.shapes[0][0] != 1:
        return None
    count, columns = seen.shapes[0][1:]
    three, four = (8, 16, 32), (8, 16, 32, 64)
    whole = seen.cells(*three) == count
    partial = [one for one in (three, four) if seen.cells(*one, partial=True) == count]
    strides = three if whole else next(iter(partial), None)
    if strides is None or (name == "yolox" and not whole):
        return None
    # NanoDet of the first version has the cells of YOLOX; with COCO's classes it has 112 columns.
    binned = strides == four or columns == 80 + BINS
    if (columns - 5 in seen.counts) != (columns - BINS in seen.counts):
        binned = columns - BINS in seen.counts
    if not seen.forced and binned != (name == "nanodet"):
        return None
    classes = columns - (BINS if name == "nanodet" else 5)
    if classes < 1:
        return None
    what = f"{classes} classes + {BINS}" if name == "nanodet" else f"5 + {classes} classes"
    sizes = ", ".join(map(str, strides))
    reason = f"{shape_text(seen.shapes[0])} has rows of {what}, one for each cell of {sizes} px"
    return Head(name, reason, classes, strides=strides)


def _queries(seen: Seen, name: str) -> Optional[Head]:
    """YOLOv10 or RT-DETR in one output: a row for each object that there may be."""
    if len(seen.shapes) != 1 or len(seen.shapes[0]) != 3 or seen.shapes[0][0] != 1:
        return None
    shape = seen.shapes[0]
    count, columns = shape[1:]
    usual = MIN_QUERIES <= count <= MAX_QUERIES and columns <= 4 + UNCOUNTED
    if not (usual or seen.forced or is_end_to_end(seen.model.metadata)):
        return None
    reason = f"{shape_text(shape)} has rows of {columns}"
    if name == "yolov10":
        if columns != 6 or (not seen.forced and seen.mentions("rtdetr")):
            return None
        reason += ": corners, score and class"
        return Head(name, reason, seen.told_count, bool(seen.counts))
    if columns < 5 or (not seen.forced and is_end_to_end(seen.model.metadata)):
        return None
    return Head(name, f"{reason}: 4 + {columns - 4} classes, and not one for a cell", columns - 4)


FAMILIES: Dict[str, Callable[[Seen], Optional[Head]]] = {
    "yolov3": _darknet,
    "ssd": _ssd,
    "yolov8": _yolov8,
    "yolov5": _yolov5,
    "yolox": lambda seen: _grid(seen, "yolox"),
    "nanodet": lambda seen: _grid(seen, "nanodet"),
    "yolov10": lambda seen: _queries(seen, "yolov10"),
    "detr": lambda seen: _detr(seen, "detr"),
    "rtdetr": lambda seen: _queries(seen, "rtdetr") or _detr(seen, "rtdetr"),
}
