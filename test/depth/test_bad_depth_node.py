"""Depth images that cannot be used, or are odd, for every node that takes some."""

import copy
import math
import re
import time
from typing import Any, Callable, List, NamedTuple, Tuple

import genpy
import numpy as np
import pytest
import support
from rgbd_cameras import SIZES, RgbdCameras
from sensor_msgs.msg import Image

from robot_vision.msg import TableArray

WIDTH, HEIGHT = SIZES["depth"]
METRES = np.full((HEIGHT, WIDTH), 2.0, np.float32)
METRES[10:30, 20:40] = 1.2
MILLIMETRES = (METRES * 1000).astype(np.uint16)
NAN, INF = float("nan"), float("inf")
THROTTLE = 5.0  # s, between two lines of one kind


class Node(NamedTuple):
    """A node that takes depths of RgbdCameras."""

    program: str
    arguments: Callable[[RgbdCameras], List[str]]  # that say where the cameras are
    name: Callable[[RgbdCameras], str]
    output: Callable[[RgbdCameras], Tuple[str, Any]]  # a topic that has a message for each frame
    infos: Tuple[str, ...] = ("depth",)  # whose calibration it takes


NODES = {
    "depth_registration": Node(
        "depth_registration_node",
        lambda cameras: ["__name:=taker", *cameras.arguments()],
        lambda cameras: f"{cameras.namespace}/taker",
        lambda cameras: (cameras.output("image_raw"), Image),
        infos=("depth", "rgb"),
    ),
    "tabletop": Node(
        "tabletop.py",
        lambda cameras: ["__name:=taker", f"image:={cameras.topic('depth', 'image_raw')}"],
        lambda cameras: "/taker",
        lambda cameras: ("/taker/tables", TableArray),
    ),
}


class Taker:
    """One of these nodes, its cameras and what it answers."""

    def __init__(self, start: Any, kind: str):
        node = NODES[kind]
        self.begin = time.monotonic()
        self.cameras = RgbdCameras()
        words = node.arguments(self.cameras)
        self.process = start(node.program, *words, "_diagnostic_period:=0.02")
        self.name = node.name(self.cameras).lstrip("/")
        self.answers = support.subscribed(*node.output(self.cameras))
        self.cameras.place()
        for source in (self.cameras.images["depth"], *map(self.cameras.infos.get, node.infos)):
            source.wait_for()
        self.topic = self.cameras.topic("depth", "image_raw")

    def show(self, depth: np.ndarray, encoding: str) -> Any:
        stamp = self.cameras.next_stamp()
        self.cameras.send_infos()
        self.cameras.send("depth", depth, encoding, stamp)
        return stamp

    def shows_until(self, condition: Callable[[], Any], what: str, *frame: Any) -> Any:
        def fulfilled() -> Any:
            self.show(*frame)
            return condition()

        return support.wait_for(fulfilled, what)

    def lines(self, said: str) -> List[str]:
        """The lines of its output with a text, or a regular expression."""
        return [line for line in self.process.output().splitlines() if re.search(said, line)]

    def answer(self, depth: np.ndarray = MILLIMETRES, encoding: str = "16UC1") -> Any:
        """What it makes of a frame; the frame is shown again until that comes."""
        before = len(self.answers.received)
        self.shows_until(lambda: len(self.answers.received) > before, "answers", depth, encoding)
        return self.answers.received[-1]


def spoilt(**fields):
    """Changes these fields of the depth camera's calibration."""

    def spoil(info):
        for name, value in fields.items():
            setattr(info, name, value)

    return spoil


BAD = {  # depths, their encoding, what is done to the calibration, and what the log says
    "colors": (np.zeros((HEIGHT, WIDTH, 3), np.uint8), "bgr8", None, "'bgr8', must be 16UC1"),
    "bytes": (np.zeros((HEIGHT, WIDTH), np.uint8), "mono8", None, "'mono8', must be 16UC1"),
    "another size": (MILLIMETRES[:, 1:].copy(), "16UC1", None, "63x48.* 64x48|64x48.* 63x48"),
    "no calibration": (MILLIMETRES, "16UC1", spoilt(K=[0.0] * 9), "calibrated"),
    "NaN in K": (MILLIMETRES, "16UC1", spoilt(K=[NAN] * 9), "K.* must be finite"),
    "infinity in D": (MILLIMETRES, "16UC1", spoilt(D=[INF] * 5), "D.* must be finite"),
}
# Of these the log says something, too, but they are used.
ODD = {
    "no depth, mm": (0 * MILLIMETRES, "16UC1", "none of the 64x48 pixels has a depth"),
    "no depth, m": (np.full_like(METRES, NAN), "32FC1", "none of the 64x48 pixels has a depth"),
    "infinite": (np.full_like(METRES, INF), "32FC1", "none of the 64x48 pixels has a depth"),
    "negative": (-METRES, "32FC1", "none of the 64x48 pixels has a depth"),
    "mm for m": (1000 * METRES, "32FC1", "the median depth is 2000 m by the encoding 32FC1"),
    "m for mm": (MILLIMETRES // 1000, "16UC1", "the median depth is 2 mm by the encoding 16UC1"),
}


@pytest.mark.parametrize("bad", BAD)
@pytest.mark.parametrize("kind", NODES)
def test_what_cannot_be_used_is_told_now_and_then(start, kind, bad):
    depth, encoding, spoil, said = BAD[bad]
    taker = Taker(start, kind)
    good = taker.cameras.calibration["depth"]
    if spoil:
        taker.cameras.calibration["depth"] = changed = copy.copy(good)
        spoil(changed)
    line = taker.shows_until(lambda: taker.lines(said), said, depth, encoding)[0]
    assert taker.topic in line or taker.cameras.topic("depth", "camera_info") in line
    for _ in range(30):
        taker.show(depth, encoding)
    taker.cameras.calibration["depth"] = good
    taker.answer()
    assert len(taker.lines(said)) <= 1 + (time.monotonic() - taker.begin) / THROTTLE
    assert taker.process.running()


@pytest.mark.parametrize("kind", NODES)
def test_what_holds_no_depths_is_counted(start, kind):
    taker = Taker(start, kind)
    diagnostics = support.Diagnostics()
    taker.answer()

    def last_error():
        return "'bgr8', must be 16UC1" in diagnostics.value(taker.name, "last error")

    taker.shows_until(last_error, "the last error", *BAD["colors"][:2])
    assert int(diagnostics.value(taker.name, "frames refused")) >= 1


@pytest.mark.parametrize("odd", ODD)
@pytest.mark.parametrize("kind", NODES)
def test_odd_depths_are_told_and_used(start, kind, odd):
    depth, encoding, said = ODD[odd]
    taker = Taker(start, kind)
    line = taker.shows_until(lambda: taker.lines(said), said, depth, encoding)[0]
    assert f"{taker.topic}: {said}" in line and "WARN" in line
    assert_finite(taker.answer(depth, encoding))
    assert_finite(taker.answer())
    assert len(taker.lines(said)) <= 1 + (time.monotonic() - taker.begin) / THROTTLE


@pytest.mark.parametrize("kind", NODES)
def test_pixels_that_are_no_depths_spoil_no_numbers(start, kind):
    taker = Taker(start, kind)
    metres = METRES.copy()
    for column, value in enumerate((NAN, INF, -INF, -1.0, 0.0, 1e30, -1e30, 1e-30)):
        metres[:, 5 + 6 * column] = value
    assert_finite(taker.answer(metres, "32FC1"))
    assert not taker.lines("ERROR")


def numbers_of(message):
    """All floating-point numbers of a message but those of images."""
    for name, kind in zip(message.__slots__, message._slot_types):
        value = getattr(message, name)
        if isinstance(value, genpy.Message):
            yield from numbers_of(value)
        elif kind.startswith(("float32", "float64")):
            yield from value if isinstance(value, (list, tuple)) else [value]
        elif isinstance(value, list) and value and isinstance(value[0], genpy.Message):
            for one in value:
                yield from numbers_of(one)


def assert_finite(message):
    """Asserts that a message has finite numbers, and that an image of depths has no others."""
    assert all(map(math.isfinite, numbers_of(message)))
    if isinstance(message, Image) and message.encoding == "32FC1":
        depths = np.frombuffer(message.data, np.float32)
        assert not np.isinf(depths).any() and not (depths <= 0.0).any()
