"""A BoxTracker refuses what is none, changes nothing then, and bounds what is too much."""

import numpy as np
import pytest
from hostile import INF, NAN

import robot_vision as rv

BOX = (10.0, 20.0, 50.0, 80.0)
GOOD = (0, 0.9, BOX)


def started():
    made = rv.BoxTracker()
    for number in range(4):
        made.update(0.1 * number, [GOOD])
    return made


REFUSED = {
    "time_s is nan, must be finite": (NAN, [], None),
    "time_s is inf, must be finite": (INF, [], None),
    r"detections\[1\].score is nan, must be from 0 to 1": (0.4, [GOOD, (0, NAN, BOX)], None),
    r"detections\[0\].score is 1.5, must be from 0 to 1": (0.4, [(0, 1.5, BOX)], None),
    r"detections\[0\].score is -1, must be from 0 to 1": (0.4, [(0, -1.0, BOX)], None),
    r"detections\[1\].box is \(nan, ": (0.4, [GOOD, (0, 0.9, (NAN, 1.0, 2.0, 3.0))], None),
    r"detections\[0\].box is \(1, 1, inf, 3\)": (0.4, [(0, 0.9, (1.0, 1.0, INF, 3.0))], None),
    r"detections\[0\].box is \(-inf, ": (0.4, [(0, 0.9, (-INF, 1.0, 2.0, 3.0))], None),
    r"detections\[0\].box is \(50, 20, 10, 80\), must": (0.4, [(0, 0.9, (50, 20, 10, 80))], None),
    r"detections\[0\].box is \(10, 80, 50, 20\), must": (0.4, [(0, 0.9, (10, 80, 50, 20))], None),
    r"detections\[0\].box is \(0, 0, 2e\+07, 9\)": (0.4, [(0, 0.9, (0, 0, 2e7, 9))], None),
    "warp is nan, must be finite": (0.4, [GOOD], [[1, 0, NAN], [0, 1, 0]]),
    "warp is inf, must be finite": (0.4, [GOOD], [[1, 0, 0], [0, INF, 0]]),
    "warp is of determinant 0, must be regular": (0.4, [GOOD], [[1, 1, 0], [1, 1, 0]]),
    "warp is of determinant -1, must be regular": (0.4, [GOOD], [[-1, 0, 640], [0, 1, 0]]),
    "warp is of determinant 1e.06, must": (0.4, [GOOD], [[1000, 0, 0], [0, 1000, 0]]),
    r"warp is a shift by \(1e\+09, 0\) px": (0.4, [GOOD], [[1, 0, 1e9], [0, 1, 0]]),
    r"expected warp as a \(2, 3\) array": (0.4, [GOOD], np.eye(3)),
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_is_none_is_refused_by_its_name_and_changes_nothing(message):
    time, detections, warp = REFUSED[message]
    made, other = started(), started()
    with pytest.raises(ValueError, match=message):
        made.update(time, detections, warp)
    if "detections" not in message:
        with pytest.raises(ValueError, match=message):
            made.predict(time, warp)
    (track,), (untouched,) = made.update(0.4, [GOOD]), other.update(0.4, [GOOD])
    assert (track.id, track.box, track.detection) == (1, untouched.box, 0)


@pytest.mark.parametrize(
    "detections",
    [None, 3, [3], [(0, 0.9)], [(0, 0.9, (1, 2, 3))], [("a", 0.9, BOX)], [(0, "b", BOX)], "boxes"],
)
def test_what_is_no_list_of_detections_is_a_type_error(detections):
    with pytest.raises(TypeError):
        rv.BoxTracker().update(0.0, detections)


def test_a_warp_for_a_frame_of_the_past_is_refused():
    made = started()
    made.predict(0.35)
    made.predict(0.4)
    with pytest.raises(ValueError, match="warp is given for a frame of the past, must be none"):
        made.update(0.35, [GOOD], np.eye(2, 3))
    (track,) = made.update(0.35, [GOOD])
    assert track.id == 1


def test_numbers_of_numpy_will_do():
    made = rv.BoxTracker()
    for number in range(2):
        box = np.array(BOX, np.float32)
        tracks = made.update(number * 0.1, [(np.int64(3), np.float32(0.9), box)], np.eye(2, 3))
    assert [(track.class_id, track.box) for track in tracks] == [(3, pytest.approx(BOX))]


def test_empty_lists_are_results():
    made = rv.BoxTracker()
    assert made.update(0.0, []) == [] and made.predict(0.1) == [] and made.left_out == 0
    made = started()
    (track,) = made.update(0.4, [])
    assert track.lost


def test_boxes_without_area_are_left_out_and_told():
    made = started()
    thin, point = (0, 0.9, (10.0, 20.0, 10.0, 80.0)), (0, 0.9, (5.0, 5.0, 5.0, 5.0))
    tracks = made.update(0.4, [thin, GOOD, point, (0, 0.9, (0.0, 0.0, 0.01, 9.0))])
    assert [track.detection for track in tracks] == [1]
    assert made.left_out == 3
    made.update(0.5, [GOOD])
    assert made.left_out == 0


def test_the_surest_of_too_many_boxes_are_used_and_the_others_told():
    random = np.random.default_rng(1)
    corners = random.uniform(0.0, 5000.0, (10000, 2))
    scores = random.uniform(0.5, 1.0, 10000)
    detections = [(0, score, (x, y, x + 20, y + 20)) for score, (x, y) in zip(scores, corners)]
    params = rv.BoxTrackerParams()
    made = rv.BoxTracker(params)
    for number in range(2):
        tracks = made.update(0.1 * number, detections)
        assert made.left_out == 10000 - params.max_boxes
    surest = np.argsort(-scores)[: params.max_boxes]
    assert {track.detection for track in tracks} == set(surest)


def test_there_are_never_more_tracks_than_max_boxes():
    params = rv.BoxTrackerParams()
    params.max_boxes, params.min_hits, params.max_prediction = 20, 1, 1.0
    made = rv.BoxTracker(params)
    for number in range(10):  # other places each time: nothing is seen again
        y = 50.0 * number
        detections = [(0, 0.9, (x, y, x + 10.0, y + 10.0)) for x in range(0, 200, 20)]
        tracks = made.update(0.01 * number, detections)
        assert len(tracks) == min(10 * (number + 1), 20)
        assert made.left_out == (10 if number >= 2 else 0)


def test_any_warps_and_boxes_leave_all_numbers_finite():
    random = np.random.default_rng(2)
    made = rv.BoxTracker()
    for number in range(3000):
        time = number / 30.0
        scale, angle = np.exp(random.uniform(-2.0, 2.0)), random.uniform(-4.0, 4.0)
        turn = scale * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        warp = np.column_stack([turn, random.uniform(-1e4, 1e4, 2)])
        corner, size = random.uniform(-1e3, 1e3, 2), np.exp(random.uniform(-3.0, 6.0, 2))
        detections = [GOOD, (0, 0.9, (*corner, *(corner + size)))]
        if number % 5 == 0:
            tracks = made.update(time, detections, warp)
        else:
            tracks = made.predict(time, warp)
        for track in tracks:
            assert np.isfinite([*track.box, *track.velocity]).all()
            assert track.box[0] < track.box[2] and track.box[1] < track.box[3]


def test_a_camera_that_moves_without_end_leaves_no_track():
    for warp in ([[9, 0, 0], [0, 9, 0]], [[0.2, 0, 0], [0, 0.2, 0]], [[1, 0, 1e7], [0, 1, 0]]):
        made = started()
        for number in range(1500):  # more than are kept apart, and in all more than a number can be
            tracks = made.predict(0.31 + 1e-4 * number, warp)
            assert np.isfinite([track.box for track in tracks]).all()
            assert tracks or number > 0
        assert not tracks
        assert not made.update(0.5, [GOOD])
        (track,) = made.update(0.6, [GOOD])
        assert track.id == 2 and track.box == pytest.approx(BOX)


@pytest.mark.parametrize(
    "name, value, message",
    [
        ("high_score", 1.5, "high_score is 1.5, must be from 0 to 1"),
        ("low_score", 0.6, "low_score is 0.6, must be at most high_score, 0.5"),
        ("min_iou", 0.0, "min_iou is 0, must be from 0.01 to 1"),
        ("min_hits", 0, "min_hits is 0, must be from 1 to 100"),
        ("max_age", 0.0, "max_age is 0, must be above 0 and at most 60"),
        ("max_age", NAN, "max_age is nan, must be above 0 and at most 60"),
        ("max_boxes", 1001, "max_boxes is 1001, must be from 1 to 1000"),
    ],
)
def test_a_parameter_out_of_range_is_refused_and_changes_nothing(name, value, message):
    params = rv.BoxTrackerParams()
    setattr(params, name, value)
    with pytest.raises(ValueError, match=message):
        rv.BoxTracker(params)
    made = started()
    with pytest.raises(ValueError, match=message):
        made.configure(params)
    assert [track.id for track in made.update(0.4, [GOOD])] == [1]
