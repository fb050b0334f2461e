"""DepthPairs: which depth image is that of an image, and how long an image waits for it."""

from types import SimpleNamespace

import numpy as np
import pytest
import rospy

from robot_vision.ros import depth_pairs
from robot_vision.ros.depth_pairs import LIVING, MAX_DEPTHS, MAX_UNMET, MAX_WAITING, DepthPairs

SLOP = 0.02  # s


def at(seconds, size=4):
    """An image or a depth image with this stamp, s."""
    header = SimpleNamespace(stamp=rospy.Time.from_sec(100.0 + seconds))
    return SimpleNamespace(header=header, image=np.zeros(size, np.uint8))


class Run:
    """Gives a DepthPairs images and depths at its own pace, and notes what goes on."""

    def __init__(self, slop=SLOP):
        self.pairs = DepthPairs(slop)
        self.now = 0.0  # s
        self.went = []

    def image(self, seconds):
        return self._add(self.pairs.add_image, at(seconds))

    def depth(self, seconds, size=4):
        return self._add(self.pairs.add_depth, at(seconds, size))

    def _add(self, add, what):
        self.now += 0.001
        ready = [(of(image), depth and of(depth)) for image, depth in add(what, self.now)]
        self.went += ready
        return ready


def of(image):
    return round(image.header.stamp.to_sec() - 100.0, 4)


def test_without_depths_images_go_on_at_once():
    run = Run()
    for number in range(5):
        assert run.image(number / 30) == [(round(number / 30, 4), None)]


def test_a_depth_that_comes_first_is_taken():
    run = Run()
    for number in range(1, 9):
        run.depth(number)
        assert run.image(number) == [(number, number)]


def test_an_image_waits_for_its_depth():
    run = Run()
    run.depth(1)
    for number in range(2, 9):
        assert run.image(number) == []
        assert run.depth(number) == [(number, number)]


def test_depths_may_be_several_images_late():
    run = Run()
    run.depth(0)
    for number in range(1, 20):
        run.image(number)
        if number > 3:
            run.depth(number - 3)
    assert run.went == [(number, number) for number in range(1, 17)]


def test_images_between_depths_go_on_alone_and_in_order():
    run = Run()
    run.depth(0)
    for number in range(1, 9):
        run.image(number)
        if number % 2 == 0:
            run.depth(number)
    expected = [(number, None if number % 2 else number) for number in range(1, 9)]
    assert run.went == expected


def test_the_nearest_within_the_slop_is_taken():
    run = Run()
    for stamp in (1.0, 1.1, 1.2):
        run.depth(stamp)
    assert run.image(1.112) == [(1.112, 1.1)]
    assert run.image(1.19) == [(1.19, 1.2)]
    assert run.image(1.15) == [(1.15, None)]  # 0.05 s from both
    run = Run(slop=0.0)
    run.depth(1.0)
    assert run.image(1.0) == [(1.0, 1.0)]
    run.depth(1.1)
    assert run.image(1.0999) == [(1.0999, None)]


def test_fast_depths_are_not_those_of_the_images_before():
    """At 100 Hz the depth before is within the slop, too."""
    run = Run()
    run.depth(0.0)
    run.depth(0.01)
    for number in range(2, 9):
        stamp = number / 100
        assert run.image(stamp) == []
        assert run.depth(stamp) == [(stamp, stamp)]


def test_depths_of_which_only_one_is_kept_have_a_period_too(monkeypatch):
    monkeypatch.setattr(depth_pairs, "MAX_BYTES", 1)
    run = Run()
    run.depth(0.0)
    run.depth(0.01)
    assert run.image(0.018) == []
    assert run.depth(0.02) == [(0.018, 0.02)]


def test_images_do_not_wait_for_a_camera_that_is_gone():
    run = Run()
    run.depth(1)
    assert run.image(2) == []
    run.now += LIVING + 0.1
    assert run.image(3) == [(2, None), (3, None)]
    run.depth(4)
    assert run.image(5) == []


def test_few_images_wait():
    run = Run()
    run.depth(0)
    for number in range(1, MAX_WAITING + 1):
        assert run.image(number) == []
    assert run.image(MAX_WAITING + 1) == [(1, None)]


def test_stamps_that_never_meet_are_told_and_not_waited_for():
    run = Run()
    for number in range(MAX_UNMET):
        assert run.pairs.problem("/image", "/depth") == ""
        run.depth(number - 50.0)
        run.image(number)
    said = run.pairs.problem("/image", "/depth")
    assert said == (
        "the stamps on /image and /depth do not meet: the newest are 119.000000 s and 69.000000 s, "
        "must be at most 0.02 s apart"
    )
    assert run.went == [(number, None) for number in range(MAX_UNMET)]
    run.depth(-28.0)
    assert run.image(30) == [(30, None)]
    # Later they do, though the depth comes after its image.
    run.depth(30)
    assert run.pairs.problem("/image", "/depth") == ""
    assert run.image(31) == []
    assert run.depth(31) == [(31, 31)]


@pytest.mark.parametrize("images, depths", [(40, 1), (1, 40)])
def test_another_rate_is_no_problem(images, depths):
    run = Run()
    for turn in range(30):
        stamps = [turn + number / images for number in range(images)]
        others = [turn + number / depths for number in range(depths)]
        for stamp in sorted(set(stamps + others)):
            if stamp in others:
                run.depth(stamp)
            if stamp in stamps:
                run.image(stamp)
        assert run.pairs.problem("/image", "/depth") == ""
    assert sum(depth is not None for _, depth in run.went) >= 30


def test_stamps_that_go_back_and_no_stamps_at_all():
    run = Run()
    for stamp in (50.0, 51.0):
        run.depth(stamp)
        run.image(stamp)
    for stamp in (1.0, 2.0, 3.0):
        run.depth(stamp)
        assert run.image(stamp) == [(stamp, stamp)]
    run = Run()
    for _ in range(5):
        run.depth(0.0)
        assert run.image(0.0) == [(0.0, 0.0)]


def test_few_depths_are_kept_and_all_forgotten(monkeypatch):
    monkeypatch.setattr(depth_pairs, "MAX_BYTES", 100)
    run = Run()
    for number in range(10):
        run.depth(number)
    assert [of(depth) for depth in run.pairs._depths] == [6, 7, 8, 9] and MAX_DEPTHS == 4
    run.depth(10, size=90)
    assert [of(depth) for depth in run.pairs._depths] == [8, 9, 10]
    run.depth(11, size=1000)
    assert [of(depth) for depth in run.pairs._depths] == [11]
    assert run.image(12) == []
    run.pairs.clear()
    assert not run.pairs._depths
    assert run.image(13) == [(13, None)]
