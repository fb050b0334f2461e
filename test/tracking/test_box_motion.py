"""A BoxTracker does what one written with NumPy and SciPy does, with full matrices."""

import numpy as np
import pytest
from moving_boxes import RATE, Detector, crossing_world
from plain_box_tracker import PlainBoxTracker
from scipy.optimize import linear_sum_assignment

import robot_vision as rv


def similarity(random):
    angle, scale = random.uniform(-0.03, 0.03), random.uniform(0.97, 1.03)
    cos, sin = scale * np.cos(angle), scale * np.sin(angle)
    return np.array([[cos, -sin, random.normal(0, 5)], [sin, cos, random.normal(0, 5)]])


def test_the_motion_is_that_of_a_kalman_filter_with_full_matrices():
    random = np.random.default_rng(6)
    params = rv.BoxTrackerParams()
    params.min_hits, params.min_iou, params.max_prediction = 1, 0.01, 1.0
    ours, plain = rv.BoxTracker(params), PlainBoxTracker(params)
    truth, time = np.array([200.0, 150.0, 260.0, 280.0]), 0.0
    for number in range(200):
        time += random.uniform(0.0, 0.05)
        warp = similarity(random) if number % 3 else None
        if warp is not None:
            middle = warp[:, :2] @ (truth[:2] + truth[2:]) / 2.0 + warp[:, 2]
            half = np.sqrt(np.linalg.det(warp[:, :2])) * (truth[2:] - truth[:2]) / 2.0
            truth = np.concatenate([middle - half, middle + half])
        truth += random.normal(1.0, 0.3, 4)
        if number % 4:
            tracks, expected = ours.predict(time, warp), plain.predict(time, warp)
        else:
            seen = [(0, 0.9, tuple(truth + random.normal(0, 2, 4)))] if number % 16 else []
            tracks, expected = ours.update(time, seen, warp), plain.update(time, seen, warp)
        found = [[track.id, *track.box] for track in tracks]
        assert np.array(found) == pytest.approx(np.array([[i, *box] for i, box in expected]))
        if tracks:
            assert tracks[0].velocity == pytest.approx(plain.velocities()[0])
    assert len(tracks) == 1 and tracks[0].id == 1


@pytest.mark.parametrize("seed", [11, 12])
def test_many_boxes_have_the_ids_and_places_that_a_plain_tracker_gives_them(seed):
    world, detector = crossing_world(), Detector(seed, false_boxes=2.0)
    params = rv.BoxTrackerParams()
    params.mix_classes = True  # the plain one knows no classes
    ours, plain = rv.BoxTracker(params), PlainBoxTracker(params)
    count = 0
    for number in range(400):
        time, warp = number / RATE, world.warp(number)
        if number % 3:
            tracks, expected = ours.predict(time, warp), plain.predict(time, warp)
        else:
            classes = {thing.name: thing.class_id for thing in world.things}
            found = detector.find(number, world.truth(number), classes)
            tracks, expected = ours.update(time, found, warp), plain.update(time, found, warp)
        assert [track.id for track in tracks] == [i for i, _ in expected]
        boxes = np.array([track.box for track in tracks]).reshape(-1, 4)
        assert boxes == pytest.approx(np.array([box for _, box in expected]).reshape(-1, 4))
        count += len(tracks)
    assert count > 2000


@pytest.mark.parametrize("shape", [(1, 1), (3, 8), (8, 3), (40, 40), (120, 90), (300, 300)])
@pytest.mark.parametrize("share", [0.02, 0.3, 1.0])
def test_an_assignment_has_the_sum_of_scipy_s(shape, share):
    random = np.random.default_rng([*shape, int(100 * share)])
    for _ in range(3):
        gains = random.uniform(0.0, 1.0, shape) - (random.random(shape) >= share) * 1.5
        columns = np.array(rv.best_assignment(gains))
        rows = np.flatnonzero(columns >= 0)
        assert len(set(columns[rows])) == len(rows)
        assert (gains[rows, columns[rows]] > 0.0).all()
        clipped = np.maximum(gains, 0.0)
        best = clipped[linear_sum_assignment(clipped, maximize=True)].sum()
        assert gains[rows, columns[rows]].sum() == pytest.approx(best)


def test_assignments_of_nothing_and_what_is_none():
    assert rv.best_assignment(np.zeros((0, 3))) == []
    assert rv.best_assignment(np.zeros((3, 0))) == [-1, -1, -1]
    assert rv.best_assignment([[0.5, 0.0], [0.7, -1.0]]) == [-1, 0]
    for gains in ([1.0], [[[1.0]]]):
        with pytest.raises(ValueError, match="expected gains as an array of 2 dimensions"):
            rv.best_assignment(gains)
    with pytest.raises(ValueError, match=r"gains\[0\]\[1\] is nan, must be from -1e\+12 to 1e\+12"):
        rv.best_assignment([[0.0, float("nan")]])
