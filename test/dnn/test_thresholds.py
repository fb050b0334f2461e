"""From which score on the things of each class are reported."""

import pytest

from robot_vision.dnn.thresholds import SURE, ClassThresholds

NAMES = ("person", "cat", "traffic light", "7")


def test_classes_have_the_general_score_or_their_own():
    thresholds = ClassThresholds(NAMES, 0.3, "cat: 0.6, traffic light: 1, 0: 0")
    assert thresholds.scores == [0.0, 0.6, 1.0, 0.3]
    assert thresholds.is_sure(1, 0.6) and not thresholds.is_sure(1, 0.59)
    assert thresholds.is_sure(9, 0.3) and not thresholds.is_sure(9, 0.29)  # it was not announced


def test_a_name_counts_before_a_number():
    assert ClassThresholds(NAMES, 0.3, "7: 0.9").scores == [0.3, 0.3, 0.3, 0.9]


def test_only_some_are_reported():
    thresholds = ClassThresholds(NAMES, 0.3, only=" cat , traffic light,")
    assert [number for number in range(6) if thresholds.wants(number)] == [1, 2]
    assert not thresholds.is_sure(0, 0.9)
    everything = ClassThresholds(NAMES, 0.3, only=" , ")
    assert all(everything.wants(number) for number in range(6))


@pytest.mark.parametrize("threshold", [0.0, 0.2, 0.5, 0.9, 1.0])
def test_the_trackers_scale_has_each_threshold_at_the_same_place(threshold):
    thresholds = ClassThresholds(NAMES, 0.3, f"cat: {threshold}")
    scaled = [thresholds.for_tracker(1, score / 20) for score in range(21)]
    assert scaled == sorted(scaled)
    assert all(0.0 <= one <= 1.0 for one in scaled)
    for number, one in enumerate(scaled):
        assert (one >= SURE) == (number / 20 >= threshold)
        assert thresholds.from_tracker(1, one) == pytest.approx(number / 20)


@pytest.mark.parametrize("threshold", [0.0, 0.25, 1.0])
@pytest.mark.parametrize("score", [1.0 + 2.0**-23, 7.5])
def test_a_score_above_1_is_1_to_the_tracker(threshold, score):
    thresholds = ClassThresholds(NAMES, threshold)
    assert thresholds.for_tracker(0, score) == thresholds.for_tracker(0, 1.0) <= 1.0
    assert thresholds.from_tracker(0, thresholds.for_tracker(0, score)) == pytest.approx(1.0)


@pytest.mark.parametrize(
    "single, only, text",
    [
        ("dog: 0.5", "", "class_scores names the class 'dog', but there are person, cat"),
        ("4: 0.5", "", "class_scores names the class 4"),
        ("\u00b2: 0.5", "", "class_scores names the class '\u00b2'"),
        ("cat: much", "", "class_scores: 'cat' has 'much', not a number"),
        ("cat: true", "", "class_scores: 'cat' has True, not a number"),
        ("cat: 1.2", "", "class_scores: 'cat' is 1.2, must be from 0 to 1"),
        ("cat: .nan", "", "class_scores: 'cat' is nan"),
        ("cat", "", "'cat' has None, not a number"),
        ("cat: [", "", "class_scores is 'cat: \\['"),
        ("}, {", "", "class_scores is"),
        ("", "dog", "only names the class 'dog'"),
    ],
)
def test_what_cannot_be_is_refused(single, only, text):
    with pytest.raises(ValueError, match=text):
        ClassThresholds(NAMES, 0.3, single, only)


def test_more_than_a_score_can_be_is_the_highest_for_the_tracker():
    thresholds = ClassThresholds(["red"], 0.3)
    assert thresholds.for_tracker(0, 132.0) == thresholds.for_tracker(0, 1.0) == 1.0


@pytest.mark.parametrize("key", ["\u00b2", "9" * 5000], ids=["superscript", "long"])
def test_what_only_looks_like_a_number_is_no_class(key):
    with pytest.raises(ValueError, match="only names the class"):
        ClassThresholds(["red"], 0.3, only=key)
