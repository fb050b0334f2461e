"""The things of the scenes that the network finds, and what of them an image shows."""

from typing import Any, List, NamedTuple, Sequence

import numpy as np

from .geometry import box_in_view, visible_share

NAMES = (
    *("ball", "tag", "qr_code", "checkerboard", "box", "poster"),  # of the room
    *(
        "bottle",
        "bracket",
        "can",
        "drill",
        "duck",
        "mug",
        "nut",
    ),  # of the table, where a box is, too
)
MIN_SHARE = 0.5  # of an outline in view: what shows less may be found or not
MIN_TRACE = 0.02  # of an outline in the image: what is outside of it is not there
MIN_SIDE = 10.0  # px of a box in the network's input: what is smaller may be found or not

# How much larger than its outline a thing is with its white margin or frame, across and along.
MARGINS = {
    "tag": (10 / 8, 10 / 8),
    "qr_code": (27 / 21, 27 / 21),
    "checkerboard": (10 / 7, 8 / 5),
    "poster": (1.06, 1.06),
}


class Thing(NamedTuple):
    """A thing in an image."""

    name: str  # of NAMES
    outline: np.ndarray  # (n, 2) px, continuous
    extent: np.ndarray  # (n, 2) px, the outline with its margin
    distance: float  # m, or another number that is smaller for what is nearer
    whole: bool  # completely in the image it was drawn in, and covered by nothing


class Labels(NamedTuple):
    """What is to be found in an image."""

    classes: np.ndarray  # (n,) int, indices of NAMES
    boxes: np.ndarray  # (n, 4) px x0, y0, x1, y1, continuous
    unclear: np.ndarray  # (n,) bool: shows too little to be asked for, too much to be wrong


def class_of(name: str) -> str:
    """The class of an object of the scene's truth; empty for what the network does not find."""
    name = "tag" if name.startswith("tag_") else name
    return name if name in NAMES else ""


def with_margin(name: str, outline: np.ndarray) -> np.ndarray:
    """The outline of a thing with its margin; that of a board starts at its bottom left."""
    if name not in MARGINS:
        return outline
    across, along = MARGINS[name]
    a, b, c, d = outline
    middle = outline.mean(axis=0)
    right, up = (b + c - a - d) / 4, (c + d - a - b) / 4
    skew = (a - b + c - d) / 4  # what perspective leaves of the corners
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    return np.array([middle + x * across * right + y * along * up + x * y * skew for x, y in signs])


def things_of(truth: Any) -> List[Thing]:
    """The things in a frame of a scene, by its rv.SceneTruth."""
    found = []
    for item in truth.objects:
        name = class_of(item.name)
        if name:
            outline = np.array(item.outline) + 0.5  # the scene's pixels have their centres at 0
            distance = float(np.linalg.norm(item.pose[:3, 3]))
            extent = with_margin(name, outline)
            found.append(Thing(name, outline, extent, distance, item.visible))
    return found


def labels_of(things: Sequence[Thing], view: np.ndarray, min_side: float = MIN_SIDE) -> Labels:
    """What is to be found in an image with these things.

    What is hidden completely is unclear, too: the outline of a thing before it may be larger than
    the thing itself, which then shows what is behind.

    Args:
        view: the outline of what the image shows.
        min_side: px, of the smallest box that must be found.
    """
    classes, boxes, unclear = [], [], []
    for thing in things:
        nearer = [other.extent for other in things if other.distance < thing.distance]
        if visible_share(thing.outline, view, []) >= MIN_TRACE:
            box = box_in_view(thing.outline, view)
            classes.append(NAMES.index(thing.name))
            boxes.append(box)
            share = visible_share(thing.outline, view, nearer)
            unclear.append(share < MIN_SHARE or min(box[2:] - box[:2]) < min_side)
    return Labels(
        np.array(classes, int),
        np.array(boxes, float).reshape(-1, 4),
        np.array(unclear, bool),
    )
