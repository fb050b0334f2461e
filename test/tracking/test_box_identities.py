"""Boxes keep their ids: IDF1 against the truth, with a detector for every fourth frame."""

import numpy as np
import pytest
from moving_boxes import RATE, Detector, crossing_world, run_tracker
from track_identities import assignment, idf1

import robot_vision as rv

FRAMES = 600
EVERY = 4  # frames from one result to the next
SCENE_CLASSES = {"tag_0": 0, "tag_1": 0, "line": 7}  # each other thing has one of its own


def test_idf1_is_that_of_its_definition():
    box, other = (0.0, 0.0, 10.0, 10.0), (100.0, 0.0, 110.0, 10.0)
    truth = [{"a": box, "b": other}] * 10
    assert idf1(truth, truth) == 1.0
    assert idf1(truth, [{}] * 10) == 0.0
    assert idf1([{}] * 10, [{}] * 10) == 1.0
    # The ids change places after six frames: twelve of twenty boxes are right.
    swapped = [{1: box, 2: other}] * 6 + [{2: box, 1: other}] * 4
    assert idf1(truth, swapped) == pytest.approx(12 / 20)
    # A new id after six frames: IDTP 6 + 10, IDFP 4, IDFN 4.
    assert idf1(truth, [{1: box, 2: other}] * 6 + [{3: box, 2: other}] * 4) == pytest.approx(
        2 * 16 / (2 * 16 + 4 + 4)
    )
    # Of boxes that overlap by half or more, all are right; by less, none.
    near, far = (0.0, 0.0, 10.0, 5.1), (0.0, 0.0, 10.0, 4.9)
    assert idf1([{"a": box}] * 4, [{1: near}] * 3 + [{1: far}]) == pytest.approx(2 * 3 / 8)


def results_of(detector, truth, classes):
    """Of every fourth frame, by its number."""
    return {
        number: detector.find(number, truth[number], classes)
        for number in range(0, len(truth), EVERY)
    }


def gaps(truth, name):
    """How long a thing is hidden or out of view between two times in view, s."""
    seen = [number for number, frame in enumerate(truth) if name in frame]
    return [(b - a - 1) / RATE for a, b in zip(seen, seen[1:]) if b - a > 1]


@pytest.fixture(scope="module")
def crossing():
    """The world's truth, the camera's warps, and the class of each thing."""
    world = crossing_world()
    truth = [world.truth(number) for number in range(FRAMES)]
    warps = [world.warp(number) for number in range(FRAMES)]
    return truth, warps, {thing.name: thing.class_id for thing in world.things}


def test_things_of_the_crossing_world_are_hidden_and_leave_for_good(crossing):
    truth, warps, classes = crossing
    hidden = [gap for name in classes for gap in gaps(truth, name)]
    assert max(hidden) < rv.BoxTrackerParams().max_age and sum(gap > 0.3 for gap in hidden) >= 3
    ends = [max(i for i, frame in enumerate(truth) if name in frame) for name in classes]
    assert sum(end < 0.9 * FRAMES for end in ends) >= 3
    shifts = [np.linalg.norm(warp[:, 2]) for warp in warps]
    assert max(shifts) > 4.0  # px, from one frame to the next


@pytest.mark.parametrize("late, least", [(0, 0.97), (3, 0.96)])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_crossing_and_hidden_boxes_keep_their_ids(crossing, seed, late, least):
    truth, warps, classes = crossing
    results = results_of(Detector(seed), truth, classes)
    tracks = run_tracker(rv.BoxTracker(), truth, results, warps, late)
    assert idf1(truth, tracks) >= least
    for name, (track, _) in assignment(truth, tracks).items():
        seen = [number for number, frame in enumerate(truth) if name in frame]
        boxes = [number for number, frame in enumerate(tracks) if track in frame]
        assert boxes[0] - seen[0] < 60 and seen[-1] - boxes[-1] < 12  # one track, all the time


def test_a_camera_that_shakes_costs_ids_unless_its_motion_is_told(crossing):
    truth, warps, classes = crossing
    results = results_of(Detector(1), truth, classes)
    told, untold = (
        idf1(truth, run_tracker(rv.BoxTracker(), truth, results, known)) for known in (warps, None)
    )
    assert told > untold + 0.02


@pytest.fixture(scope="module")
def room():
    """The scene's boxes in view of one period, and the camera's motion as its images tell it."""
    params = rv.SceneParams()
    params.width, params.height = 320, 240
    scene, motion = rv.Scene(params), rv.CameraMotion()
    truth, warps = [], []
    for number in range(FRAMES):
        visible = [thing for thing in scene.truth(number).objects if thing.visible]
        corners = [(*thing.outline.min(axis=0), *thing.outline.max(axis=0)) for thing in visible]
        truth.append({thing.name: box for thing, box in zip(visible, corners)})
        warps.append(motion.update(scene.render(number)))
        assert motion.known or number == 0
    return truth, warps


@pytest.mark.parametrize("late, least", [(0, 0.95), (3, 0.87)])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_things_of_the_scene_keep_their_ids_over_a_whole_period(room, seed, late, least):
    truth, warps = room
    names = sorted({name for frame in truth for name in frame})
    assert len(names) == 8 and sum(len(gaps(truth, name)) for name in names) >= 20
    assert max(gap for name in names for gap in gaps(truth, name)) < rv.BoxTrackerParams().max_age
    classes = {name: index for index, name in enumerate(names)}
    classes["tag_1"] = classes["tag_0"]
    detector = Detector(seed, missing=0.0, unsure=0.0, false_boxes=0.0)
    results = results_of(detector, truth, classes)
    tracks = run_tracker(rv.BoxTracker(), truth, results, warps, late)
    assert idf1(truth, tracks) >= least
    # Each has one id, and there are no others.
    assert len({track for frame in tracks for track in frame}) == len(names)
