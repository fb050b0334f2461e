"""Where a BoxTracker expects boxes: between results, before a moving camera, and with late ones."""

import numpy as np
import pytest
from tracked_boxes import STEP, at, shown, started, sure, tracker

IDENTITY = np.eye(2, 3)


def test_predictions_go_on_at_the_speed_of_the_box():
    made = tracker()
    for number in range(12):
        (track,) = made.update(number * STEP, [sure(at(50.0 + 80.0 * number * STEP))]) or [None]
    assert track.velocity == pytest.approx((80.0, 0.0), abs=2.0)
    for ahead in (0.0, 0.04, 0.08, 0.12):
        (guess,) = made.predict(11 * STEP + ahead)
        assert guess.box == pytest.approx(at(50.0 + 80.0 * (11 * STEP + ahead)), abs=1.5)
        assert (guess.id, guess.predicted, guess.lost) == (1, ahead > 0.0, False)
        assert guess.age == pytest.approx(ahead)


def test_a_result_that_is_late_counts_as_if_it_had_been_in_time():
    random = np.random.default_rng(5)
    turn = np.array([[0.999, -0.02, 3.0], [0.02, 0.999, -2.0]])
    in_time, late = tracker(), tracker()
    frame = 1.0 / 32.0  # s; exact, so that sums of times are, too
    results = {}
    for number in range(60):
        warp = turn if number % 3 else IDENTITY
        if number % 4 == 0:
            box = np.array(at(50.0 + number)) + random.normal(0.0, 1.0, 4)
            results[number] = [sure(tuple(box))]
        expected = in_time.predict(number * frame, warp)
        if number in results:
            shown_then = shown(in_time.update(number * frame, results[number]))
        delay = number - 3
        if delay in results:
            assert shown(late.update(delay * frame, results[delay])) == shown_then
            both = late.predict(number * frame, warp), expected
            found, wanted = ([(t.id, *t.box, *t.velocity) for t in tracks] for tracks in both)
            assert np.array(found) == pytest.approx(np.array(wanted))
        else:
            late.predict(number * frame, warp)
    assert len(expected) == 1


def test_the_camera_s_motion_moves_boxes_and_their_velocities():
    made = tracker()
    for number in range(12):
        made.update(number * STEP, [sure(at(50.0 + 80.0 * number * STEP))])
    time = 11 * STEP
    (before,) = made.predict(time)
    quarter = np.array([[0.0, -1.0, 300.0], [1.0, 0.0, 20.0]])
    (after,) = made.predict(time, quarter)
    x, y = np.mean([before.box[0::2], before.box[1::2]], axis=1)
    moved = np.mean([after.box[0::2], after.box[1::2]], axis=1)
    assert moved == pytest.approx([300.0 - y, 20.0 + x])
    assert after.velocity == pytest.approx((-before.velocity[1], before.velocity[0]))
    larger = np.array([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]])
    (twice,) = made.predict(time, larger)
    assert np.subtract(twice.box[2:], twice.box[:2]) == pytest.approx(
        2.0 * np.subtract(after.box[2:], after.box[:2])
    )


def test_a_box_that_is_cut_off_is_not_taken_for_one_that_moves():
    made = tracker()
    time = started(made, [at(50.0)], 8)
    whole, upper = at(50.0), at(50.0, height=31.0)
    made.update(time, [sure(upper)])
    for ahead in (0.03, 0.06, 0.1):
        (track,) = made.predict(time + ahead)
        left, top, right, bottom = track.box
        assert (left, right) == pytest.approx(whole[0::2], abs=1.0)
        assert top > 90.0 and bottom > 125.0 and track.id == 1


@pytest.mark.parametrize("jump", [-0.5, 3.5])
@pytest.mark.parametrize("call", ["update", "predict"])
def test_a_jump_in_time_begins_anew_with_other_ids(jump, call):
    made = tracker()
    time = started(made, [at(50.0)]) - STEP + jump
    assert not (made.update(time, []) if call == "update" else made.predict(time))
    assert not made.update(time + STEP, [sure(at(50.0))])
    (track,) = made.update(time + 2 * STEP, [sure(at(50.0))])
    assert track.id == 2


def test_the_same_time_again_changes_nothing_by_itself():
    made = tracker()
    time = started(made, [at(50.0)]) - STEP
    first = shown(made.predict(time))
    assert shown(made.predict(time)) == first
    (track,) = made.update(time, [sure(at(50.0))])
    assert track.id == 1 and np.isfinite(track.box).all()


def test_after_an_hour_with_nothing_found_all_is_as_at_the_start():
    """At 32 Hz, before a camera that turns to and fro."""
    made = tracker()
    last = started(made, [at(50.0)])
    turns = [np.array([[1.0, 0.0, shift], [0.0, 1.0, 0.0]]) for shift in (1.5, -1.5)]
    frame = 1.0 / 32.0
    for number in range(32 * 3600):
        tracks = made.predict(last + number * frame, turns[number % 2])
        if number % 4 == 0:
            tracks = made.update(last + number * frame, [])
        assert not tracks or number * frame < 4.0
    now = last + 32 * 3600 * frame
    for number in range(4):
        tracks = made.update(now + number * STEP, [sure(at(200.0))])
    (track,) = tracks
    assert (track.id, track.predicted, track.lost) == (2, False, False)
    assert track.box == pytest.approx(at(200.0), abs=0.5)
