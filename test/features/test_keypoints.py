"""Keypoints against those of cv2, and against what was drawn."""

import cv2
import numpy as np
import pytest
import skimage.data

import robot_vision as rv

HAS_SIFT = hasattr(cv2, "SIFT_create")
PHOTOGRAPH = cv2.resize(cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2GRAY), (240, 240))
DETECTORS = ["harris", "shi_tomasi", "fast", "orb", "sift", "akaze", "mser", "blobs"]
with_sift = pytest.mark.skipif(not HAS_SIFT, reason="OpenCV has SIFT since 4.4")
EACH = [pytest.param(name, marks=with_sift if name == "sift" else ()) for name in DETECTORS]


def spots():
    """Dark and light spots of many sizes and shapes, some with a notch, some close together."""
    image = np.full((300, 400), 128, np.uint8)
    rng = np.random.default_rng(4)
    for number, (x, y) in enumerate((x, y) for x in range(25, 400, 50) for y in range(25, 300, 50)):
        level = int(rng.choice([10, 60, 95, 160, 200, 245]))
        axes = (
            tuple(int(side) for side in rng.integers(4, 21, 2))
            if number % 2
            else (9 + x // 50,) * 2
        )
        cv2.ellipse(image, (x, y), axes, int(rng.integers(180)), 0, 360, level, -1)
        if number % 3 == 0:
            cv2.circle(image, (x + axes[0], y), axes[0] // 2, 128, -1)
    return cv2.GaussianBlur(image, (0, 0), 1.0)


SPOTS = spots()


def params(detector, **values):
    made = rv.KeypointParams()
    made.detector = detector
    for name, value in {"max_features": 5000, **values}.items():
        assert hasattr(made, name)
        setattr(made, name, value)
    return made


def rows_of_ours(found):
    """x, y, size, angle in degrees, and octave of each keypoint, in an order of their own."""
    degrees = np.where(found.angles < 0, -1.0, np.rad2deg(found.angles))
    rows = np.column_stack([found.points, found.sizes, degrees, found.octaves])
    return rows[np.lexsort(rows.T.round(2))]


def rows_of(keypoints, octave=lambda key: key.octave):
    rows = np.array([(*key.pt, key.size, key.angle, octave(key)) for key in keypoints])
    return rows[np.lexsort(rows.reshape(-1, 5).T.round(2))] if len(rows) else rows.reshape(0, 5)


def octave_of_sift(key):
    return np.uint8(key.octave & 255).view(np.int8)


def blobs(**changed):
    """cv2's detector of blobs; its defaults are ours."""
    made = cv2.SimpleBlobDetector_Params()
    for name, value in changed.items():
        assert hasattr(made, name)
        setattr(made, name, value)
    return cv2.SimpleBlobDetector_create(made)


def orb(**changed):
    return cv2.ORB_create(5000, **changed)


def sift(**changed):
    return cv2.SIFT_create(5000, **changed)


FAST, ORB = cv2.FastFeatureDetector_create, cv2.ORB_create
TYPES = {name: getattr(cv2, f"FastFeatureDetector_TYPE_{name}") for name in ("5_8", "7_12")}
# The detector, what is set of ours, what makes the same of cv2.
CASES = [
    ("fast", {"fast_threshold": 40}, lambda: FAST(40)),
    ("fast", {"fast_nonmax": False, "fast_threshold": 40}, lambda: FAST(40, False)),
    ("fast", {"fast_type": "type_5_8"}, lambda: FAST(10, True, TYPES["5_8"])),
    ("fast", {"fast_type": "type_7_12"}, lambda: FAST(10, True, TYPES["7_12"])),
    ("orb", {"orb_scale_factor": 1.5}, lambda: orb(scaleFactor=1.5)),
    ("orb", {"orb_levels": 3}, lambda: orb(nlevels=3)),
    ("orb", {"orb_patch_size": 21}, lambda: orb(edgeThreshold=21, patchSize=21)),
    ("orb", {"orb_fast_threshold": 40}, lambda: orb(fastThreshold=40)),
    ("orb", {"orb_score": "fast", "max_features": 300}, lambda: ORB(300, scoreType=1)),
    ("sift", {"sift_octave_layers": 5}, lambda: sift(nOctaveLayers=5)),
    ("sift", {"sift_contrast_threshold": 0.08}, lambda: sift(contrastThreshold=0.08)),
    ("sift", {"sift_edge_threshold": 4.0}, lambda: sift(edgeThreshold=4.0)),
    ("sift", {"sift_sigma": 2.0}, lambda: sift(sigma=2.0)),
    ("akaze", {"akaze_threshold": 0.004}, lambda: cv2.AKAZE_create(threshold=0.004)),
    ("akaze", {"akaze_octaves": 1}, lambda: cv2.AKAZE_create(nOctaves=1)),
    ("akaze", {"akaze_octave_layers": 2}, lambda: cv2.AKAZE_create(nOctaveLayers=2)),
    ("mser", {"mser_delta": 10}, lambda: cv2.MSER_create(10)),
    ("mser", {"mser_min_area": 200}, lambda: cv2.MSER_create(5, 200)),
    ("mser", {"mser_max_area": 1000}, lambda: cv2.MSER_create(5, 60, 1000)),
    ("mser", {"mser_max_variation": 0.1}, lambda: cv2.MSER_create(5, 60, 14400, 0.1)),
    ("blobs", {"blob_color": "light"}, lambda: blobs(blobColor=255)),
    ("blobs", {"blob_color": "any"}, lambda: blobs(filterByColor=False)),
    ("blobs", {"blob_min_threshold": 100.0}, lambda: blobs(minThreshold=100.0)),
    ("blobs", {"blob_max_threshold": 90.0}, lambda: blobs(maxThreshold=90.0)),
    ("blobs", {"blob_threshold_step": 25.0}, lambda: blobs(thresholdStep=25.0)),
    ("blobs", {"blob_min_repeatability": 5}, lambda: blobs(minRepeatability=5)),
    ("blobs", {"blob_min_distance": 60.0}, lambda: blobs(minDistBetweenBlobs=60.0)),
    ("blobs", {"blob_min_area": 150.0}, lambda: blobs(minArea=150.0)),
    ("blobs", {"blob_max_area": 150.0}, lambda: blobs(maxArea=150.0)),
    (
        "blobs",
        {"blob_min_circularity": 0.85},
        lambda: blobs(filterByCircularity=True, minCircularity=0.85),
    ),
    ("blobs", {"blob_min_convexity": 0.0}, lambda: blobs(filterByConvexity=False)),
    ("blobs", {"blob_min_convexity": 0.8}, lambda: blobs(minConvexity=0.8)),
    ("blobs", {"blob_min_inertia": 0.0}, lambda: blobs(filterByInertia=False)),
    ("blobs", {"blob_min_inertia": 0.5}, lambda: blobs(minInertiaRatio=0.5)),
]
DEFAULTS = {
    "fast": FAST,
    "orb": orb,
    "sift": sift,
    "akaze": cv2.AKAZE_create,
    "mser": cv2.MSER_create,
    "blobs": blobs,
}


def image_for(detector):
    return SPOTS if detector == "blobs" else PHOTOGRAPH


def assert_same(detector, values, theirs):
    ours = rv.find_keypoints(image_for(detector), "mono8", params(detector, **values))
    keypoints = theirs.detect(image_for(detector), None)
    octave = octave_of_sift if detector == "sift" else lambda key: key.octave
    expected = rows_of(keypoints, octave)
    assert len(ours) == len(expected) > 0
    assert np.allclose(rows_of_ours(ours), expected, atol=1e-3)
    assert np.allclose(ours.responses, sorted((key.response for key in keypoints), reverse=True))
    return ours


@pytest.mark.parametrize("detector", DEFAULTS)
def test_keypoints_are_those_of_opencv(detector):
    if detector == "sift" and not HAS_SIFT:
        pytest.skip("OpenCV has SIFT since 4.4")
    assert_same(detector, {}, DEFAULTS[detector]())


@pytest.mark.parametrize("detector, values, theirs", CASES, ids=lambda part: str(part)[:40])
def test_each_parameter_does_what_it_does_in_opencv(detector, values, theirs):
    if detector == "sift" and not HAS_SIFT:
        pytest.skip("OpenCV has SIFT since 4.4")
    changed = assert_same(detector, values, theirs())
    image = image_for(detector)
    others = dict(list(values.items())[1:])
    plain = rv.find_keypoints(image, "mono8", params(detector, **others))
    assert len(changed) != len(plain) or not np.array_equal(changed.points, plain.points)


@pytest.mark.parametrize("detector", ["harris", "shi_tomasi"])
@pytest.mark.parametrize(
    "values, theirs",
    [
        ({}, {}),
        ({"corner_quality": 0.1}, {"qualityLevel": 0.1}),
        ({"corner_min_distance": 3.0}, {"minDistance": 3.0}),
        ({"corner_block_size": 7}, {"blockSize": 7}),
        ({"corner_harris_k": 0.15}, {"k": 0.15}),
    ],
)
def test_corners_are_those_of_opencv_with_its_response(detector, values, theirs):
    harris = detector == "harris"
    options = {"maxCorners": 5000, "qualityLevel": 0.01, "minDistance": 10, "blockSize": 3}
    options.update({"useHarrisDetector": harris, "k": 0.04, **theirs})
    expected = cv2.goodFeaturesToTrack(PHOTOGRAPH, **options)[:, 0]
    found = rv.find_keypoints(PHOTOGRAPH, "mono8", params(detector, **values))
    assert sorted(map(tuple, found.points)) == sorted(map(tuple, expected))
    block = options["blockSize"]
    strength = (
        cv2.cornerHarris(PHOTOGRAPH, block, 3, options["k"])
        if harris
        else cv2.cornerMinEigenVal(PHOTOGRAPH, block, ksize=3)
    )
    x, y = found.points.astype(int).T
    assert np.allclose(found.responses, strength[y, x], rtol=1e-4)
    assert (found.sizes == block).all() and (found.angles == -1).all()
    if values and (harris or "corner_harris_k" not in values):
        plain = rv.find_keypoints(PHOTOGRAPH, "mono8", params(detector))
        assert not np.array_equal(found.points, plain.points)


@pytest.mark.parametrize("detector", EACH)
def test_the_strongest_are_kept_and_come_first(detector):
    image = image_for(detector)
    everything = rv.find_keypoints(image, "mono8", params(detector))
    assert (np.diff(everything.responses) <= 0).all()
    if detector in ("mser", "blobs"):
        assert (np.diff(everything.sizes) <= 0).all() and not everything.responses.any()
    if detector == "orb":  # which shares the number among its levels
        assert 0 < len(rv.find_keypoints(image, "mono8", params(detector, max_features=7))) <= 7
        return
    few = rv.find_keypoints(image, "mono8", params(detector, max_features=3))
    assert np.array_equal(few.points, everything.points[:3])


@pytest.mark.parametrize("detector", EACH)
def test_noise_gives_no_more_than_wanted(detector):
    noise = np.random.default_rng(1).integers(0, 256, (240, 320), np.uint8)
    found = rv.find_keypoints(noise, "mono8", params(detector, max_features=100), describe=True)
    assert len(found) <= 100
    assert len(found.described) == len(found.descriptors) <= 100


SQUARE = 24  # px


def checkerboard():
    """A board of 8x6 squares, and its inner corners: between pixels."""
    y, x = np.mgrid[: 8 * SQUARE, : 10 * SQUARE]
    light = ((x // SQUARE + y // SQUARE) % 2).astype(bool)
    inside = (x >= SQUARE) & (x < 9 * SQUARE) & (y >= SQUARE) & (y < 7 * SQUARE)
    image = np.where(inside & light, 40, 220).astype(np.uint8)
    corners = np.mgrid[2:9, 2:7].reshape(2, -1).T * SQUARE - 0.5
    return image, corners


@pytest.mark.parametrize("detector", ["harris", "shi_tomasi"])
@pytest.mark.parametrize("refine, error", [(False, 1.0), (True, 0.1)])
def test_corners_of_a_checkerboard_are_found(detector, refine, error):
    image, corners = checkerboard()
    wanted = params(detector, corner_quality=0.2, corner_refine=refine)
    points = rv.find_keypoints(image, "mono8", wanted).points
    inner = [p for p in points if 36 < p[0] < 204 and 36 < p[1] < 156]
    distances = np.linalg.norm(corners[:, None] - np.array(inner)[None], axis=2)
    assert len(inner) == len(corners)
    assert distances.min(axis=1).max() <= error


@pytest.mark.parametrize("color, ground, level", [("dark", 200, 30), ("light", 30, 200)])
def test_blobs_are_drawn_discs_with_centre_and_size(color, ground, level):
    image = np.full((200, 300), ground, np.uint8)
    discs = [((60.25, 50.5), 12.0), ((150.0, 100.75), 20.0), ((240.5, 150.25), 30.0)]
    for (x, y), radius in discs:
        place = round(x * 16), round(y * 16)
        cv2.circle(image, place, round(radius * 16), level, -1, cv2.LINE_AA, 4)
    found = rv.find_keypoints(image, "mono8", params("blobs", blob_color=color))
    assert len(found) == 3
    for (center, radius), point, size in zip(discs[::-1], found.points, found.sizes):
        assert point == pytest.approx(center, abs=0.3)
        assert size == pytest.approx(2 * radius, abs=2.5)


@pytest.mark.parametrize("detector", ["orb", "akaze", pytest.param("sift", marks=with_sift)])
def test_descriptors_are_the_detector_s_own(detector):
    found = rv.find_keypoints(PHOTOGRAPH, "mono8", params(detector), describe=True)
    keypoints, descriptors = DEFAULTS[detector]().detectAndCompute(PHOTOGRAPH, None)
    assert np.array_equal(found.described, found.points)
    assert found.descriptors.shape == descriptors.shape
    ours = sorted(map(tuple, np.hstack([found.described, found.descriptors])))
    theirs = [(*key.pt, *row) for key, row in zip(keypoints, descriptors)]
    assert np.allclose(ours, sorted(theirs))


@pytest.mark.parametrize("detector", ["harris", "shi_tomasi", "fast", "mser", "blobs"])
def test_other_detectors_have_orb_s_descriptors(detector):
    image = image_for(detector)
    found = rv.find_keypoints(image, "mono8", params(detector), describe=True)
    keypoints = [
        cv2.KeyPoint(float(x), float(y), float(size))
        for (x, y), size in zip(found.points, found.sizes)
    ]
    keypoints, descriptors = cv2.ORB_create().compute(image, keypoints)
    assert np.array_equal(found.described, [key.pt for key in keypoints])
    assert np.array_equal(found.descriptors, descriptors)
    if detector != "blobs":
        assert 0 < len(found.described) < len(found)  # those at the border cannot be described


@pytest.mark.parametrize("detector", EACH)
@pytest.mark.parametrize(
    "shape", [(1, 1), (1, 90), (90, 1), (15, 15), (16, 16), (17, 203), (63, 31)]
)
def test_small_images_of_any_kind_are_taken(detector, shape):
    texture = cv2.resize(PHOTOGRAPH, shape[::-1])
    for image in (texture, np.zeros(shape, np.uint8), np.full(shape, 255, np.uint8)):
        wanted = params(detector, orb_scale_factor=2.0, orb_levels=16, corner_refine=True)
        found = rv.find_keypoints(image, "mono8", wanted, describe=True)
        assert min(shape) >= 16 or not len(found)
        assert np.isfinite(found.points).all() and len(found.descriptors) == len(found.described)


def test_every_encoding_padded_rows_and_an_unchanged_image():
    wanted = params("fast")
    expected = rv.find_keypoints(PHOTOGRAPH, "mono8", wanted).points
    padded = np.hstack([PHOTOGRAPH, np.full_like(PHOTOGRAPH, 7)])
    before = padded.copy()
    points = rv.find_keypoints(padded[:, : PHOTOGRAPH.shape[1]], "mono8", wanted).points
    assert np.array_equal(points, expected) and np.array_equal(padded, before)
    wide = PHOTOGRAPH.astype(np.uint16) * 257
    assert np.array_equal(rv.find_keypoints(wide, "mono16", wanted).points, expected)
    colors = cv2.cvtColor(PHOTOGRAPH, cv2.COLOR_GRAY2BGR)
    assert np.array_equal(rv.find_keypoints(colors, "bgr8", wanted).points, expected)
    with pytest.raises(ValueError, match="mono8"):
        rv.find_keypoints(colors, "mono8", wanted)


@pytest.mark.parametrize(
    "values, text",
    [
        ({"detector": "surf"}, "detector is surf, must be harris, shi_tomasi, fast, orb, sift"),
        ({"max_features": 0}, "max_features is 0, must be from 1 to 5000"),
        ({"corner_quality": 0.0}, "corner_quality is 0, must be above 0 and at most 1"),
        ({"orb_scale_factor": 1.0}, "orb_scale_factor is 1, must be from 1.05 to 2"),
        ({"fast_type": "9"}, "fast_type is 9, must be type_5_8, type_7_12 or type_9_16"),
        ({"mser_min_area": 20000}, "mser_min_area is 20000, must be at most mser_max_area, 14400"),
        ({"blob_max_area": 20.0}, "blob_min_area is 25, must be below blob_max_area, 20"),
        ({"blob_min_threshold": 220.0}, "must be below blob_max_threshold, 220"),
        (
            {"blob_max_threshold": 60.0},
            "blob_threshold_step is 10, must be below blob_max_threshold -",
        ),
    ],
)
def test_bad_parameters_are_refused_in_words(values, text):
    with pytest.raises(ValueError, match=text):
        rv.validate(params(**{"detector": "orb", **values}))
    with pytest.raises(ValueError, match=text):
        rv.find_keypoints(PHOTOGRAPH, "mono8", params(**{"detector": "orb", **values}))


@pytest.mark.skipif(HAS_SIFT, reason="OpenCV has SIFT")
def test_sift_is_refused_where_opencv_has_none():
    with pytest.raises(ValueError, match=r"detector is sift, must be another one: OpenCV has it"):
        rv.validate(params("sift"))
