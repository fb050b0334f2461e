"""What is around a network, by us and by the usual Python: filling its input, decoding its output.

Both sides work on the same data in turns, on one core; the medians of their CPU time are
compared.
"""

import statistics
import time
from typing import Callable, List, NamedTuple, Tuple

import cv2
import numpy as np
from plain_network import OVERLAP, SCORE, decode, letterbox, planes_of
from tables import table, yes

from robot_vision import HeadDecoder, HeadParams, InputParams, InputPlacement, fill_input

ROUNDS = 100
CLASSES = 80
TEXT = """### Around a network: its input, and what its output says

On one thread, CPU ms, medians.

"""
Side = Callable[[], object]


class Contest(NamedTuple):
    name: str
    theirs: Side
    ours: Side
    goal: float  # ms that ours may take; 0 for none


def filling(size: Tuple[int, int], side: int, goal: float = 0.0) -> Contest:
    image = np.random.default_rng(1).integers(0, 256, (size[1], size[0], 3), np.uint8)
    params = InputParams()
    params.width = params.height = side
    out = np.empty((1, 3, side, side), np.float32)

    def theirs() -> np.ndarray:
        return planes_of(letterbox(image, side)[0])

    def ours() -> np.ndarray:
        fill_input(image, None, params, out)
        return out

    if np.abs(theirs() - ours()).max() > 1 / 255:
        raise RuntimeError("the inputs differ by more than a gray level")
    return Contest(f"letterbox {size[0]}x{size[1]} to {side}", theirs, ours, goal)


def scene_output(boxes: int, objects: int, around: int) -> np.ndarray:
    """(boxes, 84): low scores, and objects with so many boxes around each."""
    rng = np.random.default_rng(2)
    rows = np.zeros((boxes, 4 + CLASSES), np.float32)
    rows[:, :4] = rng.uniform(10, 600, (boxes, 4))
    rows[:, 4:] = rng.uniform(0, 0.02, (boxes, CLASSES))
    for _ in range(objects):
        which = rng.choice(boxes, around, False)
        place = np.r_[rng.uniform(100, 500, 2), rng.uniform(30, 200, 2)]
        rows[which, :4] = place + rng.normal(0, 3, (around, 4))
        rows[which, 4 + rng.integers(CLASSES)] = rng.uniform(0.3, 0.95, around)
    return rows


def decoding(head: str, boxes: int, objects: int, around: int, goal: float = 0.0) -> Contest:
    rows = scene_output(boxes, objects, around)
    params = HeadParams()
    params.head, params.classes = head, CLASSES
    params.score_threshold, params.iou_threshold = SCORE, OVERLAP
    params.max_detections = 1000
    decoder = HeadDecoder(params)
    if head == "yolov8":
        output = np.ascontiguousarray(rows.T[None])
    else:
        ones = np.where(rows[:, 4:].max(axis=1) > SCORE, 1.0, 0.01).astype(np.float32)
        output = np.insert(rows, 4, ones, axis=1)[None]

    def theirs() -> int:
        if head == "yolov8":
            columns = output[0].T
            return len(decode(columns[:, :4], columns[:, 4:])[0])
        return len(decode(output[0, :, :4], output[0, :, 4:5] * output[0, :, 5:])[0])

    def ours() -> int:
        return len(decoder.decode([output], InputPlacement(), (640, 640)))

    if theirs() != ours():
        raise RuntimeError(f"{theirs()} objects are not {ours()}")
    name = f"decoding {head} {boxes}x{output.shape[1 if head == 'yolov8' else 2]}, "
    return Contest(f"{name}{objects * around} boxes of {objects} objects", theirs, ours, goal)


def medians(contest: Contest) -> Tuple[float, float]:
    """ms of theirs and of ours."""
    times: List[List[float]] = [[], []]
    for _ in range(ROUNDS):
        for side, run in enumerate((contest.theirs, contest.ours)):
            begin = time.process_time_ns()
            run()
            times[side].append((time.process_time_ns() - begin) * 1e-6)
    return statistics.median(times[0]), statistics.median(times[1])


def network_table() -> str:
    """A line for each contest: ms of both sides, and what ours may take."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    contests = [
        filling((640, 480), 416, 0.3),
        filling((640, 480), 640),
        filling((1280, 720), 640),
        filling((1920, 1080), 640),
        decoding("yolov8", 8400, 30, 15, 0.6),
        decoding("yolov8", 8400, 60, 50),
        decoding("yolov5", 25200, 30, 15),
    ]
    rows = []
    for contest in contests:
        theirs, ours = medians(contest)
        goal = [f"<= {contest.goal:g}", yes(ours <= contest.goal)] if contest.goal else ["-", "-"]
        cells = [f"{theirs:.3g}", f"{ours:.3g}", f"{theirs / ours:.1f}"]
        rows.append([contest.name, *cells, *goal])
    cv2.setNumThreads(before)
    return TEXT + table(["work", "cv2 and NumPy", "ours", "times", "goal", "reached"], rows)
