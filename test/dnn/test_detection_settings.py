"""What object_detector makes of its live parameters."""

import pytest

from robot_vision.dnn.detection_settings import settings_of
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
