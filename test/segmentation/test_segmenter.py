"""Each method of the Segmenter against OpenCV called plainly, and against drawn truth."""

import itertools

import cv2
import numpy as np
import pytest
from segment_images import DISCS, discs, leaf, patches, steps

import robot_vision as rv

METHODS = [
    "watershed",
    "grab_cut",
    "k_means",
    "mean_shift",
    "flood_fill",
    "distance_transform",
]


def segmenter(method, **values):
    """A Segmenter that works on the whole image and leaves out nothing, but for `values`."""
    params = rv.SegmenterParams()
    params.method = method
    for name, value in {"scale": 1.0, "min_area": 0.0, "max_segments": 1000, **values}.items():
        setattr(params, name, value)
    return rv.Segmenter(params)


def labels_of(method, image, regions=(), points=(), **values):
    made = segmenter(method, **values)
    for region in regions:
        made.add_region(region)
    for point in points:
        made.add_point(point)
    return made.apply(image).labels


def iou(a, b):
    return (a & b).sum() / (a | b).sum()


def by_size(labels):
    """The labels with the largest as 1, and so on; of equal ones the first in the image is less."""
    names, first, counts = np.unique(labels, return_index=True, return_counts=True)
    order = np.lexsort((first, -counts))
    table = np.zeros(names.max() + 1, np.uint16)
    table[[names[i] for i in order if names[i] > 0]] = np.arange(1, (names > 0).sum() + 1)
    return table[labels]


# What touches.


def shares(labels, owner):
    """For each disc the label in its middle, and its area to the true one."""
    for number, (x, y, _) in enumerate(DISCS):
        label = labels[y, x]
        yield label, (labels == label).sum() / (owner == number).sum()


@pytest.mark.parametrize("noise", [0.0, 10.0])
@pytest.mark.parametrize("swap, objects", [(False, "auto"), (True, "auto"), (True, "dark")])
def test_discs_that_touch_are_told_apart(noise, swap, objects):
    image, owner = discs(noise, swap)
    labels = labels_of("distance_transform", image, objects=objects)
    names, ratios = zip(*shares(labels, owner))
    assert sorted(names) == list(range(1, len(DISCS) + 1)) == sorted(set(labels[labels > 0]))
    assert np.abs(np.array(ratios) - 1.0).max() < 0.04
    sizes = np.bincount(labels.ravel())[1:]
    assert (np.diff(sizes) <= 0).all()  # the largest is 1


def test_automatic_watershed_finds_the_same_discs():
    image, owner = discs()
    labels = labels_of("watershed", image)
    names, ratios = zip(*shares(labels, owner))
    assert sorted(names) == list(range(1, len(DISCS) + 1))
    assert min(ratios) > 0.75 and max(ratios) <= 1.0  # a line of 1 px is around each
    made = segmenter("watershed", automatic=False)
    found = made.apply(image)
    assert not found.labels.any() and "no seeds" in found.hint


def test_what_counts_as_an_object_and_as_a_seed():
    image, owner = discs()
    ground = labels_of("distance_transform", image, objects="dark", opening=1) > 0
    assert iou(ground, owner < 0) > 0.999
    joined = labels_of("distance_transform", image, peak_height=0.2)
    assert joined[70, 70] == joined[70, 145] != joined[60, 250]
    image[224:226, 30:32] = 255  # a speck
    for scale in (1.0, 0.5):
        for opening, count in ((1, len(DISCS) + 1), (3, len(DISCS)), (5, len(DISCS))):
            values = {"scale": scale, "opening": opening}
            assert labels_of("distance_transform", image, **values).max() == count, values


# Seeds.


@pytest.mark.parametrize("border", [0, 1, 6])
def test_watershed_is_opencv_s(border):
    image, _ = discs(noise=5.0)
    regions, point, radius = [(50, 55, 30, 20), (200, 10, 60, 90)], (145, 70), 7
    markers = np.zeros(image.shape[:2], np.int32)
    if border:
        markers[:] = 9
        markers[border + 1 : -border - 1, border + 1 : -border - 1] = 0
    for number, (x, y, width, height) in enumerate(regions, 1):
        markers[y : y + height, x : x + width] = number
    cv2.circle(markers, point, radius, 3, -1)
    expected = cv2.watershed(image, markers)
    expected = np.where((expected < 0) | (expected == 9), 0, expected)
    labels = labels_of("watershed", image, regions, [point], seed_radius=radius, border=border)
    assert np.array_equal(labels, expected)
    assert set(labels.ravel()) == {0, 1, 2, 3}


def grab_cut(image, mask, iterations, seed=1):
    cv2.setRNGSeed(seed)
    models = np.zeros((1, 65)), np.zeros((1, 65))
    cv2.grabCut(image, mask, None, *models, iterations, cv2.GC_INIT_WITH_MASK)
    return mask & 1


@pytest.mark.parametrize("iterations, seed", [(1, 1), (4, 1), (1, 77)])
def test_grab_cut_is_opencv_s_and_finds_the_leaf(iterations, seed):
    image, truth, rect = leaf()
    cv2.setRNGSeed(seed)
    mask = np.zeros(truth.shape, np.uint8)
    models = np.zeros((1, 65)), np.zeros((1, 65))
    cv2.grabCut(image, mask, rect, *models, iterations, cv2.GC_INIT_WITH_RECT)
    labels = labels_of("grab_cut", image, [rect], iterations=iterations, random_seed=seed)
    assert np.array_equal(labels, mask & 1)
    assert iou(labels > 0, truth) > 0.95


def test_clicks_belong_to_the_object():
    image, truth, (x, y, width, height) = leaf()
    image[50:70, 60:75] = image[2:22, 2:17]  # a hole, through which the ground is seen
    mask = np.full(truth.shape, cv2.GC_BGD, np.uint8)
    mask[y : y + height, x : x + width] = cv2.GC_PR_FGD
    cv2.circle(mask, (67, 60), 6, cv2.GC_FGD, -1)
    expected = grab_cut(image, mask, 3)
    clicked = labels_of(
        "grab_cut", image, [(x, y, width, height)], [(67, 60)], iterations=3, seed_radius=6
    )
    assert np.array_equal(clicked, expected) and clicked[60, 67] == 1


def test_with_clicks_alone_the_object_is_anywhere_inside_of_the_border():
    image, truth, _ = leaf()
    mask = np.full(truth.shape, cv2.GC_BGD, np.uint8)
    mask[3:-3, 3:-3] = cv2.GC_PR_FGD
    cv2.circle(mask, (100, 70), 5, cv2.GC_FGD, -1)
    labels = labels_of("grab_cut", image, (), [(100, 70)], border=3)
    assert np.array_equal(labels, grab_cut(image, mask, 3))
    assert iou(labels > 0, truth) > 0.95


@pytest.mark.parametrize(
    "regions, text",
    [
        ([], "grab_cut has no seeds"),
        ([(0, 0, 160, 120)], "leave no background"),
        ([(10, 10, 2, 2)], "too small"),
        ([(500, 10, 20, 20)], "grab_cut has no seeds"),  # it is outside of this image
    ],
)
def test_what_grab_cut_lacks_is_said(regions, text):
    made = segmenter("grab_cut")
    for region in regions:
        made.add_region(region)
    found = made.apply(leaf()[0])
    assert text in found.hint and not found.labels.any()


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("lower, upper", [(0.0, 0.0), (0.0, 6.0), (6.0, 0.0), (13.0, 20.0)])
def test_flood_fill_is_opencv_s(lower, upper, fixed):
    image, seed = steps(), (70, 10)
    mask = np.zeros((62, 130), np.uint8)
    flags = 4 | cv2.FLOODFILL_MASK_ONLY | (1 << 8) | (cv2.FLOODFILL_FIXED_RANGE if fixed else 0)
    cv2.floodFill(image.copy(), mask, seed, 0, (lower,) * 3, (upper,) * 3, flags)
    values = {"lower_difference": lower, "upper_difference": upper, "fixed_range": fixed}
    labels = labels_of("flood_fill", image, (), [seed], **values)
    assert np.array_equal(labels, mask[1:-1, 1:-1]) and labels[10, 70] == 1


def test_seeds_fill_one_after_the_other():
    image = steps()
    values = {"lower_difference": 0.0, "upper_difference": 0.0}
    points = [(70, 10), (71, 12), (5, 50)]
    made = segmenter("flood_fill", **values)
    assert "no seeds" in made.apply(image).hint
    for point in points:
        made.add_point(point)
    made.add_region((100, 35, 20, 11))  # its middle is the seed
    found = made.apply(image)
    expected = np.zeros(image.shape[:2], int)
    expected[:30, 64:80], expected[31:, :16], expected[31:, 96:112] = 1, 3, 4
    assert np.array_equal(found.labels, expected) and not found.hint
    assert [seed.point for seed in made.seeds] == [*points, (110, 40)]
    made.clear_seeds()
    assert not made.seeds and not made.apply(image).labels.any()


# Colors.


def test_k_means_finds_noisy_colors_to_a_gray_level():
    image, colors, columns = patches()
    found = segmenter("k_means", clusters=3).apply(image)
    assert np.abs(found.centers - colors).max() < 1.0
    assert np.array_equal(found.labels, np.repeat(columns[None] + 1, 90, axis=0))


def test_k_means_is_opencv_s_with_the_same_random_numbers():
    image, _, _ = patches(noise=40.0)
    for clusters, attempts, seed in ((5, 1, 1), (5, 4, 1), (7, 1, 99)):
        cv2.setRNGSeed(seed)
        criteria = cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 20, 0.1
        samples = image.reshape(-1, 3).astype(np.float32)
        start = cv2.KMEANS_PP_CENTERS
        _, labels, centers = cv2.kmeans(samples, clusters, None, criteria, attempts, start)
        values = {"clusters": clusters, "attempts": attempts, "random_seed": seed}
        found = segmenter("k_means", **values).apply(image)
        expected = by_size(labels.reshape(image.shape[:2]) + 1)
        assert np.array_equal(found.labels, expected)
        order = np.argsort(-np.bincount(labels.ravel()), kind="stable")
        assert np.array_equal(found.centers, centers[order])


def test_colors_keep_their_numbers():
    image, colors, _ = patches()
    kept = segmenter("k_means", clusters=3)
    new = segmenter("k_means", clusters=3, keep_centers=False)
    for made in (kept, new):
        made.apply(image)
    mixed = image.copy()
    mixed[:, 20:60] = mixed[:, 100:101]  # the last color has become the largest
    labels = kept.apply(mixed).labels
    assert [labels[5, x] for x in (5, 80, 110)] == [1, 2, 3]
    labels = new.apply(mixed).labels
    assert [labels[5, x] for x in (110, 80, 5)] == [1, 2, 3]
    assert np.abs(kept.apply(image).centers - colors).max() < 1.0


def test_random_numbers_of_others_stay_as_they_are():
    image, _, rect = leaf()

    def next_numbers(between):
        cv2.setRNGSeed(5)
        between()
        return cv2.randu(np.zeros(4, np.uint8), 0, 255).ravel().tolist()

    expected = next_numbers(lambda: None)
    assert expected == next_numbers(lambda: labels_of("k_means", image))
    assert expected == next_numbers(lambda: labels_of("grab_cut", image, [rect]))


def flat_regions(image, tolerance):
    """What cv2.floodFill makes of each pixel that no earlier one has filled, in rows."""
    labels = np.zeros(image.shape[:2], np.int32)
    mask = np.zeros((image.shape[0] + 2, image.shape[1] + 2), np.uint8)
    flags = 4 | cv2.FLOODFILL_MASK_ONLY | (1 << 8)
    for y, x in itertools.product(*map(range, labels.shape)):
        if not mask[y + 1, x + 1]:
            before = mask.copy()
            cv2.floodFill(image, mask, (x, y), 0, (tolerance,) * 3, (tolerance,) * 3, flags)
            labels[(mask != before)[1:-1, 1:-1]] = labels.max() + 1
    return labels


@pytest.mark.parametrize(
    "spatial, color, levels, tolerance",
    [(5.0, 20.0, 0, 2.0), (9.0, 40.0, 1, 2.0), (5.0, 20.0, 2, 5.0)],
)
def test_mean_shift_is_opencv_s(spatial, color, levels, tolerance):
    image = leaf()[0][20:80, 30:110]
    flat = cv2.pyrMeanShiftFiltering(image, spatial, color, maxLevel=levels)
    labels = labels_of(
        "mean_shift",
        image,
        spatial_radius=spatial,
        color_radius=color,
        levels=levels,
        color_tolerance=tolerance,
    )
    expected = by_size(flat_regions(flat, tolerance))
    assert np.array_equal(labels, np.where(expected <= 1000, expected, 0))


# What all methods share.


@pytest.mark.parametrize("method", METHODS)
def test_a_smaller_image_finds_about_the_same(method):
    image, _, rect = leaf()
    image, middle = cv2.GaussianBlur(image, (0, 0), 1.0), (60, 80)
    regions = [(64, 50, 32, 20)] if method in ("watershed", "flood_fill") else [rect]
    if method == "distance_transform":
        image, middle = discs()[0], (70, 70)
    values = {"lower_difference": 40.0, "upper_difference": 40.0, "fixed_range": True}
    values.update(clusters=2, color_radius=60.0, color_tolerance=10.0, border=6)
    whole = labels_of(method, image, regions, **values)
    half = labels_of(method, image, regions, scale=0.5, **values)
    assert half.shape == whole.shape == image.shape[:2]
    height, width = half.shape
    shape = height // 2, 2, width // 2, 2
    blocks = half.reshape(shape)
    assert (blocks == blocks[:, :1, :, :1]).all()
    assert (whole.reshape(shape) != whole.reshape(shape)[:, :1, :, :1]).any()
    assert iou(whole == whole[middle], half == half[middle]) > 0.8


def test_small_segments_are_left_out_and_the_largest_kept():
    image, _ = discs()
    areas = np.bincount(labels_of("distance_transform", image).ravel())[1:]
    assert labels_of("distance_transform", image, min_area=float(areas[-1])).max() == len(areas)
    labels = labels_of("distance_transform", image, min_area=areas[-1] + 1.0)
    assert np.array_equal(np.bincount(labels.ravel())[1:], areas[:-1])
    labels = labels_of("distance_transform", image, max_segments=2)
    assert np.array_equal(np.bincount(labels.ravel())[1:], areas[:2])
    halved = labels_of("distance_transform", image, min_area=areas[-1] * 0.8, scale=0.5)
    assert halved.max() == len(areas)  # the area is that in the whole image


def test_labels_stay_where_they_were():
    image, _ = discs()
    alone = image.copy()
    alone[:, :180] = image[0, 0]  # only the two discs on the right are left
    for keep in (True, False):
        made = segmenter("distance_transform", keep_labels=keep)
        before = made.apply(image).labels
        after = made.apply(alone).labels
        numbers = [after[y, x] for x, y, _ in DISCS[-2:]]
        assert numbers == ([before[y, x] for x, y, _ in DISCS[-2:]] if keep else [1, 2])
        again = made.apply(image).labels
        assert np.array_equal(np.unique(again), np.unique(before))
        assert again[60, 250] == before[60, 250]


def test_the_same_images_give_the_same_labels():
    image, _, rect = leaf()
    for method in METHODS:
        first, second = (labels_of(method, image, [rect], clusters=6) for _ in range(2))
        assert np.array_equal(first, second) and first.any()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1), (2, 2), (3, 5), (31, 17)])
@pytest.mark.parametrize("scale", [1.0, 0.05])
def test_images_of_any_size_and_light_are_taken(method, size, scale):
    for value, seeded in itertools.product((0, 255), (False, True)):
        image = np.full((*size, 3), value, np.uint8)
        image.setflags(write=False)
        made = segmenter(method, scale=scale, levels=3)
        if seeded:
            made.add_region((0, 0, 5, 1))
            made.add_point((size[1] - 1, size[0] - 1))
        labels = made.apply(image).labels
        assert labels.shape == size and labels.dtype == np.uint16
        assert (image == value).all()


def test_every_encoding_is_taken_and_padded_rows():
    image, _ = discs()
    expected = labels_of("distance_transform", image)
    made = segmenter("distance_transform", keep_labels=False)
    padded = np.zeros((image.shape[0], image.shape[1] + 7, 3), np.uint8)
    padded[:, :-7] = image
    assert np.array_equal(made.apply(padded[:, :-7]).labels, expected)
    assert np.array_equal(made.apply(image[..., ::-1].copy(), "rgb8").labels, expected)
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    assert np.array_equal(made.apply(gray, "mono8").labels, expected)
    assert np.array_equal(made.apply(gray.astype(np.uint16) * 257, "mono16").labels, expected)
    with pytest.raises(ValueError, match="mono8"):
        made.apply(image, "mono8")


def test_seeds_are_limited():
    made = segmenter("watershed")
    for number in range(100):
        made.add_point((number, 0))
    with pytest.raises(ValueError, match="the number of seeds is 101, must be from 1 to 100"):
        made.add_region((0, 0, 5, 5))
    with pytest.raises(ValueError, match="the region's size is 0x5, must be from 1x1 to"):
        made.add_region((0, 0, 0, 5))
    far = 2**31 - 1
    for region in ((far, 0, 5, 5), (0, -far, 5, 5), (5, 0, far, 5)):
        with pytest.raises(ValueError, match="the region's"):
            made.add_region(region)
    with pytest.raises(ValueError, match="the pixel's y is 2"):
        made.add_point((0, far))
    assert len(made.seeds) == 100


@pytest.mark.parametrize(
    "method, values, text",
    [
        ("mean_shift", {"spatial_radius": 50.0}, "spatial_radius is 50"),
        ("k_means", {"clusters": 32, "attempts": 10}, "clusters, attempts are 32, 10"),
        ("grab_cut", {"iterations": 10}, "iterations is 10"),
    ],
)
def test_what_would_take_many_seconds_is_refused(method, values, text):
    image = np.random.default_rng(1).integers(0, 256, (1080, 1920, 3), np.uint8)
    made = segmenter(method, **values)
    made.add_region((5, 5, 20, 16))
    limit = r"must be less, or the image of 1920x1080 have at most \d+ pixels"
    with pytest.raises(ValueError, match=f"^{text} at scale 1, {limit}$"):
        made.apply(image)
    assert made.apply(image[:32, :48]).labels.shape == (32, 48)


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("method", "magic", "method is magic, must be watershed, grab_cut"),
        ("scale", 0.0, "scale is 0, must be from 0.05 to 1"),
        ("objects", "white", "objects is white, must be auto, bright or dark"),
        ("opening", 2, "opening is 2, must be odd and from 1 to 31"),
    ],
)
def test_parameters_out_of_range_are_refused(name, value, text):
    made = segmenter("k_means", clusters=2)
    params = rv.SegmenterParams()
    setattr(params, name, value)
    with pytest.raises(ValueError, match=text):
        rv.Segmenter(params)
    with pytest.raises(ValueError, match=text):
        made.configure(params)
    assert made.apply(patches()[0]).labels.max() == 2  # it is as it was
