"""What the network is trained with: parts of frames of the room, and collages of its things."""

from typing import List, NamedTuple, Sequence, Tuple

import cv2
import numpy as np

from .frames import Frame, moved
from .geometry import box_in_view, rectangle, transformed
from .patterns import pattern
from .things import Labels, Thing, labels_of
from .variations import as_a_camera_sees, recolored

INPUT = (320, 256)  # px, width and height of the network's input
PAD = 114  # of what is outside of the image, as fill_input has it
HALF = np.array([[1, 0, 0.5], [0, 1, 0.5], [0, 0, 1]])  # from indices of pixels to coordinates


class Sample(NamedTuple):
    """An input of the network, and what is to be found in it."""

    image: np.ndarray  # (height, width, 3) uint8, BGR
    labels: Labels


def warped(image: np.ndarray, matrix: np.ndarray, size: Tuple[int, int], pad: int) -> np.ndarray:
    """An image moved by a 3x3 matrix of continuous coordinates."""
    indices = np.linalg.inv(HALF) @ matrix @ HALF
    return cv2.warpPerspective(image, indices, size, borderValue=(pad, pad, pad))


def letterbox(width: int, height: int) -> np.ndarray:
    """The 3x3 matrix that takes an image of that size into the middle of the network's input."""
    scale = min(INPUT[0] / width, INPUT[1] / height)
    left, top = (INPUT[0] - scale * width) / 2, (INPUT[1] - scale * height) / 2
    return np.array([[scale, 0, left], [0, scale, top], [0, 0, 1]])


def scattered(rng: np.random.Generator, width: int, height: int) -> np.ndarray:
    """A matrix that shows the image larger or smaller, moved, turned a little, or mirrored."""
    scale = np.exp(rng.uniform(np.log(0.3), np.log(1.5)))
    angle = rng.normal(0, 0.12)
    mirror = -1 if rng.random() < 0.4 else 1
    turn = scale * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turn = turn @ np.diag([mirror, 1.0]) @ np.diag(np.exp(rng.normal(0, 0.06, 2)))
    focus = rng.uniform(0.15, 0.85, 2) * (width, height)  # what comes somewhere near the middle
    offset = np.array(INPUT) * rng.uniform(0.3, 0.7, 2) - turn @ focus
    return np.vstack([np.column_stack([turn, offset]), [0, 0, 1]])


def part_of(rng: np.random.Generator, frame: Frame) -> Sample:
    """A frame as a whole, or a part of it, in other colors."""
    height, width = frame.image.shape[:2]
    matrix = letterbox(width, height) if rng.random() < 0.35 else scattered(rng, width, height)
    image = as_a_camera_sees(rng, warped(frame.image, matrix, INPUT, PAD))
    view = clipped(transformed(frame.view, matrix))
    return Sample(image, labels_of(moved(frame.things, matrix), view))


def clipped(view: np.ndarray) -> np.ndarray:
    """The part of a convex outline inside of the network's input."""
    inner = rectangle(*INPUT).astype(np.float32)
    _, points = cv2.intersectConvexConvex(view.astype(np.float32), inner)
    return points.reshape(-1, 2).astype(float)


class Cutout(NamedTuple):
    """A thing without what is around it."""

    frame: Frame
    thing: Thing


def cutouts_of(frames: Sequence[Frame]) -> List[List[Cutout]]:
    """What can be cut out of frames as a whole, in a list for each class."""
    kinds = sorted({thing.name for frame in frames for thing in frame.things})
    return [
        [
            Cutout(f, thing)
            for f in frames
            for thing in f.things
            if thing.name == kind and thing.whole
        ]
        for kind in kinds
    ]


def placed(rng: np.random.Generator, outline: np.ndarray) -> np.ndarray:
    """A 3x3 matrix that takes an outline somewhere into the network's input."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    side = np.exp(rng.uniform(np.log(9), np.log(190)))  # px
    scale = side / max(high - low)
    angle = rng.normal(0, 0.2)
    turn = scale * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turn = turn @ np.diag(np.exp(rng.normal(0, 0.1, 2)))
    to_middle = np.eye(3)
    to_middle[:2, 2] = -(low + high) / 2
    matrix = np.eye(3)
    matrix[:2, :2] = turn
    matrix[2, :2] = rng.normal(0, 0.12, 2) / max(high - low)
    back = np.eye(3)
    back[:2, 2] = rng.uniform(-0.03, 1.03, 2) * INPUT
    return back @ matrix @ to_middle


def paste(rng: np.random.Generator, canvas: np.ndarray, cutout: Cutout, matrix: np.ndarray) -> None:
    """Draws a thing into an image, in colors of its own."""
    edge = transformed(cutout.thing.extent, matrix)
    x0, y0, x1, y1 = box_in_view(edge, rectangle(*INPUT))
    x0, y0 = max(int(x0) - 2, 0), max(int(y0) - 2, 0)
    x1, y1 = min(int(x1) + 3, INPUT[0]), min(int(y1) + 3, INPUT[1])
    if x1 - x0 < 3 or y1 - y0 < 3:
        return
    shift = np.array([[1, 0, -x0], [0, 1, -y0], [0, 0, 1]]) @ matrix
    drawn = warped(cutout.frame.image, shift, (x1 - x0, y1 - y0), PAD)
    drawn = recolored(rng, drawn, 0.8)
    mask = np.zeros(drawn.shape[:2], np.uint8)
    points = np.rint((transformed(cutout.thing.extent, shift) - 0.5) * 16).astype(np.int32)
    cv2.fillConvexPoly(mask, points, 255, cv2.LINE_AA, 4)
    share = cv2.GaussianBlur(mask, (3, 3), 0).astype(np.float32)[..., None] / 255
    under = canvas[y0:y1, x0:x1]
    canvas[y0:y1, x0:x1] = (drawn * share + under * (1 - share) + 0.5).astype(np.uint8)


def collage(rng: np.random.Generator, cutouts: Sequence[Sequence[Cutout]]) -> Sample:
    """Things cut out of the room, on a background that is none."""
    canvas = pattern(rng, *INPUT)
    things: List[Thing] = []
    for number in range(int(rng.integers(1, 9))):
        kind = cutouts[int(rng.integers(len(cutouts)))]
        cutout = kind[int(rng.integers(len(kind)))]
        matrix = placed(rng, cutout.thing.outline)
        paste(rng, canvas, cutout, matrix)
        things.extend(t._replace(distance=-number) for t in moved([cutout.thing], matrix))
    return Sample(as_a_camera_sees(rng, canvas), labels_of(things, rectangle(*INPUT)))
