"""From the image to the pose: rendered tags with lens, blur and noise, against the truth."""

import cv2
import numpy as np
import pytest
from tag_views import (
    RAYS,
    badly_calibrated,
    image_of,
    moving,
    rays_of,
    undistorted,
)
from tags import (
    CAMERA,
    CAMERAS,
    SIZE,
    K,
    corners_of,
    error_of,
    in_image,
    pose_in_view,
    squared_error,
    turn_of,
)

import robot_vision as rv
from robot_vision.tags.tag_poses import corners_of as measured

FLIPPED = 20.0  # degrees
CERTAIN = 0.99  # probability
KNOWN = rv.TagPoseParams()  # for a camera that is known exactly
KNOWN.lasting_noise = 0.0
DETECTORS = {}  # by family; they keep its tables, which take a while to build, for others


@pytest.mark.parametrize("model", CAMERAS)
def test_corners_are_found_although_the_lens_bends_the_edges(model):
    """They have errors below 0.1 px, where straight lines meet up to half a pixel beside them."""
    camera = CAMERAS[model]
    rng, worst = np.random.default_rng(5), []
    for pixels in (30, 100, 200):
        for _ in range(5):
            corners = corners_of(pose_in_view(rng, pixels, np.radians(30)), camera)
            meeting = by_lines(corners, camera)
            worst.append(np.abs(rv.without_bent_edges(meeting, camera) - corners).max())
            assert worst[-1] <= 0.1 * np.abs(meeting - corners).max() + 1e-6
    assert max(worst) < 0.01


def test_corners_stay_without_distortion():
    corners = np.array([[100.0, 300.0], [320.5, 290.0], [310.0, 80.25], [120.0, 90.0]])
    camera = rv.CameraModel(640, 480, K)
    assert np.abs(rv.without_bent_edges(corners, camera) - corners).max() < 1e-9


def test_corners_whose_lines_hardly_meet_stay():
    """The lens bends two edges so that they go on in almost one line, and meet far away."""
    corners = [[612.7, 458.0], [595.6, 435.5], [509.8, 322.4], [540.8, 450.6]]
    camera = rv.CameraModel(640, 480, K, [-0.3, 0.1, 0.0, 0.0, 0.0])
    assert rv.without_bent_edges(corners, camera).tolist() == corners


def by_lines(corners, camera):
    """The intersections of lines that are fitted to points of the edges between the corners."""
    rays = undistorted(corners, camera)
    lines = []
    for begin, end in zip(rays, np.roll(rays, -1, axis=0)):
        samples = max(16, int(K[0, 0] * np.linalg.norm(end - begin) / 8))  # about as libapriltag
        part = np.linspace(0.0, 1.0, samples + 2)[1:-1, None]
        points = np.column_stack([begin + part * (end - begin), np.ones(samples)])
        vx, vy, x, y = cv2.fitLine(
            camera.project(points)[0].astype(np.float32), cv2.DIST_L2, 0, 1e-6, 1e-6
        ).ravel()
        lines.append(np.array([vy, -vx, vx * y - vy * x]))
    meeting = [np.cross(a, b) for a, b in zip(np.roll(lines, 1, axis=0), lines)]
    return np.array([point[:2] / point[2] for point in meeting])


def located(
    rng, pixels, blur, noise, frames, runs=1, camera=CAMERA, params=None, family="tag36h11"
):
    """The poses found of moving tags: (index of the frame, truth, TagPoses).

    Args:
        camera: the calibrated camera, which may differ from the real one.
    """
    settings = rv.TagDetectorParams()
    settings.families = [family]
    if family not in DETECTORS:
        DETECTORS[family] = rv.TagDetector(settings)
    for _ in range(runs):
        detector = rv.TagDetector(settings)
        tracker = rv.TagPoseTracker(rv.single_tag(3, SIZE), params or rv.TagPoseParams())
        for frame, truth in enumerate(moving(rng, pixels, frames)):
            image = image_of(truth, CAMERA, RAYS, 3, rng, blur, noise, family)
            for tag in detector.update(frame / 30.0, image, "mono8"):
                seen = {3: measured(tag, camera, image)}
                yield frame, truth, tracker.update(frame / 30.0, seen, camera)


@pytest.mark.parametrize("model", ["plumb_bob", "equidistant"])
def test_poses_of_single_images(model):
    """They are tested from 10 px on, where a cell has 1.2 px and some tags are still found."""
    camera = CAMERAS[model]
    rays, rng, detector = rays_of(camera), np.random.default_rng(7), rv.TagDetector()
    places, turns, missed = [], [], []
    for pixels in (10, 12, 16, 20, 30, 60, 80, 120, 200, 400):
        for tilt in np.radians((0, 15, 30, 45, 60, 75)):
            pose = pose_in_view(rng, pixels, tilt)
            corners = corners_of(pose, camera)
            if not in_image(corners, camera):
                continue
            number = int(rng.integers(587))
            image = image_of(pose, camera, rays, number, rng)
            tags = detector.detect(image, "mono8")
            height = cv2.minAreaRect(corners.astype(np.float32))[1]
            if not tags:
                missed.append(min(height))
                continue
            (tag,) = tags
            assert tag.id == number
            seen = {number: measured(tag, camera, image)}
            found = rv.estimate_pose(rv.single_tag(number, SIZE), seen, camera)
            error = error_of(found.best.pose, pose)
            places.append(np.linalg.norm(error[:3]) / np.linalg.norm(pose[:3, 3]))
            turns.append(turn_of(error))
    assert len(places) > 30
    assert max(missed, default=0.0) < 16.0, missed  # px, the shorter side of missed tags
    assert np.median(places) < 0.001, np.percentile(places, (50, 90, 100))
    assert np.median(turns) < 0.3, np.percentile(turns, (50, 90, 100))


def test_covariances_are_right_from_the_first_image_on():
    """They are about right in each class of images, and as promised over all of them."""
    rng = np.random.default_rng(8)
    classes, first = {}, []
    for blur in (0.3, 0.6, 1.0):
        for noise in (2.0, 8.0):
            squares = classes[blur, noise] = []
            for pixels in (20, 30, 60, 90):
                for frame, truth, found in located(rng, pixels, blur, noise, 3, 4, params=KNOWN):
                    squares.append(squared_error(found.best, truth) / 6.0)
                    if frame == 0:
                        first.append(squares[-1])
    assert min(map(len, classes.values())) > 30
    means = {name: np.mean(squares) for name, squares in classes.items()}
    assert 0.7 < np.mean(list(means.values())) < 1.5, means
    assert all(0.5 < mean < 1.8 for mean in means.values()), means
    assert 0.7 < np.mean(first) < 1.5


def test_covariances_are_right_by_default():
    """They are for an exact calibration and for one with an error of 0.1 px."""
    rng = np.random.default_rng(11)
    for error, runs, frames in ((0.0, 4, 6), (0.1, 20, 2)):
        means = {}
        for pixels in (20, 40, 90, 160):
            squares = []
            for _ in range(runs):
                camera = badly_calibrated(rng, error) if error else CAMERA
                for _, truth, found in located(rng, pixels, 0.6, 3.0, frames, camera=camera):
                    squares.append(squared_error(found.best, truth) / 6.0)
            assert len(squares) > 15
            means[pixels] = np.mean(squares)
        assert 0.7 < np.mean(list(means.values())) < 1.5, (error, means)
        assert all(0.4 < mean < 1.8 for mean in means.values()), (error, means)


def test_small_moving_tags_do_not_claim_certain_wrong_poses():
    """At 10 and 12 px noise hides which way a tag is tilted until it turns; this must show."""
    rng = np.random.default_rng(9)
    said, wrong = [], []
    for pixels in (10, 12, 16):
        certain = []
        for family in rv.tag_families():
            for noise in (2.0, 6.0):
                for _, truth, found in located(rng, pixels, 0.6, noise, 40, 3, family=family.name):
                    wrong.append(turn_of(error_of(found.best.pose, truth)) > FLIPPED)
                    said.append(1.0 - found.probability)
                    certain.append(wrong[-1] and found.probability >= CERTAIN)
        assert len(certain) > 500
        assert np.mean(certain) < 0.005, pixels
    assert np.mean(np.array(said) <= 1.0 - CERTAIN) > 0.5
    assert 0.2 < np.mean(wrong) / np.mean(said) < 1.2  # it may be too cautious, but not too certain


@pytest.mark.parametrize("pixels", [16, 20, 30, 60])
def test_tags_in_motion_do_not_flip(pixels):
    rng = np.random.default_rng(9)
    flips, places = [], []
    runs = 6 if pixels < 30 else 2
    for noise in (2.0, 6.0):
        for _, truth, found in located(rng, pixels, 0.6, noise, 40, runs):
            error = error_of(found.best.pose, truth)
            flips.append(turn_of(error) > FLIPPED)
            places.append(np.linalg.norm(error[:3]) / np.linalg.norm(truth[:3, 3]))
    assert len(flips) > 90
    assert np.mean(flips) < 0.005
    assert np.median(places) < 0.003
