"""Poses of bundles when the lens, or the layout, is not known exactly."""

import numpy as np
import pytest
from tag_views import RAYS, badly_calibrated, image_of
from tags import (
    CAMERA,
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
from robot_vision.tags.tag_poses import corners_of as measured

SIDE = 0.1  # m
CORNER_NOISE = 0.02  # px, of measured corners
SHIFT, TURN = 0.0005, 0.005  # m, rad: errors of a layout
FREEDOM = 6  # of a pose


def shaken(rng, pose, shift, turn):
    """A pose with random errors of these standard deviations, m and rad."""
    return matrix(
        turned(rng.normal(0.0, turn, 3)) @ pose[:3, :3], pose[:3, 3] + rng.normal(0.0, shift, 3)
    )


def mean_square(rng, off=0.0, lens_noise=0.0, shift=0.0, turn=0.0, stated=None, track=False):
    """The mean squared error divided by the covariance: 1 if the covariances are right.

    Args:
        off: the error of the calibration, px.
        shift, turn: the errors of the layout, m and rad.
        stated: the errors that the layout states; None: the true ones.
    """
    stated = (shift, turn) if stated is None else stated
    params = rv.TagPoseParams()
    params.lasting_noise = lens_noise
    squares = []
    for trial in range(250):
        camera = badly_calibrated(rng, off) if off else CAMERA
        places = random_places(rng, trial % 2)
        real = {tag: shaken(rng, place, shift, turn) for tag, place in places.items()}
        bundle = bundle_of(places, SIDE, *stated)
        body = pose_in_view(rng, rng.choice([60, 120]), rng.uniform(0, 1))
        seen = {
            tag: rv.MeasuredCorners(
                corners + rng.normal(0.0, CORNER_NOISE, (4, 2)), CORNER_NOISE**2 * np.eye(8)
            )
            for tag, corners in visible(body, real, CAMERA, SIDE).items()
        }
        if len(seen) < 2:
            continue
        if track:
            found = rv.TagPoseTracker(bundle, params).update(0.0, seen, camera)
        else:
            found = rv.estimate_pose(bundle, seen, camera, lens_noise=lens_noise)
        squares.append(squared_error(found.best, body) / FREEDOM)
    assert len(squares) > 200
    return np.mean(squares)


@pytest.mark.parametrize("track", [False, True], ids=["image", "tracker"])
@pytest.mark.parametrize("off", [0.1, 0.2, 0.3])
def test_tags_share_the_error_of_the_lens(off, track):
    """off is the root mean square distance (px), sqrt(2) times that of each coordinate."""
    rng = np.random.default_rng(21)
    assert 0.7 < mean_square(rng, off, off / np.sqrt(2), track=track) < 1.5


@pytest.mark.parametrize("off", [0.0, 0.1])
@pytest.mark.parametrize("track", [False, True], ids=["image", "tracker"])
def test_a_layout_is_trusted_as_its_noise_says(off, track):
    rng = np.random.default_rng(23)
    lens = off / np.sqrt(2)
    assert 0.7 < mean_square(rng, off, lens, SHIFT, TURN, track=track) < 1.5
    assert mean_square(rng, off, lens, SHIFT, TURN, stated=(0.0, 0.0), track=track) > 3.0


def test_an_image_of_a_bundle():
    """All steps with default parameters, for a layout with the errors that files assume."""
    rng = np.random.default_rng(24)
    wall = [  # far enough apart not to overlap in the rendered images
        matrix(turned([0.0, angle, 0.0]), [x, y, 0.0])
        for x, angle in ((-0.2, -0.4), (0.2, 0.4))
        for y in (-0.15, 0.15)
    ]
    bundle = bundle_of(dict(enumerate(wall)), SIDE, SHIFT, TURN)
    detector = rv.TagDetector()
    squares, places, turns = {0.0: [], 0.1: []}, [], []
    for trial in range(100):
        off = 0.1 * (trial % 2)
        camera = badly_calibrated(rng, off) if off else CAMERA
        body = pose_in_view(rng, rng.choice([100, 160]), rng.uniform(0.0, 0.8))
        image = np.full((480, 640), 140, np.uint8)
        for number, place in enumerate(wall):
            pose = body @ shaken(rng, place, SHIFT, TURN)
            if faces_camera(pose) and in_image(corners_of(pose, CAMERA, 1.4 * SIDE), CAMERA):
                image_of(pose, CAMERA, RAYS, number, rng, size=SIDE, onto=image)
        seen = {tag.id: measured(tag, camera, image) for tag in detector.detect(image, "mono8")}
        if len(seen) < 2:
            continue
        assert any(isinstance(corners, rv.MeasuredCorners) for corners in seen.values())
        best = rv.TagPoseTracker(bundle).update(0.0, seen, camera).best
        error = error_of(best.pose, body)
        squares[off].append(squared_error(best, body) / FREEDOM)
        places.append(np.linalg.norm(error[:3]) / body[2, 3])
        turns.append(turn_of(error))
    assert min(map(len, squares.values())) > 20
    for off, values in squares.items():
        assert 0.7 < np.mean(values) < 1.5, off
    assert np.median(places) < 0.002 and np.median(turns) < 0.5
