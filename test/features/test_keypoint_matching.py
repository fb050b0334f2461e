"""Matches against those of cv2, and references in images that were warped by a known homography."""

import cv2
import numpy as np
import pytest
import skimage.data

import robot_vision as rv

HAS_SIFT = hasattr(cv2, "SIFT_create")
SEED = 0x5EED  # of the core's random numbers for FLANN
PORTRAIT = cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR)
PHOTOGRAPH = cv2.resize(cv2.cvtColor(PORTRAIT, cv2.COLOR_BGR2GRAY), (300, 300))
# Of the photograph's px: smaller, turned by some 15 degrees, and tilted.
TILTED = np.array([[0.8, -0.2, 90.0], [0.15, 0.85, 40.0], [1.5e-4, 3e-4, 1.0]])
BINARY = {"algorithm": 6, "table_number": 6, "key_size": 12, "multi_probe_level": 1}  # LSH
FLOATS = {"algorithm": 1, "trees": 5}  # KD-trees
with_sift = pytest.mark.skipif(not HAS_SIFT, reason="OpenCV has SIFT since 4.4")
SIFT = pytest.param("sift", marks=with_sift)


def filled(made, **values):
    for name, value in values.items():
        assert hasattr(made, name)
        setattr(made, name, value)
    return made


def keypoints(detector="orb", count=1000, **values):
    return filled(rv.KeypointParams(), detector=detector, max_features=count, **values)


def matching(match="none", **values):
    return filled(rv.MatchParams(), match=match, **values)


def texture(seed, shape=(240, 320)):
    """Noise of several sizes: it looks like nothing else."""
    rng = np.random.default_rng(seed)
    image = np.zeros(shape)
    for size in (2, 4, 8, 16):
        coarse = rng.normal(0.0, 1.0, (shape[0] // size + 2, shape[1] // size + 2))
        image += cv2.resize(coarse, shape[::-1], interpolation=cv2.INTER_CUBIC)
    return cv2.normalize(image, None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)


def seen(image, homography, size=(400, 360), seed=0):
    """The image under a homography in front of something else, with the noise of a camera."""
    around = texture(1000 + seed, size[::-1]) // 2 + 60
    cv2.warpPerspective(image, homography, size, around, borderMode=cv2.BORDER_TRANSPARENT)
    noise = np.random.default_rng(seed).normal(0.0, 2.0, around.shape)
    return np.clip(around + noise, 0, 255).astype(np.uint8)


def corners(shape, homography):
    height, width = shape[:2]
    square = np.array([(0, 0), (width, 0), (width, height), (0, height)]) - 0.5
    return cv2.perspectiveTransform(square[None], homography)[0]


def pair(detector):
    """The keypoints of the photograph, and of a view of it."""
    wanted = keypoints(detector)
    views = PHOTOGRAPH, seen(PHOTOGRAPH, TILTED)
    return [rv.find_keypoints(view, "mono8", wanted, describe=True) for view in views]


def rows_of_ours(found):
    return sorted(
        map(tuple, np.column_stack([found.reference_points, found.points, found.distances]))
    )


def rows_of(matches, reference, image):
    return sorted(
        (*reference.described[m.queryIdx], *image.described[m.trainIdx], m.distance)
        for m in matches
    )


def norm_of(detector):
    return cv2.NORM_L2 if detector == "sift" else cv2.NORM_HAMMING


@pytest.mark.parametrize("detector", ["orb", "akaze", SIFT])
@pytest.mark.parametrize("ratio", [0.6, 0.75, 1.0])
def test_brute_force_matches_are_those_of_cv2(detector, ratio):
    reference, image = pair(detector)
    nearest = cv2.BFMatcher(norm_of(detector)).knnMatch(reference.descriptors, image.descriptors, 2)
    expected = [a for a, b in nearest if ratio == 1.0 or a.distance < ratio * b.distance]
    found = rv.match_keypoints(reference, image, matching(ratio=ratio))
    assert len(found) == len(expected) > 30
    assert np.allclose(rows_of_ours(found), rows_of(expected, reference, image))
    assert not found.inliers.any() and found.pose is None
    assert (np.diff(found.distances) >= 0).all()


@pytest.mark.parametrize("detector", ["orb", SIFT])
def test_cross_checked_matches_are_the_nearest_of_each_other(detector):
    reference, image = pair(detector)
    there = cv2.BFMatcher(norm_of(detector)).match(reference.descriptors, image.descriptors)
    matcher = cv2.BFMatcher(norm_of(detector), True)
    checked = matcher.match(reference.descriptors, image.descriptors)
    mutual = {(m.queryIdx, m.trainIdx) for m in checked}
    expected = [m for m in there if (m.queryIdx, m.trainIdx) in mutual]
    found = rv.match_keypoints(reference, image, matching(ratio=1.0, cross_check=True))
    assert 30 < len(found) == len(expected) < len(there)
    assert np.allclose(rows_of_ours(found), rows_of(expected, reference, image))
    strict = rv.match_keypoints(reference, image, matching(cross_check=True))
    plain = rv.match_keypoints(reference, image, matching())
    assert set(rows_of_ours(strict)) == set(rows_of_ours(plain)) & set(rows_of_ours(found))


@pytest.mark.parametrize(
    "detector, index", [("orb", BINARY), pytest.param("sift", FLOATS, marks=with_sift)]
)
def test_flann_s_matches_are_those_of_cv2_and_always_the_same(detector, index):
    reference, image = pair(detector)
    cv2.setRNGSeed(SEED)
    matcher = cv2.FlannBasedMatcher(index, {"checks": 50})
    nearest = matcher.knnMatch(reference.descriptors, image.descriptors, 2)
    expected = [
        two[0] for two in nearest if len(two) == 2 and two[0].distance < 0.75 * two[1].distance
    ]
    for seed in (1, 2, 3):  # of random numbers of others in this thread
        cv2.setRNGSeed(seed)
        found = rv.match_keypoints(reference, image, matching(matcher="flann"))
        assert np.allclose(rows_of_ours(found), rows_of(expected, reference, image))
    exact = rv.match_keypoints(reference, image, matching())
    common = set(rows_of_ours(found)) & set(rows_of_ours(exact))
    assert len(common) > 0.7 * len(exact) > 30


def test_flann_leaves_the_random_numbers_of_others_alone():
    reference, image = pair("orb")
    numbers = []
    for match in (False, True):
        cv2.setRNGSeed(7)
        if match:
            rv.match_keypoints(reference, image, matching(matcher="flann"))
        numbers.append(cv2.randu(np.zeros((3, 3)), 0.0, 1.0))
    assert np.array_equal(*numbers)


def test_descriptors_of_two_kinds_are_refused():
    reference, image = pair("orb")[0], pair("akaze")[1]
    with pytest.raises(ValueError, match="the descriptors' kind"):
        rv.match_keypoints(reference, image)


def test_nothing_matches_what_has_no_descriptors():
    reference, _ = pair("orb")
    nothing = rv.find_keypoints(np.zeros((90, 90), np.uint8), "mono8", describe=True)
    assert len(rv.match_keypoints(reference, nothing)) == 0
    assert len(rv.match_keypoints(nothing, reference)) == 0


def found_in(view, reference=PHOTOGRAPH, detector="akaze", count=1000, **values):
    matcher = rv.KeypointMatcher(keypoints(detector, count), matching("reference", **values))
    matcher.set_reference(reference, "mono8")
    return matcher.update(view, "mono8").matches


@pytest.mark.parametrize(
    "detector, error", [("akaze", 1.0), ("orb", 1.2), pytest.param("sift", 1.0, marks=with_sift)]
)
@pytest.mark.parametrize("homography", ["ransac", "rho", "lmeds"])
def test_a_warped_reference_is_found_where_it_is(detector, error, homography):
    for seed, reference in enumerate((PHOTOGRAPH, texture(5, (300, 300)), PHOTOGRAPH)):
        view = seen(reference, TILTED, seed=seed)
        found = found_in(view, reference, detector, homography=homography)
        assert found.pose, homography
        assert np.abs(found.pose.outline - corners(reference.shape, TILTED)).max() <= error
        middle = cv2.perspectiveTransform(np.array([[(149.5, 149.5)]]), TILTED)[0, 0]
        assert found.pose.center == pytest.approx(middle, abs=error)
        assert found.pose.homography[2, 2] == pytest.approx(1.0)
        there = cv2.perspectiveTransform(found.reference_points[None], found.pose.homography)[0]
        distances = np.linalg.norm(there - found.points, axis=1)
        assert found.inliers.sum() > 30 and distances[found.inliers].max() < 6.0


def test_a_smaller_threshold_has_fewer_inliers():
    view = seen(PHOTOGRAPH, TILTED)
    inliers = [found_in(view, ransac_threshold=value).inliers.sum() for value in (0.3, 1.0, 5.0)]
    assert inliers[0] < inliers[1] < inliers[2]


def test_fewer_inliers_than_wanted_are_none():
    view = seen(PHOTOGRAPH, TILTED)
    found = found_in(view)
    places = min(
        len(np.unique(np.floor(points[found.inliers] / 4.0), axis=0))
        for points in (found.reference_points, found.points)
    )
    assert 30 < places <= found.inliers.sum()  # some may be in the same place
    assert found_in(view, min_inliers=places).pose
    nothing = found_in(view, min_inliers=places + 1)
    assert nothing.pose is None and len(nothing) == len(found) and not nothing.inliers.any()


@pytest.mark.parametrize("detector", ["orb", "fast", "akaze", SIFT])
def test_a_reference_that_is_not_there_is_not_found(detector):
    matcher = rv.KeypointMatcher(keypoints(detector), matching("reference", ratio=0.85))
    matcher.set_reference(PHOTOGRAPH, "mono8")
    others = [
        cv2.resize(image, (320, 240)) for image in (skimage.data.coins(), skimage.data.page())
    ]
    matched = 0
    for view in [*others, *map(texture, range(4))]:
        found = matcher.update(view, "mono8").matches
        assert found.pose is None and not found.inliers.any()
        matched += len(found)
    assert matched > 10


def test_a_mirrored_reference_is_not_found():
    view = seen(PHOTOGRAPH[:, ::-1].copy(), TILTED)
    assert found_in(view).pose is None


def test_a_large_reference_is_found_in_its_own_pixels():
    large = cv2.resize(PHOTOGRAPH, (1800, 1500), interpolation=cv2.INTER_CUBIC)
    shrink = np.diag([1 / 6, 1 / 5, 1.0])
    shrink[:2, 2] = 0.5 * shrink[[0, 1], [0, 1]] - 0.5  # pixels' centres are at whole numbers
    found = found_in(seen(PHOTOGRAPH, TILTED), large, "sift" if HAS_SIFT else "akaze")
    assert np.abs(found.pose.outline - corners(large.shape, TILTED @ shrink)).max() <= 2.0
    assert found.reference_points.max() > 1300
    there = cv2.perspectiveTransform(found.reference_points[None], found.pose.homography)[0]
    assert np.abs(there - found.points)[found.inliers].max() < 6.0


def test_a_reference_without_features_is_refused():
    matcher = rv.KeypointMatcher(keypoints(), matching("reference"))
    text = "the reference's number of described keypoints is 0, must be at least min_inliers, 10"
    with pytest.raises(ValueError, match=text):
        matcher.set_reference(np.full((100, 100), 9, np.uint8), "mono8")
    assert not len(matcher.update(PHOTOGRAPH, "mono8").matches)


@pytest.mark.parametrize("detector", ["harris", "shi_tomasi", "fast", "orb", "akaze", SIFT, "mser"])
def test_matches_with_the_last_frame_are_the_shift(detector):
    matcher = rv.KeypointMatcher(keypoints(detector), matching("last_frame"))
    large = cv2.resize(PHOTOGRAPH, (480, 480))
    assert not len(matcher.update(large[:300, :400], "mono8").matches)  # the first
    found = matcher.update(large[4:304, 7:407], "mono8").matches
    assert found.inliers.mean() > 0.8
    motion = (found.points - found.reference_points)[found.inliers]
    assert np.median(motion, axis=0) == pytest.approx((-7.0, -4.0), abs=0.2)
    assert found.pose.center == pytest.approx((199.5 - 7.0, 149.5 - 4.0), abs=0.3)
    assert not len(matcher.update(large[:280, :400], "mono8").matches)  # another size
    assert len(matcher.update(large[:280, :400], "mono8").matches) > 20
    matcher.reset()
    assert not len(matcher.update(large[:280, :400], "mono8").matches)


def test_without_matches_only_keypoints_are_found():
    matcher = rv.KeypointMatcher(keypoints(), matching("last_frame"))
    for wanted in (True, False, True):
        frame = matcher.update(PHOTOGRAPH, "mono8", matches=wanted)
        assert len(frame.keypoints) > 100 and not len(frame.matches)  # the second one was not kept
        assert bool(frame.keypoints.descriptors.size) == wanted
    plain = rv.KeypointMatcher(keypoints(), matching("none")).update(PHOTOGRAPH, "mono8")
    assert np.array_equal(plain.keypoints.points, frame.keypoints.points) and not len(plain.matches)


@pytest.mark.parametrize(
    "detector, error", [("akaze", 5.0), pytest.param("sift", 3.0, marks=with_sift)]
)
def test_the_scene_s_poster_is_found_by_its_file(detector, error):
    scene = rv.Scene(rv.SceneParams(), PORTRAIT)
    matcher = rv.KeypointMatcher(keypoints(detector, 1500), matching("reference"))
    matcher.set_reference(PORTRAIT)
    for frame in (0, 480):
        poster = next(one for one in scene.truth(frame).objects if one.name == "poster")
        found = matcher.update(scene.render(frame)).matches
        truth = poster.outline[[3, 2, 1, 0]]  # the scene's begins at the bottom left
        assert np.abs(found.pose.outline - truth).max() <= error


@pytest.mark.parametrize(
    "values, text",
    [
        ({"match": "all"}, "match is all, must be none, reference or last_frame"),
        ({"matcher": "best"}, "matcher is best, must be brute_force, flann or flow"),
        ({"ratio": 0.0}, "ratio is 0, must be above 0 and at most 1"),
        ({"homography": "usac"}, "homography is usac, must be ransac, rho or lmeds"),
        ({"ransac_threshold": 0.0}, "ransac_threshold is 0, must be from 0.1 to 50"),
        ({"min_inliers": 3}, "min_inliers is 3, must be from 4 to 1000"),
    ],
)
def test_bad_parameters_are_refused_in_words(values, text):
    with pytest.raises(ValueError, match=text):
        rv.KeypointMatcher(keypoints(), filled(rv.MatchParams(), **values))
