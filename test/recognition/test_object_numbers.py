"""Which of several things of a kind is the first, the second, ... from image to image."""

import itertools

import numpy as np
import pytest

from robot_vision.recognition.found import Found, KnownObject
from robot_vision.recognition.object_numbers import KEPT, ObjectNumbers

# 0.12 m in diameter, with the origin of its mesh 0.5 m beside it.
CORNERS = np.array(list(itertools.product((0.48, 0.54), (-0.04, 0.04), (-0.03, 0.03))))
REACH = 0.5 * np.linalg.norm([0.06, 0.08, 0.06])


def thing(place, name="coke", turn=0.0):
    """One with its middle at a place, m, turned around its middle."""
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    pose[:3, 3] = np.asarray(place) - pose[:3, :3] @ CORNERS.mean(axis=0)
    known = KnownObject("id", name, None, None, CORNERS, {})
    return Found(known, pose, np.eye(6), 0.9)


LEFT, RIGHT = (-0.2, 0.0, 0.8), (0.2, 0.0, 0.8)


@pytest.fixture
def numbers():
    return ObjectNumbers()


def test_two_of_a_kind_keep_their_numbers_in_any_order(numbers):
    assert numbers.of([thing(LEFT), thing(RIGHT)]) == [0, 1]
    assert numbers.of([thing(RIGHT), thing(LEFT)]) == [1, 0]
    assert numbers.of([thing(RIGHT)]) == [1]
    assert numbers.of([thing(RIGHT), thing(LEFT)]) == [1, 0]


def test_what_moves_or_turns_keeps_its_number(numbers):
    at = np.array(LEFT)
    assert numbers.of([thing(RIGHT), thing(at)]) == [0, 1]
    for count in range(1, 20):
        at += (0.9 * REACH, 0.0, 0.0) if count % 2 else (0.0, 0.9 * REACH, 0.0)
        assert numbers.of([thing(at, turn=count), thing(RIGHT)]) == [1, 0]


def test_what_a_moving_camera_sees_keeps_its_numbers(numbers):
    at = np.array([LEFT, RIGHT])
    numbers.of(list(map(thing, at)))
    for count in range(2 * KEPT):
        at += (0.0, 2.0 * REACH, 0.0)
        order = [0, 1] if count % 2 else [1, 0]
        assert numbers.of([thing(at[one]) for one in order]) == order
    assert numbers.of([thing(RIGHT)]) == [1]


def test_what_was_seen_lately_goes_on_before_what_was_not(numbers):
    numbers.of([thing(LEFT), thing(RIGHT)])
    numbers.of([thing(RIGHT)])
    assert numbers.of([thing((0.0, 0.0, 0.8))]) == [1]
    assert numbers.of([thing((0.0, 0.0, 0.8)), thing((0.0, 1.0, 0.8))]) == [1, 0]


def test_what_comes_after_a_rest_is_the_first(numbers):
    numbers.of([thing(LEFT), thing(RIGHT)])
    numbers.clear()
    assert numbers.of([thing(RIGHT)]) == [0]


def test_what_has_come_has_the_lowest_number_that_is_free(numbers):
    there = [(0.3 * count, 0.0, 0.8) for count in range(4)]
    assert numbers.of(list(map(thing, there[:3]))) == [0, 1, 2]
    for _ in range(KEPT):
        assert numbers.of([thing(there[2])]) == [2]
    assert numbers.of([thing(there[2]), thing(there[3])]) == [2, 0]


def test_what_is_hidden_for_some_images_has_its_number_again(numbers):
    numbers.of([thing(LEFT), thing(RIGHT)])
    for _ in range(KEPT - 1):
        assert numbers.of([]) == []
    assert numbers.of([thing((0.0, 0.4, 0.8)), thing(RIGHT), thing(LEFT)]) == [2, 1, 0]


def test_of_two_that_are_near_the_nearer_one_is_it(numbers):
    numbers.of([thing(LEFT)])
    near, nearer = (thing(np.add(LEFT, (share * REACH, 0, 0))) for share in (0.8, -0.2))
    assert numbers.of([near, nearer]) == [1, 0]


def test_each_label_as_frames_have_it_is_counted_by_itself(numbers):
    names = "coke", "mug", "co/ke", "co_ke", "mug"
    places = [(0.3 * index, 0.0, 0.8) for index in range(len(names))]
    found = [thing(place, name) for place, name in zip(places, names)]
    assert numbers.of(found) == [0, 0, 0, 1, 1]


def test_nothing_is_kept_of_what_is_gone(numbers):
    for count in range(50):
        numbers.of([thing(LEFT, f"mug{count}"), thing((count, 0.0, 0.8))])
    assert len(numbers._known) <= KEPT + 2 and len(numbers._known["coke"]) <= KEPT + 1
