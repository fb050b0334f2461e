"""A BoxTracker's promises, with boxes whose motion is known."""

import pytest
from tracked_boxes import STEP, at, shown, started, sure, tracker, unsure


def test_a_track_is_reported_from_its_min_hits_th_detection_on():
    for min_hits in (1, 2, 4):
        made = tracker(min_hits=min_hits)
        for hit in range(1, 7):
            tracks = made.update(hit * STEP, [sure(at(50.0))])
            assert len(tracks) == (hit >= min_hits)
        (track,) = tracks
        assert (track.id, track.class_id, track.score, track.detection) == (1, 0, 0.9, 0)
        assert not track.predicted and not track.lost and track.age == 0.0
        assert track.box == pytest.approx(at(50.0))


def test_what_a_result_does_not_have_is_not_confirmed():
    made = tracker()
    for number in range(8):
        boxes = [sure(at(50.0))] if number % 2 else []
        assert not made.update(number * STEP, boxes)


def test_unsure_detections_continue_tracks_but_begin_none():
    made = tracker()
    assert not any(made.update(i * STEP, [unsure(at(50.0))]) for i in range(5))
    made = tracker()
    time = started(made, [at(50.0)])
    (track,) = made.update(time, [unsure(at(51.0)), (0, 0.05, at(50.0))])
    assert (track.detection, track.score, track.lost) == (0, 0.3, False)
    (track,) = made.update(time + STEP, [(0, 0.05, at(50.0))])
    assert track.lost and track.predicted and track.detection == -1
    # A track that the last result did not have is continued by a sure detection only.
    (track,) = made.update(time + 2 * STEP, [unsure(at(50.0))])
    assert track.lost
    (track,) = made.update(time + 3 * STEP, [sure(at(50.0))])
    assert not track.lost and track.id == 1


def test_a_sure_detection_is_associated_before_an_unsure_one():
    made = tracker()
    time = started(made, [at(50.0)])
    (track,) = made.update(time, [unsure(at(50.0)), sure(at(60.0))])
    assert track.detection == 1


def test_the_sum_of_the_overlaps_decides_and_not_the_largest():
    made = tracker(min_iou=0.1)
    first, second = at(100.0), at(120.0)
    time = started(made, [first, second])
    # The nearest pair is the second track with the first detection: then the first would have none.
    tracks = made.update(time, [sure(at(112.0)), sure(at(138.0))])
    assert [(track.id, track.detection) for track in tracks] == [(1, 0), (2, 1)]


def test_a_false_detection_beside_a_thing_that_is_missed_does_not_take_its_track():
    made = tracker()
    time = started(made, [at(50.0)], 8)
    beside = at(75.0)  # overlaps by 0.23, but the thing is at rest
    (track,) = made.update(time, [sure(beside)])
    assert track.lost and track.box == pytest.approx(at(50.0), abs=0.1)
    # What moves like this from the beginning on is another thing.
    tracks = made.update(time + STEP, [sure(at(50.0)), sure(at(100.0))])
    assert [(track.id, track.detection) for track in tracks] == [(1, 0), (2, 1)]


def test_what_moves_by_more_than_its_size_between_results_is_followed():
    made = tracker()
    for number in range(6):  # 60 px in each step, of a box that is 40 px wide
        tracks = made.update(number * STEP, [sure(at(20.0 + 60.0 * number))])
        assert [track.id for track in tracks] == ([1] if number else [])
    assert tracks[0].velocity == pytest.approx((480.0, 0.0), abs=25.0)


def test_what_bounces_is_followed():
    made = tracker()
    for number in range(8):
        made.update(number * STEP, [sure(at(20.0 + 45.0 * number))])
    for number in range(1, 5):  # expected at 380, it is back at 290
        tracks = made.update((7 + number) * STEP, [sure(at(335.0 - 45.0 * number))])
        assert [(track.id, track.lost) for track in tracks] == [(1, False)]
    assert tracks[0].velocity == pytest.approx((-360.0, 0.0), abs=80.0)
    # Nothing that is at rest gets that far.
    made = tracker()
    time = started(made, [at(50.0)], 8)
    (track,) = made.update(time, [sure(at(150.0))])
    assert track.lost


def test_nothing_is_reached_that_differs_in_size_or_may_be_explained_by_another():
    made = tracker()
    for number in range(8):
        made.update(number * STEP, [sure(at(20.0 + 45.0 * number))])
    (track,) = made.update(8 * STEP, [sure(at(290.0, width=80.0, height=120.0))])
    assert track.lost
    made = tracker()
    for number in range(8):
        made.update(number * STEP, [sure(at(20.0 + 45.0 * number))])
    (track,) = made.update(8 * STEP, [sure(at(290.0)), unsure(at(378.0))])
    assert track.detection == 1


def test_classes_do_not_mix_unless_they_may():
    made = tracker()
    time = started(made, [at(50.0)])
    (track,) = made.update(time, [sure(at(50.0), class_id=1)])
    assert track.lost
    made = tracker(mix_classes=True)
    time = started(made, [at(50.0)])
    for number in range(3):
        (track,) = made.update(time + number * STEP, [sure(at(50.0), class_id=1)])
        assert (track.id, track.class_id, track.lost) == (1, 0, False)
    for number in range(3, 8):
        (track,) = made.update(time + number * STEP, [sure(at(50.0), class_id=1)])
    assert (track.id, track.class_id) == (1, 1)


def test_a_hidden_track_is_reported_for_a_while_and_known_for_longer():
    made = tracker(max_prediction=0.3, max_age=1.0)
    time = started(made, [at(50.0)]) - STEP  # when it was seen last
    for number in range(1, 8):
        tracks = made.update(time + number * STEP, [])
        assert len(tracks) == (number * STEP <= 0.3)
        assert all(t.lost and t.predicted and t.age == number * STEP for t in tracks)
    (track,) = made.update(time + 8 * STEP, [sure(at(50.0))])
    assert track.id == 1
    for number in range(9, 17):
        made.update(time + number * STEP, [])
    tracks = [made.update(time + number * STEP, [sure(at(50.0))]) for number in (17, 18)]
    assert [list(shown(found)) for found in tracks] == [[], [2]]
