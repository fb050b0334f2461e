"""The collection of frames for learning a bundle, and its messages."""

import numpy as np
import pytest

import robot_vision as rv
from robot_vision.tags.frame_collection import FrameCollection

K = np.array([[500.0, 0.0, 320.0], [0.0, 500.0, 240.0], [0.0, 0.0, 1.0]])
CAMERA = rv.CameraModel(640, 480, K)
SQUARE = np.array([[100.0, 200.0], [150.0, 200.0], [150.0, 150.0], [100.0, 150.0]])


def moved(x):
    return SQUARE + np.array([x, 0.0])


@pytest.fixture
def collection():
    return FrameCollection([3, 1, 2, 7], master=1, most=5)


def add(collection, *tags, shift=0.0):
    """Adds a frame of tags in a row, moved to the right by `shift` px."""
    collection.add(CAMERA, [(tag, moved(60.0 * tag + shift)) for tag in tags])


def ids_of(collection):
    return [sorted(frame) for frame in collection.frames()]


def test_a_frame_is_kept_if_it_shows_two_tags_at_new_places(collection):
    for shift, count in ((0, 1), (5, 1), (9.9, 1), (10, 2), (-5, 2), (15, 2), (20, 3)):
        add(collection, 1, 2, shift=shift)
        assert len(collection.frames()) == count, shift
    assert collection.offered == 7


def test_one_corner_that_has_moved_is_enough(collection):
    add(collection, 1, 2)
    turned = moved(120.0)
    turned[2, 1] += 11.0
    collection.add(CAMERA, [(1, moved(60.0)), (2, turned)])
    assert len(collection.frames()) == 2
    assert np.array_equal(collection.frames()[1][2], turned)


def test_other_tags_are_new_but_fewer_tags_are_not(collection):
    add(collection, 1, 2, 3)
    add(collection, 1, 2)
    assert ids_of(collection) == [[1, 2, 3]]
    add(collection, 2, 7)
    add(collection, 1, 2, 3, 7)
    assert ids_of(collection) == [[1, 2, 3], [2, 7], [1, 2, 3, 7]]


def test_foreign_tags_and_duplicates_are_ignored(collection):
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


def test_skipped_frames_are_counted_and_the_last_problem_named(collection):
    add(collection, 1, 2)
    before = collection.summary()
    assert collection.problem == ""
    collection.skip("it is too small")
    collection.skip("it is too large")
    assert collection.problem == "it is too large" and ids_of(collection) == [[1, 2]]
    assert collection.summary() == before + "; 2 frames left out: it is too large"


@pytest.mark.parametrize(
    "corners",
    [
        np.full((4, 2), np.nan),
        np.full((4, 2), -np.inf),
        np.where([[1, 0], [0, 0], [0, 0], [0, 0]], np.nan, SQUARE),
        np.zeros((4, 2)),
        SQUARE * 1e9,
        SQUARE * 1e300,
        SQUARE * 1e-3,
        SQUARE[::-1],
        SQUARE[[0, 2, 1, 3]],
        np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]),
        np.array([[0.0, 40.0], [40.0, 40.0], [5.0, 35.0], [0.0, 0.0]]),
    ],
)
def test_impossible_corners_are_ignored(collection, corners):
    with np.errstate(all="raise"):
        collection.add(CAMERA, [(1, SQUARE), (2, moved(60.0)), (3, corners)])
        collection.add(CAMERA, [(7, corners)])
    assert ids_of(collection) == [[1, 2]]
    assert collection.summary().endswith("; 2 sightings left out, whose corners no camera sees")


def test_corners_where_the_lens_has_no_ray_are_ignored(collection):
    """They would have the layout refused, and with it all other frames."""
    k1 = -0.3
    lens = rv.CameraModel(640, 480, K, [k1, 0.0, 0.0, 0.0, 0.0])
    bend = np.sqrt(-1.0 / (3.0 * k1))  # where the distorted radius, r + k1 r^3, is largest
    right = 320.0 + 500.0 * (bend + k1 * bend**3)  # px, no ray is seen beyond
    for left in (right - 40.0, right + 1.0):
        beyond = moved(left - SQUARE[0, 0])
        assert not np.isfinite(lens.rays(beyond)).all()
        collection.add(lens, [(1, SQUARE), (2, moved(60.0)), (3, beyond)])
    assert ids_of(collection) == [[1, 2]]
    assert collection.summary().endswith("; 2 sightings left out, whose corners no camera sees")


def test_thousands_of_detections_in_a_frame(collection):
    others = [(id, SQUARE) for id in range(-(2**31), -(2**31) + 10000)]
    twice = [(7, SQUARE)] * 1000
    collection.add(CAMERA, [*others, *twice, (1, SQUARE), (2, moved(60.0)), (2**31 - 1, SQUARE)])
    assert ids_of(collection) == [[1, 2]] and "left out" not in collection.summary()
