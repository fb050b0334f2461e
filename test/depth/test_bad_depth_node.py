"""Depth images that cannot be used, or are odd, for every node that takes some."""

import copy
import math
import time
from collections import Counter

import genpy
import numpy as np
import pytest
import support
from depth_takers import HEIGHT, METRES, MILLIMETRES, NODES, WIDTH, Taker
from sensor_msgs.msg import Image

NAN, INF = float("nan"), float("inf")
THROTTLE = 5.0  # s, between two lines of one kind


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


# Of these the tests of the nodes have cameras that are not calibrated.
WITH_OWN_TEST = {("depth_registration", "no calibration"), ("tabletop", "no calibration")}


@pytest.mark.parametrize(
    "kind, bad",
    [(kind, bad) for kind in NODES for bad in BAD if (kind, bad) not in WITH_OWN_TEST],
)
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
    each = Counter(line.partition("]: ")[2] for line in taker.lines(said))
    assert max(each.values()) <= 1 + (time.monotonic() - taker.begin) / THROTTLE
    assert len(each) <= 2  # camera_info may differ from the image, and this one from detections
    assert taker.process.running()


@pytest.mark.parametrize("kind", [name for name, node in NODES.items() if node.counts])
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
    taker.answer()
    told = taker.lines("ERROR")  # of transforms that came late
    assert_finite(taker.answer(metres, "32FC1"))
    assert taker.lines("ERROR") == told


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
