"""What object_detector makes of its live parameters."""

from types import SimpleNamespace

import pytest

from robot_vision.dnn.detection_settings import MAX_BOXES, settings_of
from robot_vision.ros.configs import ObjectDetectorConfig

NAMES = ("cup", "fork")


def settings(**values):
    return settings_of({**ObjectDetectorConfig.defaults, **values}, NAMES)


def test_what_the_tracker_refuses_is_refused_before_anything_is_put_to_use():
    with pytest.raises(ValueError, match="max_age is 0, must be above 0"):
        settings(max_age=0.0)
    assert settings(max_age=0.5).tracker.max_age == 0.5


def test_what_is_unsure_is_found_only_to_continue_tracks():
    found = settings(score_threshold=0.3, unsure_score=0.2, class_scores="fork: 0.1").detection
    assert (found.score_threshold, found.class_thresholds) == (0.2, {"fork": 0.1})
    found = settings(score_threshold=0.3, unsure_score=0.2, track=False).detection
    assert (found.score_threshold, found.class_thresholds) == (0.3, {})


def found(*scores):
    """Objects of class 0, 1, 0, ... with these scores."""
    return [SimpleNamespace(class_id=i % 2, score=score) for i, score in enumerate(scores)]


def test_what_is_left_out_takes_the_place_of_nothing():
    """It is neither found, nor does it count if its score is above all thresholds."""
    only = settings(only="fork", score_threshold=0.3, unsure_score=0.2, max_detections=1)
    assert (only.detection.score_threshold, only.detection.class_thresholds) == (0.2, {"cup": 1.0})
    assert only.detection.max_detections > 1
    assert [one.score for one in only.sure(found(1.0, 0.9, 0.8, 0.7))] == [0.9]


def test_what_is_not_reported_is_followed():
    """What counts is what is found, also if most of it is lost, unconfirmed or less sure."""
    one = settings(max_detections=1)
    assert one.tracker.max_boxes == one.detection.max_detections == MAX_BOXES
    assert settings(max_detections=1, track=False).detection.max_detections == 1
    assert settings(max_detections=5000).detection.max_detections == 5000


def test_of_what_is_followed_the_surest_are_reported():
    two = settings(max_detections=2, class_scores="fork: 0.9")
    tracks = [
        SimpleNamespace(id=number, class_id=class_id, score=score, lost=lost)
        # Scores of the tracker: that of the fork, 4, is one of 0.96 of the network.
        for number, class_id, score, lost in (
            (2, 0, 0.7, False),
            (3, 0, 0.9, True),
            (4, 1, 0.8, False),
            (7, 0, 0.85, False),
        )
    ]
    assert [one.id for one in two.reported(tracks)] == [4, 7]
    one = settings(max_detections=1, class_scores="fork: 0.9")
    assert [one.id for one in one.reported(tracks)] == [4]
    assert [one.id for one in settings(max_detections=4).reported(tracks)] == [2, 3, 4, 7]
    seen = [one for one in tracks if one.id in (2, 3)]
    assert [one.id for one in two.reported(seen)] == [2, 3]
    assert [one.id for one in one.reported(seen)] == [2]


def test_what_is_unsure_takes_the_place_of_nothing():
    scores = settings(class_scores="cup: 0.9", score_threshold=0.3, max_detections=2)
    assert scores.detection.max_detections > 2
    assert [one.score for one in scores.sure(found(0.8, 0.7, 0.6, 0.5, 0.4, 0.35))] == [0.7, 0.5]


def test_of_classes_with_the_same_name_the_lowest_score_counts():
    config = {**ObjectDetectorConfig.defaults, "only": "1", "score_threshold": 0.3, "track": False}
    assert settings_of(config, ["cup", "fork", "fork"]).detection.class_thresholds == {"cup": 1.0}
    config["class_scores"] = "0: 0.2"
    config["only"] = ""
    thresholds = settings_of(config, ["cup", "cup"]).detection.class_thresholds
    assert thresholds == {"cup": 0.2}
