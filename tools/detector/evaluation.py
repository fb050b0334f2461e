"""How well a network finds its things in frames that it was not trained with.

The network is run by cv2.dnn, and its output is decoded by NumPy: nothing of the package that is to
find things with it later is used here. Needs no PyTorch.
"""

import pathlib
import sys
from typing import List, NamedTuple, Sequence

import cv2
import numpy as np

from .frames import Frame, room_album
from .tables import table_album
from .things import MIN_SIDE, NAMES, labels_of
from .variations import as_a_camera_sees
from .views import INPUT, PAD, letterbox

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "test" / "support"))

from average_precision import Boxes, average_precision, overlaps

MIN_SCORE = 0.01  # of what counts: the average precision asks for unsure detections, too
MAX_IOU = 0.5  # of two boxes of a class, or the less sure one is left out
MAX_FOUND = 100


class Example(NamedTuple):
    """An image, and what is in it."""

    image: np.ndarray  # (height, width, 3) uint8, BGR
    truth: Boxes


def held_out_frames(seed: int, scenes: int = 4, frames: int = 30) -> List[Frame]:
    """Frames of rooms and as many of tables, of moments that are not used in training.

    Walls, what stands on the tables and the noise follow from the seed.
    """
    tables = table_album(seed, scenes, frames, held_out=True)
    return room_album(seed, scenes, frames, held_out=True) + tables


def examples_of(frames: Sequence[Frame], seed: int, recolor: bool = True) -> List[Example]:
    """Frames with what is in them, in colors, blur and noise of this seed."""
    result = []
    for number, frame in enumerate(frames):
        rng = np.random.default_rng([seed, number])
        image = as_a_camera_sees(rng, frame.image) if recolor else frame.image
        scale = letterbox(image.shape[1], image.shape[0])[0, 0]
        labels = labels_of(frame.things, frame.view, MIN_SIDE / scale)
        nothing = np.zeros(len(labels.classes))
        truth = Boxes(labels.classes, labels.boxes, nothing, labels.unclear)
        result.append(Example(image, truth))
    return result


def input_of(image: np.ndarray) -> np.ndarray:
    """The network's input (1, 3, height, width) float32 for an image."""
    height, width = image.shape[:2]
    scale, _, left = letterbox(width, height)[0]
    top = letterbox(width, height)[1, 2]
    fitted = cv2.resize(image, (round(width * scale), round(height * scale)))
    canvas = np.full((INPUT[1], INPUT[0], 3), PAD, np.uint8)
    x, y = round(left), round(top)
    canvas[y : y + fitted.shape[0], x : x + fitted.shape[1]] = fitted
    rgb = canvas[..., ::-1].astype(np.float32) / 255
    return np.ascontiguousarray(rgb.transpose(2, 0, 1)[None])


def decoded(output: np.ndarray, width: int, height: int) -> Boxes:
    """What an output (1, 4 + classes, n) has found in an image of that size."""
    rows = output[0].T
    points, kinds = np.nonzero(rows[:, 4:] >= MIN_SCORE)
    scores = rows[points, 4 + kinds]
    order = np.argsort(-scores, kind="stable")[:1000]
    points, kinds, scores = points[order], kinds[order], scores[order]
    matrix = letterbox(width, height)
    middle = (rows[points, :2] - matrix[:2, 2]) / matrix[0, 0]
    half = rows[points, 2:4] / 2 / matrix[0, 0]
    boxes = np.concatenate([middle - half, middle + half], axis=1)
    boxes = np.clip(boxes, 0, [width, height, width, height])
    kept = suppressed(boxes, kinds)[:MAX_FOUND]
    return Boxes(kinds[kept], boxes[kept], scores[kept], np.zeros(len(kept), bool))


def suppressed(boxes: np.ndarray, kinds: np.ndarray) -> np.ndarray:
    """The numbers of boxes, the surest first, without those that one before has found."""
    clash = (overlaps(boxes, boxes) > MAX_IOU) & (kinds[:, None] == kinds)
    kept: List[int] = []
    for number in range(len(boxes)):
        if not clash[number, kept].any():
            kept.append(number)
    return np.array(kept, int)


def found_by(net: cv2.dnn_Net, image: np.ndarray) -> Boxes:
    """What a network finds in an image, in px of the image."""
    net.setInput(input_of(image))
    return decoded(net.forward(), image.shape[1], image.shape[0])


def precisions(net: cv2.dnn_Net, examples: Sequence[Example]) -> List[float]:
    """The average precision at an IoU of 0.5 of each class in NAMES."""
    found = [found_by(net, example.image) for example in examples]
    truth = [example.truth for example in examples]
    return [average_precision(found, truth, kind) for kind in range(len(NAMES))]
