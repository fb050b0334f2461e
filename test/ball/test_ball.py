"""The ball of the synthetic scene, found by its colour, against the scene's truth."""

from types import SimpleNamespace

import cv2
import numpy as np
import pytest

import robot_vision as rv

RATE = 30.0  # Hz
FRAMES = 600  # a period of the scene
DIAMETER = 0.2  # m
HIDDEN = 9  # frames, 0.3 s


def ball_outline(bgr):
    """Outline of the largest region of the course's blue: (n, 2) int, px."""
    return rv.RegionFinder().apply(rv.hsv_mask(bgr))[1][0].outline


@pytest.fixture(scope="module")
def seen():
    """The found ball and the true one: arrays with a row for each frame."""
    scene = rv.Scene(rv.SceneParams())
    rows = []
    for frame in range(FRAMES):
        ball = next(o for o in scene.truth(frame).objects if o.name == "ball")
        outline = ball_outline(scene.render(frame))
        found = rv.ball_position(scene.camera, outline, DIAMETER)
        radius = cv2.minEnclosingCircle(outline)[1]
        truth = (ball.visible, ball.pose[:3, 3], ball.center)
        rows.append((found.position, found.center, radius, *truth))
    names = ("position", "center", "radius", "visible", "true_position", "true_center")
    data = SimpleNamespace(**{name: np.array(x) for name, x in zip(names, zip(*rows))})
    ahead, behind = np.roll(data.true_center, -1, 0), np.roll(data.true_center, 1, 0)
    data.true_velocity = (ahead - behind) * RATE / 2.0
    return data


def measurement(seen, frame):
    return rv.BallMeasurement(seen.center[frame], seen.radius[frame])


def length(vectors):
    return np.linalg.norm(vectors, axis=1)


def test_position_and_centre_are_the_truth(seen):
    assert seen.visible.mean() > 0.9
    position = length(seen.position - seen.true_position) / length(seen.true_position)
    center = length(seen.center - seen.true_center)
    for name, errors, limits in (("position", position, (0.005, 0.01)), ("px", center, (0.3, 0.6))):
        typical, worst = np.percentile(errors[seen.visible], [50, 99])
        print(f"{name}: median {typical:.4f}, 99th percentile {worst:.4f}")
        assert typical < limits[0] and worst < limits[1]


@pytest.mark.parametrize("step", [1, 2], ids=["30Hz", "15Hz"])
def test_tracker_knows_centre_and_velocity(seen, step):
    tracker = rv.BallTracker()
    states = [tracker.update(f / RATE, measurement(seen, f)) for f in range(0, FRAMES, step)]
    assert not any(state.predicted for state in states)
    center = length(np.array([s.center for s in states]) - seen.true_center[::step])
    assert np.median(center) < 0.3 and np.percentile(center, 99) < 0.6

    truth = seen.true_velocity[::step]
    moves = length(truth) > 30.0
    moves[:3] = False  # the first frames tell too little
    error = length(np.array([s.velocity for s in states]) - truth) / length(truth)
    print(f"velocity: median error {np.median(error[moves]):.3f} of the speed")
    assert moves.mean() > 0.9
    assert np.median(error[moves]) < 0.1


def bounces_between(seen, first, last):
    """Whether the ball's vertical velocity in the image jumps upwards within these frames."""
    return (np.diff(seen.true_velocity[first : last + 1, 1]) < -100.0).any()


def test_tracker_bridges_an_occlusion(seen):
    """Hidden for 0.3 s in free flight. The prediction lacks only the fall in that time."""
    # The largest in px/s^2: the scene's gravity (m/s^2), focal length (px), least distance (m).
    gravity = 2.15 * 520.0 / 1.5
    falls = gravity * (HIDDEN / RATE) ** 2 / 2.0
    tried = 0
    for begin in range(20, FRAMES - 20, 7):
        if bounces_between(seen, begin - 5, begin + HIDDEN + 2):
            continue
        tried += 1
        tracker = rv.BallTracker()
        for frame in range(begin - 15, begin):
            tracker.update(frame / RATE, measurement(seen, frame))
        for frame in range(begin, begin + HIDDEN):
            state = tracker.update(frame / RATE, None)
            assert state.predicted
            assert np.linalg.norm(state.center - seen.true_center[frame]) < 1.3 * falls
        again = tracker.update((begin + HIDDEN) / RATE, measurement(seen, begin + HIDDEN))
        assert not again.predicted
        assert np.linalg.norm(again.center - seen.true_center[begin + HIDDEN]) < 1.0
    assert tried > 20


def test_tracker_takes_parameters_and_returns_a_state():
    params = rv.BallTrackerParams()
    params.max_prediction = 2.0
    tracker = rv.BallTracker(params)
    state = tracker.update(1.0, rv.BallMeasurement(center=(3.5, 4.5), radius=2.0))
    assert (state.center, state.velocity, state.radius) == ((3.5, 4.5), (0.0, 0.0), 2.0)
    assert state.covariance.shape == (4, 4) and not state.predicted
    assert tracker.update(2.9, None).predicted
    assert tracker.predict(3.1) is None and tracker.update(3.1, None) is None
    params.gate = 0.0
    with pytest.raises(ValueError, match="gate is 0, must be from 1 to 100"):
        rv.BallTracker(params)


def test_camera_of_a_camera_info():
    matrix = [500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0]
    for distortion in ((), (0.1, 0.0, 0.0, 0.0), (0.1,) * 5, (0.1,) * 8):
        camera = rv.CameraModel(640, 480, matrix, distortion)
        assert camera.K.tolist() == np.reshape(matrix, (3, 3)).tolist()
        assert list(distortion) == camera.D
    with pytest.raises(ValueError):
        rv.CameraModel(640, 480, [1.0])
    camera = rv.CameraModel(640, 480, matrix, (0.1,) * 4, "equidistant")
    assert camera.distortion_model == "equidistant"
    with pytest.raises(ValueError, match="distortion_model is 'fish', must be plumb_bob"):
        rv.CameraModel(640, 480, matrix, (), "fish")
    assert rv.is_calibrated(matrix) and not rv.is_calibrated(np.zeros((3, 3)))


@pytest.mark.parametrize(
    "model, distortion, distorted",
    [
        ("plumb_bob", (), False),
        ("", (), False),
        ("plumb_bob", (0.0,) * 5, False),
        ("plumb_bob", (0.0, 0.0, 0.0, 1e-9, 0.0), True),
        ("rational_polynomial", (0.0,) * 7 + (0.1,), True),
        ("equidistant", (0.0,) * 4, True),
        ("fisheye", (0.0,) * 4, True),
    ],
)
def test_lenses_that_distort_are_known(model, distortion, distorted):
    camera = rv.CameraModel(640, 480, np.diag([500.0, 500.0, 1.0]), distortion, model)
    assert rv.is_distorted(camera) is distorted
    assert rv.is_equidistant(model) is (model in ("equidistant", "fisheye"))


def test_position_of_few_points_is_none():
    camera = rv.CameraModel(640, 480, [500.0, 0, 320, 0, 500, 240, 0, 0, 1])
    assert rv.ball_position(camera, np.zeros((0, 2), int), 0.2) is None
    assert rv.ball_position(camera, [(5, 5)], 0.2) is None
    for outline, diameter in (([(640, 0)], 0.2), ([(5, 5)], 0.0), ([5, 5], 0.2)):
        with pytest.raises(ValueError):
            rv.ball_position(camera, outline, diameter)


def test_ball_is_chosen_among_regions():
    small = SimpleNamespace(center=(200, 80), area=300.0, roundness=0.9)
    large = SimpleNamespace(center=(90, 300), area=500.0, roundness=0.8)
    line = SimpleNamespace(center=(50, 50), area=900.0, roundness=0.4)
    regions = [line, large, small]
    assert rv.choose_ball(regions) is large
    assert rv.choose_ball(regions, min_roundness=0.3) is line
    assert rv.choose_ball(regions, expected=(190.0, 90.0)) is small
    assert rv.choose_ball([line]) is None
    assert rv.choose_ball([]) is None
