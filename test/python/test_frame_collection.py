"""Frames that are kept for learning a bundle, and what is said of them."""

import numpy as np
import pytest

from robot_vision.frame_collection import FrameCollection

WIDTH = 640  # px
SQUARE = np.array([[100.0, 200.0], [150.0, 200.0], [150.0, 150.0], [100.0, 150.0]])


def moved(x):
    return SQUARE + np.array([x, 0.0])


@pytest.fixture
def collection():
    return FrameCollection([3, 1, 2, 7], master=1, most=5)


def add(collection, *tags, shift=0.0):
    """A frame of tags in a row, moved to the right by `shift` px."""
    collection.add(WIDTH, [(tag, moved(60.0 * tag + shift)) for tag in tags])


def ids_of(collection):
    return [sorted(frame) for frame in collection.frames()]


def test_a_frame_is_kept_if_it_shows_two_tags_somewhere_else(collection):
    for shift, count in ((0, 1), (5, 1), (9.9, 1), (10, 2), (-5, 2), (15, 2), (20, 3)):
        add(collection, 1, 2, shift=shift)
        assert len(collection.frames()) == count, shift
    assert collection.offered == 7


def test_one_corner_that_has_moved_is_enough(collection):
    add(collection, 1, 2)
    turned = moved(120.0)
    turned[2, 1] += 11.0
    collection.add(WIDTH, [(1, moved(60.0)), (2, turned)])
    assert len(collection.frames()) == 2
    assert np.array_equal(collection.frames()[1][2], turned)


def test_fewer_tags_are_nothing_new_but_others_are(collection):
    add(collection, 1, 2, 3)
    add(collection, 1, 2)
    assert ids_of(collection) == [[1, 2, 3]]
    add(collection, 2, 7)
    add(collection, 1, 2, 3, 7)
    assert ids_of(collection) == [[1, 2, 3], [2, 7], [1, 2, 3, 7]]


def test_other_tags_and_those_that_are_there_twice_are_left_out(collection):
    add(collection, 1, 99)
    add(collection, 1, 2, 2)
    assert ids_of(collection) == [[1]]
    add(collection, 1, 2, 3, 3, 99)
    assert ids_of(collection) == [[1, 2]]


def test_no_more_than_asked_for(collection):
    for i in range(7):
        assert collection.full == (i >= 5)
        add(collection, 1, 2, shift=20.0 * i)
    assert len(collection.frames()) == 5
    assert collection.summary().startswith("5 of 5 frames; ")


def test_the_summary_says_what_is_missing(collection):
    assert collection.summary() == "0 of 5 frames; not seen: 1, 2, 3, 7"
    add(collection, 3)
    assert collection.summary() == "0 of 5 frames; not seen: 1, 2, 7; not linked with 1: 3"
    add(collection, 3, 2)
    assert collection.summary() == (
        "1 of 5 frames; tags: 2 (1), 3 (1); together: 2+3 (1); not seen: 1, 7; "
        "not linked with 1: 2, 3"
    )
    add(collection, 7, 3)
    add(collection, 1, 7)
    assert collection.summary() == (
        "3 of 5 frames; tags: 1 (1), 2 (1), 3 (2), 7 (2); together: 1+7 (1), 2+3 (1), 3+7 (1)"
    )
