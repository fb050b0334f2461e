"""Poses of tags and bundles from noisy corners, against the ground truth."""

import cv2
import numpy as np
import pytest
from tags import (
    CAMERA,
    CAMERAS,
    SIZE,
    SQUARE,
    K,
    bundle_of,
    corners_of,
    error_of,
    faces_camera,
    in_image,
    matrix,
    pose_in_view,
    random_places,
    squared_error,
    turn_of,
    turned,
    visible,
)

import robot_vision as rv

TAG = rv.single_tag(0, SIZE)
FRESH = rv.TagPoseParams()  # for corners whose noise is new in every frame
FRESH.lasting_noise = 0.0
RATE = 30.0  # Hz
FREEDOM = 6  # of a pose


def single_shots(camera, sizes, noises, count, seed, tilts=(0, 15, 30, 45, 60, 75)):
    """Poses of single images: (size in px, truth, TagPoses); tilts are in degrees."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        for size in sizes:
            for tilt in np.radians(tilts):
                truth, noise = pose_in_view(rng, size, tilt), rng.choice(noises)
                corners = corners_of(truth, camera) + rng.normal(0.0, noise, (4, 2))
                found = rv.estimate_pose(TAG, {0: corners}, camera, noise)
                assert found is not None
                yield size, truth, found


@pytest.mark.parametrize("model", CAMERAS)
def test_poses_are_accurate_and_their_covariances_right(model):
    sizes = [10, 20, 40, 60, 100, 200, 400]
    shifts, turns = [], []
    squares = {size: [] for size in sizes}
    for size, truth, found in single_shots(CAMERAS[model], sizes, [0.1, 0.3, 0.5], 40, 1):
        error = error_of(found.best.pose, truth)
        shifts.append(np.linalg.norm(error[:3]) / np.linalg.norm(truth[:3, 3]))
        if size >= 60:
            turns.append(turn_of(error))
        squares[size].append(squared_error(found.best, truth))
    assert np.median(shifts) <= 0.01
    assert np.median(turns) <= 1.0
    for size in sizes:
        assert 0.7 <= np.mean(squares[size]) / FREEDOM <= 1.5, size


def test_the_probability_of_a_pose_is_how_often_it_is_right():
    said, true = [], []
    shots = single_shots(CAMERA, [10, 15, 20, 30], [0.3], 200, 2, (15, 30, 45, 60, 75))
    for _, truth, found in shots:
        if found.other is None or turn_of(error_of(found.best.pose, found.other.pose)) < 20.0:
            continue
        said.append(found.probability)
        errors = [turn_of(error_of(one.pose, truth)) for one in (found.best, found.other)]
        true.append(errors[0] < errors[1])
        assert 0.0 < found.ratio <= 1.0 and found.best.error <= found.other.error
    said, true = np.array(said), np.array(true)
    for low, high in [(0.5, 0.6), (0.6, 0.8), (0.8, 0.95), (0.95, 1.0)]:
        part = (said >= low) & (said < high)
        assert part.sum() > 300
        assert abs(said[part].mean() - true[part].mean()) < 0.06


def test_bundles_are_found_with_right_covariances():
    rng = np.random.default_rng(3)
    squares, shifts, turns = [], [], []
    for trial in range(300):
        places = random_places(rng, trial % 2)
        truth = pose_in_view(rng, rng.choice([40, 120]), rng.uniform(0, 1))
        noise = rng.choice([0.1, 0.5])
        seen = {
            tag: corners + rng.normal(0.0, noise, (4, 2))
            for tag, corners in visible(truth, places, CAMERA, 0.1).items()
        }
        if len(seen) < 2:
            continue
        best = rv.estimate_pose(bundle_of(places, 0.1), seen, CAMERA, noise).best
        error = error_of(best.pose, truth)
        squares.append(squared_error(best, truth))
        shifts.append(np.linalg.norm(error[:3]) / truth[2, 3])
        turns.append(turn_of(error))
    assert len(squares) > 200
    assert 0.7 <= np.mean(squares) / FREEDOM <= 1.5
    assert np.median(shifts) <= 0.002 and np.median(turns) <= 0.5 and np.max(turns) < 15.0


def still(pose):
    while True:
        yield pose


def wandering(rng, pose, speed, rate):
    """Poses of a smooth motion with root mean square `speed` (m/s) and `rate` (rad/s)."""
    frequencies, phases = rng.uniform(0.2, 0.6, (2, 6)), rng.uniform(0, 2 * np.pi, (2, 6))
    reach = np.array([speed] * 3 + [rate] * 3) / np.sqrt(3) / (2 * np.pi * frequencies)
    frame = 0
    while True:
        angles = 2 * np.pi * frequencies * frame / RATE + phases
        way = np.sum(reach * (np.sin(angles) - np.sin(phases)), axis=0)
        yield matrix(turned(way[3:]) @ pose[:3, :3], pose[:3, 3] + way[:3])
        frame += 1


def track(tracker, camera, path, noise, rng, frames, lasting=0.0):
    """The results of a tracker: (frame, noisy corners, truth, TagPoses)."""
    shift = rng.normal(0.0, lasting, (4, 2))
    for frame, truth in zip(range(frames), path):
        corners = corners_of(truth, camera)
        if not in_image(corners, camera) or not faces_camera(truth):
            continue
        corners = corners + shift + rng.normal(0.0, noise, (4, 2))
        yield frame, corners, truth, tracker.update(frame / RATE, {0: corners}, camera)


@pytest.mark.parametrize("model", CAMERAS)
def test_a_tag_at_rest_jitters_half_as_much_as_one_shot_poses_or_less(model):
    rng = np.random.default_rng(4)
    camera = CAMERAS[model]
    gains, squares = [], []
    for noise in (0.1, 0.5):
        for size in (30, 60, 150, 300):
            for tilt in np.radians([10, 45, 70]):
                tracker = rv.TagPoseTracker(TAG, FRESH)
                ours, theirs = [], []
                path = still(pose_in_view(rng, size, tilt))
                for frame, corners, truth, found in track(tracker, camera, path, noise, rng, 150):
                    if frame < 30:
                        continue
                    squares.append(squared_error(found.best, truth))
                    ours.append(error_of(found.best.pose, truth))
                    if model == "equidistant":
                        single = rv.estimate_pose(TAG, {0: corners}, camera).best.pose
                    else:
                        _, turn, place = cv2.solvePnP(SIZE * SQUARE, corners, K, np.array(camera.D))
                        single = matrix(turned(turn), place[:, 0])
                    theirs.append(error_of(single, truth))
                gains.append(np.std(theirs, axis=0) / np.std(ours, axis=0))
                assert tracker.corner_noise == pytest.approx(noise, rel=0.3)
    assert np.median(gains) > 3.0
    assert np.percentile(gains, 2) > 2.0
    assert 0.7 <= np.mean(squares) / FREEDOM <= 1.5


@pytest.mark.parametrize("speed, rate", [(0.02, 0.05), (0.1, 0.2), (0.5, 1.0)])
def test_covariances_of_a_moving_tag_are_right(speed, rate):
    rng = np.random.default_rng(5)
    squares, ours, theirs, flips = [], [], [], []
    for noise in (0.1, 0.3):
        for size in (40, 80, 160):
            for tilt in np.radians([10, 30, 50]):
                path = wandering(rng, pose_in_view(rng, size, tilt), speed, rate)
                tracker = rv.TagPoseTracker(TAG, FRESH)
                for frame, corners, truth, found in track(tracker, CAMERA, path, noise, rng, 200):
                    error = error_of(found.best.pose, truth)
                    flips.append(is_flipped(found, truth))
                    if frame < 30:
                        continue
                    squares.append(squared_error(found.best, truth))
                    single = rv.estimate_pose(TAG, {0: corners}, CAMERA).best.pose
                    ours.append(np.linalg.norm(error[:3]) / truth[2, 3])
                    theirs.append(np.linalg.norm(error_of(single, truth)[:3]) / truth[2, 3])
    assert 0.7 <= np.mean(squares) / FREEDOM <= 1.5
    assert np.mean(ours) < 1.02 * np.mean(theirs)  # no lag
    assert np.percentile(ours, 99) < 1.02 * np.percentile(theirs, 99)
    assert np.mean(flips) < 0.005


def is_flipped(found, truth):
    """True if the other pose is the right one and the two differ noticeably."""
    if found.other is None or turn_of(error_of(found.best.pose, found.other.pose)) < 15.0:
        return False
    return turn_of(error_of(found.other.pose, truth)) < turn_of(error_of(found.best.pose, truth))


@pytest.mark.parametrize("passed", [1 / RATE, 1e-4, 0.0])
def test_a_tag_that_jumps_is_followed_in_the_same_frame(passed):
    rng = np.random.default_rng(6)
    tracker = rv.TagPoseTracker(TAG, FRESH)
    for jump in (0.01, 0.1, 0.3):
        here = pose_in_view(rng, 100, 0.6)
        there = here.copy()
        there[0, 3] += jump - 2 * jump * (here[0, 3] > 0)
        list(track(tracker, CAMERA, still(here), 0.1, rng, 60))
        corners = corners_of(there, CAMERA) + rng.normal(0.0, 0.1, (4, 2))
        found = tracker.update(59 / RATE + passed, {0: corners}, CAMERA)
        errors = error_of(found.best.pose, there)
        assert np.linalg.norm(errors[:2]) < 0.02 * jump + 0.0005
        assert squared_error(found.best, there) < 6 * FREEDOM


def test_time_decides_where_the_image_does_not():
    """A tag comes from where it is well visible; the right pose is kept when it is small."""
    rng = np.random.default_rng(7)
    flips, single_flips = [], []
    for _ in range(20):
        near = pose_in_view(rng, 80, 0.7)
        tracker = rv.TagPoseTracker(TAG, FRESH)
        scales = np.concatenate([np.linspace(1, 5, 120), np.full(120, 5.0)])
        path = (matrix(near[:3, :3], scale * near[:3, 3]) for scale in scales)
        for frame, corners, truth, found in track(tracker, CAMERA, path, 0.2, rng, 240):
            if frame >= 120:
                flips.append(is_flipped(found, truth))
                single_flips.append(is_flipped(rv.estimate_pose(TAG, {0: corners}, CAMERA), truth))
    assert np.mean(single_flips) > 0.2
    assert np.mean(flips) < 0.005


@pytest.mark.parametrize("least", [0.0, 0.05])
def test_lasting_noise_is_not_averaged_out(least):
    rng = np.random.default_rng(8)
    params = rv.TagPoseParams()
    params.lasting_noise = least
    squares = []
    for _ in range(60):
        path = still(pose_in_view(rng, 100, 0.7))
        tracker = rv.TagPoseTracker(TAG, params)
        lasting = 0.05 if least else 0.2
        *_, (_, _, truth, found) = track(tracker, CAMERA, path, 0.02, rng, 150, lasting)
        squares.append(squared_error(found.best, truth))
    if least:
        assert 0.7 <= np.mean(squares) / FREEDOM <= 1.5
    else:  # the noise is estimated from two numbers only, so just the median is right
        assert 0.2 <= np.median(squares) / FREEDOM <= 3.0


def test_a_bundle_is_tracked_while_tags_come_and_go():
    rng = np.random.default_rng(9)
    camera = CAMERAS["equidistant"]
    places = {tag: matrix(np.eye(3), [0.15 * (tag - 1), 0.0, 0.0]) for tag in range(3)}
    bundle = bundle_of(places, 0.1)
    tracker = rv.TagPoseTracker(bundle, FRESH)
    squares, seen_once = [], 0
    path = wandering(rng, pose_in_view(rng, 120, 0.5), 0.1, 0.2)
    for frame, truth in zip(range(400), path):
        seen = {
            tag.id: corners_of(truth @ tag.pose, camera, tag.size) + rng.normal(0.0, 0.2, (4, 2))
            for tag in bundle.tags
            if (frame // 20 + tag.id) % 3
        }
        seen_once += len(seen) == 1
        found = tracker.update(frame / RATE, seen, camera)
        squares.append(squared_error(found.best, truth))
    assert 0.7 <= np.mean(squares) / FREEDOM <= 1.5
    assert tracker.corner_noise == pytest.approx(0.2, rel=0.2)
    assert tracker.update(14.0, {}, camera) is None
    assert tracker.update(14.1, {9: np.zeros((4, 2))}, camera) is None


def test_a_tag_without_a_size_is_refused():
    with pytest.raises(ValueError, match=r"size of tag 1 .* is -1, must be above 0"):
        rv.single_tag(1, -1.0)


def test_arrays_of_other_shapes_are_refused():
    corners = corners_of(pose_in_view(np.random.default_rng(0), 60, 0.5), CAMERA)
    with pytest.raises(ValueError, match="4, 2"):
        rv.estimate_pose(TAG, {0: corners[:3]}, CAMERA)
    with pytest.raises(ValueError, match="4, 2"):
        rv.TagPoseTracker(TAG).update(0.0, {0: corners[:3]}, CAMERA)
    with pytest.raises(ValueError, match="4x4"):
        rv.BundleTag(3, 0.1, np.eye(3))
    with pytest.raises(ValueError, match="8, 8"):
        rv.MeasuredCorners(corners, np.eye(6))
    with pytest.raises(ValueError, match=r"\(n, 3\)"):
        CAMERA.project(corners)


def test_lens_noise_makes_poses_of_single_images_uncertain():
    truth = pose_in_view(np.random.default_rng(0), 100, 0.5)
    seen = {0: rv.MeasuredCorners(corners_of(truth, CAMERA), 1e-4 * np.eye(8))}
    exact, off = (
        rv.estimate_pose(TAG, seen, CAMERA, lens_noise=noise).best.covariance
        for noise in (0.0, 0.06)
    )
    # All corners move alike, so the tag moves across the line of sight like the rays.
    sideways = (0.06 * truth[2, 3] / K[0, 0]) ** 2
    assert off[0, 0] - exact[0, 0] == pytest.approx(sideways, rel=0.1)


@pytest.mark.parametrize("model", CAMERAS)
def test_any_quadrilateral_gives_a_pose_an_error_or_nothing(model):
    rng = np.random.default_rng(10)
    tracker = rv.TagPoseTracker(TAG)
    answers = {True: 0, False: 0, None: 0}
    for frame in range(4000):
        size = 10 ** rng.uniform(-0.5, 2.8) * rng.uniform(0.05, 1, 2)
        bent = SQUARE[:, :2] * [1, -1] + rng.uniform(-0.35, 0.35, (4, 2))
        corners = (
            rng.uniform(-50, 690, 2) + size * bent @ turned([0, 0, rng.uniform(-3, 3)])[:2, :2]
        )
        try:
            found = tracker.update(frame / RATE, {0: corners}, CAMERAS[model])
        except ValueError:
            answers[None] += 1
            continue
        answers[found is not None] += 1
        if found is None:
            continue
        for one in filter(None, (found.best, found.other)):
            assert np.allclose(one.pose[:3, :3] @ one.pose[:3, :3].T, np.eye(3), atol=1e-9)
            assert np.isfinite(one.error) and one.pose[:3, 2] @ one.pose[:3, 3] < 0
            variances = np.linalg.eigvalsh(one.covariance)
            assert variances[-1] > 0 and variances[0] > -1e-9 * variances[-1]
        assert 0.5 <= found.probability <= 1.0 and np.isfinite(found.ratio)
    assert answers[True] > 1000 and answers[None] > 100


@pytest.mark.parametrize("model", CAMERAS)
def test_points_behind_the_camera_have_no_pixels(model):
    points = np.random.default_rng(1).uniform([-1, -1, -3], [1, 1, -2], (50, 3))
    assert np.isnan(CAMERAS[model].project(points)[0]).all()
