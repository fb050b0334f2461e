"""Keypoints that are followed: against cv2, the scene's truth, and with something in the way."""

import cv2
import numpy as np
import pytest
import skimage.data

import robot_vision as rv

PORTRAIT = cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR)
PHOTOGRAPH = cv2.resize(cv2.cvtColor(PORTRAIT, cv2.COLOR_BGR2GRAY), (480, 480))
SHAPE = (300, 400)  # height, width of a view
END = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 15, 0.02)
EACH = ["harris", "shi_tomasi", "fast", "orb", "akaze", "mser"]


def filled(made, **values):
    for name, value in values.items():
        assert hasattr(made, name)
        setattr(made, name, value)
    return made


def following(detector="shi_tomasi", **values):
    keypoints = filled(rv.KeypointParams(), detector=detector, max_features=500)
    matching = filled(rv.MatchParams(), match="last_frame", matcher="flow", **values)
    return rv.KeypointMatcher(keypoints, matching)


def view(x=0, y=0):
    """Of the photograph, from a place; its points are then as far to the left and up."""
    return PHOTOGRAPH[y : y + SHAPE[0], x : x + SHAPE[1]]


def followed(first, second, encoding="mono8", **values):
    """The matches of the second frame."""
    matcher = following(**values)
    assert not len(matcher.update(first, encoding).matches)
    return matcher.update(second, encoding).matches


def errors(found, homography):
    there = cv2.perspectiveTransform(found.reference_points[None], np.float64(homography))[0]
    return np.linalg.norm(there - found.points, axis=1)


def shift(x, y):
    return [[1, 0, x], [0, 1, y], [0, 0, 1]]


@pytest.mark.parametrize(
    "values, window, levels, worst",
    [
        ({}, 15, 3, 1.0),
        ({"flow_window": 31}, 31, 3, 1.0),
        ({"flow_levels": 1}, 15, 1, 1.0),
        ({"flow_max_error": 0.1}, 15, 3, 0.1),
    ],
)
def test_points_are_followed_as_cv2_does_it_there_and_back(values, window, levels, worst):
    first, second = view(), cv2.GaussianBlur(view(9, 5), (0, 0), 1.5)
    points = filled(rv.KeypointParams(), detector="shi_tomasi", max_features=500)
    points = rv.find_keypoints(first, "mono8", points).points.copy()
    options = {"winSize": (window, window), "maxLevel": levels, "criteria": END}
    options["flags"] = cv2.OPTFLOW_USE_INITIAL_FLOW
    there, seen, _ = cv2.calcOpticalFlowPyrLK(first, second, points, points.copy(), **options)
    back, again, _ = cv2.calcOpticalFlowPyrLK(second, first, there, points.copy(), **options)
    miss = np.linalg.norm(back - points, axis=1)
    inside = ((there >= 0) & (there <= np.array(SHAPE[::-1]) - 1)).all(axis=1)
    kept = (seen[:, 0] & again[:, 0]).astype(bool) & (miss <= worst) & inside
    found = followed(first, second, **values)
    assert 50 < kept.sum() < len(points) and len(found) == kept.sum()
    order = np.argsort(miss[kept], kind="stable")
    assert np.allclose(found.distances, miss[kept][order], atol=1e-4)
    expected = np.hstack([points, there])[kept]
    rows = np.hstack([found.reference_points, found.points])
    assert np.allclose(sorted(map(tuple, rows)), sorted(map(tuple, expected)), atol=1e-3)


@pytest.mark.parametrize("detector", EACH)
def test_points_of_every_detector_are_followed_to_a_fraction_of_a_pixel(detector):
    found = followed(view(), view(9, 5), detector=detector)
    assert len(found) > 20 and np.quantile(errors(found, shift(-9, -5)), 0.9) < 0.2
    assert found.inliers.mean() > 0.9
    assert found.pose.center == pytest.approx((199.5 - 9, 149.5 - 5), abs=0.1)
    assert 0.0 <= min(found.distances) <= max(found.distances) <= 1.0


def object_of(scene, name, frame):
    return next(one for one in scene.truth(frame).objects if one.name == name)


def inside(outline, points, margin=10.0):
    """Which points are in an outline, so far from it that nothing else is in their window."""
    outline = np.float32(outline)
    tests = (cv2.pointPolygonTest(outline, point, True) for point in points.tolist())
    return np.array([distance > margin for distance in tests])


@pytest.mark.parametrize("first, second", [(200, 260), (480, 540)])
def test_points_of_the_scene_s_poster_move_as_its_truth_says(first, second):
    scene = rv.Scene(rv.SceneParams(), PORTRAIT)
    outlines = [object_of(scene, "poster", frame).outline for frame in (first, second)]
    found = followed(scene.render(first), scene.render(second), "bgr8")
    truth = cv2.getPerspectiveTransform(*(np.float32(outline) for outline in outlines))
    on_poster = inside(outlines[0], found.reference_points)
    moved = np.linalg.norm(found.points - found.reference_points, axis=1)
    assert on_poster.sum() > 80 and moved[on_poster].min() > 5.0
    assert errors(found, truth)[on_poster].max() < 0.8
    assert np.median(errors(found, truth)[on_poster]) < 0.2


def test_what_comes_in_front_of_a_point_is_no_match():
    scene = rv.Scene(rv.SceneParams(), PORTRAIT)
    poster, later = (object_of(scene, "poster", frame) for frame in (0, 60))
    truth = cv2.getPerspectiveTransform(np.float32(poster.outline), np.float32(later.outline))
    matcher = following()
    points = matcher.update(scene.render(0)).keypoints.points
    points = points[inside(poster.outline, points)]
    there = cv2.perspectiveTransform(points[None], truth)[0]
    ball = object_of(scene, "ball", 60).outline
    covered, near = (inside(ball, there, margin) for margin in (2.0, -15.0))
    found = matcher.update(scene.render(60)).matches
    known = set(map(tuple, found.reference_points.tolist()))
    matched = np.array([tuple(point) in known for point in points.tolist()])
    assert covered.sum() >= 3 and not matched[covered].any()
    assert (~near).sum() > 50 and matched[~near].mean() > 0.95
    assert errors(found, truth)[inside(poster.outline, found.reference_points)].max() < 5.0


def test_points_that_are_covered_or_leave_the_image_are_no_matches():
    second = view(9, 5).copy()
    second[100:200, 100:250] = 128
    found = followed(view(), second)
    x, y = (found.reference_points - (9, 5)).T  # where they would be
    assert not ((x > 110) & (x < 240) & (y > 110) & (y < 190)).any()
    assert found.points.min() >= 0.0 and (found.points <= (399, 299)).all()
    assert (found.reference_points < (9, 5)).any(axis=1).sum() == 0
    assert len(found) > 50 and np.quantile(errors(found, shift(-9, -5)), 0.9) < 0.3


def test_far_motion_needs_halvings():
    def right(**values):
        return (errors(followed(view(), view(21, 14), **values), shift(-21, -14)) < 0.5).sum()

    assert right(flow_levels=3) > 100 > 2 * right(flow_levels=0)


def test_there_is_nothing_to_follow_at_first_after_a_reset_and_in_another_size():
    matcher = following()
    assert not len(matcher.update(view(), "mono8").matches)
    assert len(matcher.update(view(2, 1), "mono8").matches) > 50
    smaller = view()[:280]
    assert not len(matcher.update(smaller, "mono8").matches)
    assert len(matcher.update(smaller, "mono8").matches) > 50
    assert not len(matcher.update(smaller, "mono8", matches=False).matches)
    assert not len(matcher.update(smaller, "mono8").matches)  # its last frame is long ago
    assert len(matcher.update(smaller, "mono8").matches) > 50
    matcher.reset()
    assert not len(matcher.update(smaller, "mono8").matches)


@pytest.mark.parametrize("detector", ["orb", "shi_tomasi"])
def test_keypoints_that_are_followed_are_not_described(detector):
    matcher = following(detector)
    for _ in range(2):
        frame = matcher.update(view(), "mono8")
        assert len(frame.keypoints) > 50 and not len(frame.keypoints.descriptors)
    assert len(frame.matches) > 50


@pytest.mark.parametrize("shape", [(16, 16), (17, 203), (1, 90)])
def test_small_images_and_large_windows_are_taken(shape):
    image = cv2.resize(PHOTOGRAPH, shape[::-1])
    for window, levels in ((5, 0), (51, 6)):
        found = followed(image, image, flow_window=window, flow_levels=levels)
        assert len(found) == 0 or errors(found, np.eye(3)).max() < 0.1


def test_frames_are_not_changed_and_may_be_freed():
    matcher = following()
    first, second = view().copy(), view(3, 2).copy()
    expected = followed(view(), view(3, 2)).points
    matcher.update(first, "mono8")
    assert np.array_equal(first, view())
    first[:] = 0  # what the matcher keeps is its own
    assert np.array_equal(matcher.update(second, "mono8").matches.points, expected)
    assert np.array_equal(second, view(3, 2))


def test_flow_is_refused_where_there_is_no_last_frame():
    text = "matcher is flow, must be brute_force or flann if match is reference"
    with pytest.raises(ValueError, match=text):
        rv.validate(filled(rv.MatchParams(), match="reference", matcher="flow"))
    described = rv.find_keypoints(PHOTOGRAPH, "mono8", describe=True)
    with pytest.raises(
        ValueError, match="matcher is flow, must be brute_force or flann to compare"
    ):
        rv.match_keypoints(described, described, filled(rv.MatchParams(), matcher="flow"))


@pytest.mark.parametrize(
    "values, text",
    [
        ({"flow_window": 14}, "flow_window is 14, must be odd and from 5 to 51"),
        ({"flow_levels": 7}, "flow_levels is 7, must be from 0 to 6"),
        ({"flow_max_error": 0.0}, "flow_max_error is 0, must be from 0.1 to 10"),
    ],
)
def test_bad_parameters_are_refused_in_words(values, text):
    with pytest.raises(ValueError, match=text):
        following(**values)
