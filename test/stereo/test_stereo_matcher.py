"""Disparities of planes that are known exactly, of a real pair, and against OpenCV."""

import os
import pathlib
import re
import subprocess
import sys

import cv2
import numpy as np
import pytest
import skimage.data
import stereo_images
from stereo_images import HEIGHT, WIDTH, Plane

import robot_vision as rv
from robot_vision import stereo

METHODS = ("bm", "sgbm", "sgbm_3way", "hh")
MODES = {
    "sgbm": cv2.STEREO_SGBM_MODE_SGBM,
    "sgbm_3way": cv2.STEREO_SGBM_MODE_SGBM_3WAY,
    "hh": cv2.STEREO_SGBM_MODE_HH,
}
PLANES = [
    Plane(10.0),
    Plane(10.4),
    Plane(7.75),
    Plane(6.0, 0.05, 0.02),
    Plane(20.0, -0.04, -0.03),
]


def params(**values):
    made = rv.StereoParams()
    for name, value in {"disparities": 32, **values}.items():
        setattr(made, name, value)
    return made


def disparity_of(left, right, encoding="mono8", **values):
    return rv.StereoMatcher(params(**values)).match(left, right, encoding)


def errors(found, plane):
    """How far disparities are from the truth, px, and which of those were found that could be."""
    truth = plane.disparity()
    possible = np.arange(WIDTH) - truth >= 0  # the others are not in the right image
    known = ~np.isnan(found)
    return np.abs(found - truth)[known], known[possible].mean()


@pytest.mark.parametrize("plane", PLANES, ids=str)
@pytest.mark.parametrize("method", METHODS)
def test_a_plane_has_its_disparities_in_the_whole_image(method, plane):
    found = disparity_of(*stereo_images.pair_of(plane), method=method)
    assert (found.dtype, found.shape) == (np.float32, (HEIGHT, WIDTH))
    off, share = errors(found, plane)
    # SGBM's fractions lean towards whole pixels, by up to 0.2 px; those of block matching do not.
    middle, most = (0.1, 0.25) if method == "bm" else (0.25, 0.35)
    assert share > 0.97
    assert np.median(off) < middle and np.percentile(off, 95) < most
    assert (off > 1.0).mean() < 0.005
    assert not (found[~np.isnan(found)] * 16 % 1).any()


@pytest.mark.parametrize("lowest", [-24, 8])
@pytest.mark.parametrize("method", METHODS)
def test_the_search_begins_anywhere(method, lowest):
    """The same pair, its right image moved by whole pixels: all disparities are as much more."""
    plane = Plane(lowest + 12.0)
    found = disparity_of(*stereo_images.pair_of(plane), method=method, min_disparity=lowest)
    known = ~np.isnan(found)
    assert (np.abs(found - plane.at_origin)[known] < 0.5).mean() > 0.99
    possible = (np.arange(WIDTH) >= plane.at_origin) & (np.arange(WIDTH) - plane.at_origin < WIDTH)
    assert known[:, possible].mean() > 0.95
    assert known[:, ~possible].mean() < 0.1


def opencv(left, right, made):
    """What OpenCV finds with the same parameters, px; NaN where it finds none."""
    if made.method == "bm":
        matcher = cv2.StereoBM_create(made.disparities, made.bm_block_size)
        matcher.setMinDisparity(made.min_disparity)
        matcher.setPreFilterType(int(made.prefilter == "xsobel"))
        matcher.setPreFilterSize(made.prefilter_size)
        matcher.setPreFilterCap(made.prefilter_cap)
        matcher.setTextureThreshold(made.texture_threshold)
        matcher.setUniquenessRatio(made.uniqueness_ratio)
        matcher.setDisp12MaxDiff(made.disp12_max_diff)
    else:
        area = made.block_size**2
        matcher = cv2.StereoSGBM_create(
            made.min_disparity,
            made.disparities,
            made.block_size,
            made.p1 or 8 * area,
            made.p2 or 32 * area,
            made.disp12_max_diff,
            made.prefilter_cap,
            made.uniqueness_ratio,
            0,
            0,
            MODES[made.method],
        )
    found = matcher.compute(left, right)
    none = (made.min_disparity - 1) * 16
    if made.median:
        found = cv2.medianBlur(found, made.median)
    if made.speckle_size:
        cv2.filterSpeckles(found, none, made.speckle_size, round(made.speckle_range * 16))
    return np.where(found <= none, np.nan, found / np.float32(16)).astype(np.float32)


CHANGED = [
    {"min_disparity": -16, "disparities": 48, "speckle_size": 0},
    {"uniqueness_ratio": 25},
    {"disp12_max_diff": 16},
    {"prefilter_cap": 63},
    {"speckle_size": 400, "speckle_range": 0.1},
    {"median": 3},
    {"median": 5},
]
OF_BM = {
    "bm_block_size": 9,
    "prefilter": "normalized_response",
    "prefilter_size": 21,
    "texture_threshold": 6000,
}
OF_SGBM = {"block_size": 9, "p1": 50, "p2": 3000}


def changes(method):
    own = OF_BM if method == "bm" else OF_SGBM
    with_size = {"prefilter_size": {"prefilter": "normalized_response"}}
    yield {}
    yield from CHANGED
    for name, value in own.items():
        yield {**with_size.get(name, {}), name: value}


def noisy_pair():
    """One with depths of all kinds, and noise, in which every parameter matters."""
    rng = np.random.default_rng(8)
    left, right = stereo_images.pair_of(Plane(6.0, 0.08, 0.05))
    near = stereo_images.pair_of(Plane(24.0))
    for image, part in zip((left, right), near):
        image[40:90, 90:150] = part[40:90, 90:150]
    left[10:40, 60:100] = right[10:40, 40:80] = 128  # nothing to see
    noise = [rng.normal(0, 12, left.shape) for _ in range(2)]
    return [
        np.clip(np.rint(im + of), 0, 255).astype(np.uint8) for im, of in zip((left, right), noise)
    ]


@pytest.mark.parametrize("method", METHODS)
def test_without_full_image_disparities_equal_those_of_opencv(method):
    left, right = noisy_pair()
    seen = set()
    for values in changes(method):
        made = params(method=method, full_image=False, **values)
        found = rv.StereoMatcher(made).match(left, right, "mono8")
        expected = opencv(left, right, made)
        assert np.array_equal(np.isnan(found), np.isnan(expected)), values
        assert np.array_equal(np.nan_to_num(found), np.nan_to_num(expected)), values
        seen.add(found.tobytes())
    assert len(seen) == len(list(changes(method)))  # each parameter has changed something


@pytest.mark.parametrize("method", METHODS)
def test_inside_the_image_full_image_changes_little(method):
    left, right = noisy_pair()
    plain, full = (disparity_of(left, right, method=method, full_image=on) for on in (False, True))
    inside = np.s_[20:-20, 60:-20]
    both = ~np.isnan(plain[inside]) & ~np.isnan(full[inside])
    assert both.mean() > 0.6 * (~np.isnan(plain[inside])).mean() > 0
    assert (np.abs(plain - full)[inside][both] < 0.5).mean() > 0.95
    assert (~np.isnan(full)).sum() > (~np.isnan(plain)).sum()


def test_the_check_of_both_images_can_be_left_out():
    """SGBM of OpenCV checks also with 0 or less, against its documentation."""
    left, right = noisy_pair()
    for method in METHODS:
        known = [
            (~np.isnan(disparity_of(left, right, method=method, disp12_max_diff=most))).sum()
            for most in (-1, 1)
        ]
        assert known[0] > known[1], method


@pytest.mark.parametrize("lowest", [-38, 0, 16])
@pytest.mark.parametrize("full", [False, True])
@pytest.mark.parametrize("method", ("bm", "sgbm"))
def test_the_window_has_all_that_is_found(method, full, lowest):
    matcher = rv.StereoMatcher(params(method=method, full_image=full, min_disparity=lowest))
    x, y, width, height = matcher.window(WIDTH, HEIGHT)
    assert width > 60 and height > 60
    found = matcher.match(*stereo_images.pair_of(Plane(lowest + 16.0)), "mono8")
    rows, columns = np.nonzero(~np.isnan(found))
    assert columns.min() >= x and columns.max() < x + width
    assert rows.min() >= y and rows.max() < y + height
    assert rows.max() - rows.min() > 0.9 * height
    if not full:  # what is nearest has its first column here
        assert columns.min() - x <= 2


def test_an_image_that_is_all_beyond_the_search_has_no_window():
    assert rv.StereoMatcher(params(min_disparity=300)).window(WIDTH, HEIGHT) == (0, 0, 0, 0)


def test_what_a_camera_does_not_see_has_no_disparity():
    left, right = stereo_images.pair_of(Plane(10.0))
    left_seen, right_seen = (np.full(left.shape, 255, np.uint8) for _ in range(2))
    left_seen[:30] = 0
    right_seen[:, 100:] = 0
    matcher = rv.StereoMatcher(params())
    found = matcher.match(left, right, "mono8", left_seen, right_seen)
    whole = matcher.match(left, right, "mono8")
    assert np.isnan(found[:30]).all() and not np.isnan(whole[:30, 20:]).all()
    assert np.isnan(found[:, 112:]).all()  # their partners are 10 px farther left
    known = ~np.isnan(found[30:, 20:108])
    assert known.mean() > 0.98
    assert np.array_equal(found[30:, 20:108][known], whole[30:, 20:108][known])
    with pytest.raises(ValueError, match="the size of left_seen is 199x120, must be the images'"):
        matcher.match(left, right, "mono8", left_seen[:, 1:], right_seen)


def test_colors_are_matched_by_their_gray():
    left, right = (
        cv2.applyColorMap(image, cv2.COLORMAP_OCEAN) for image in stereo_images.pair_of(Plane(9.0))
    )
    gray = [cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in (left, right)]
    copies = left.copy(), right.copy()
    found = disparity_of(left, right, "bgr8")
    expected = disparity_of(*gray)
    assert np.array_equal(np.nan_to_num(found), np.nan_to_num(expected))
    assert np.array_equal(left, copies[0]) and np.array_equal(right, copies[1])


@pytest.mark.parametrize(
    "values, said",
    [
        ({"method": "magic"}, "method is magic, must be bm, sgbm, sgbm_3way or hh"),
        ({"disparities": 40}, "disparities is 40, must be a multiple of 16"),
        ({"disparities": 0}, "disparities is 0, must be from 16 to 512"),
        ({"block_size": 4}, "block_size is 4, must be odd and from 1 to 11"),
        ({"bm_block_size": 3}, "bm_block_size is 3, must be odd and from 5 to 99"),
        ({"p1": 900, "p2": 800}, "p2 is 800, must be above p1, 900"),
        ({"p1": 800}, "p2 is 800, must be above p1, 800"),
        ({"median": 4}, "median is 4, must be 0, 3 or 5"),
        ({"speckle_range": float("nan")}, "speckle_range is nan, must be from 0 to 64"),
        ({"prefilter": "none"}, "prefilter is none, must be xsobel or normalized_response"),
        (
            {"uniqueness_ratio": 100},
            "uniqueness_ratio is 100, must be at most 88 for sgbm_3way with these block_size, "
            "prefilter_cap and p2",
        ),
    ],
)
def test_parameters_out_of_range_are_refused(values, said):
    with pytest.raises(ValueError) as error:
        rv.StereoMatcher(params(**values))
    assert str(error.value) == said


@pytest.mark.parametrize(
    "shapes, values, said",
    [
        (
            ((40, 60), (40, 61)),
            {},
            "the right image's size is 61x40, must be 60x40 as of the left one",
        ),
        (((15, 60),) * 2, {}, "the images' size is 60x15, must be at least 16 px wide and high"),
        (((1, 1),) * 2, {}, "the images' size is 1x1, must be at least 16 px wide and high"),
        (
            ((40, 20),) * 2,
            {"method": "bm", "bm_block_size": 21},
            "the images' size is 20x40, must be at least 22 px wide and high",
        ),
        (
            ((40, 60),) * 2,
            {"method": "bm", "prefilter": "normalized_response", "prefilter_size": 89},
            "the images' size is 60x40, must be at least 44 px wide and high",
        ),
        (
            ((40, 30),) * 2,
            {"full_image": False},
            "the images' width is 30, must be above 32 px, what disparities from min_disparity on",
        ),
        (
            ((1100, 1500),) * 2,
            {"method": "hh", "disparities": 256},
            "the images' size is 1500x1100, must be smaller for hh with so many disparities",
        ),
        (
            ((60, 640),) * 2,
            {"method": "bm", "full_image": False, "min_disparity": 350},
            "the images' width is 640, must be at least 700 px for bm with so large a min_dis",
        ),
        (
            ((60, 300),) * 2,
            {"method": "bm", "disparities": 16, "min_disparity": 400, "bm_block_size": 5},
            "the images' width is 300, must be at least 380 px for bm with so large a min_dis",
        ),
    ],
)
def test_images_that_cannot_be_matched_are_refused(shapes, values, said):
    images = [np.zeros(shape, np.uint8) for shape in shapes]
    with pytest.raises(ValueError) as error:
        disparity_of(*images, **values)
    assert str(error.value).startswith(said)


@pytest.mark.parametrize("size, disparities, block", [((240, 320), 304, 21), ((16, 17), 16, 5)])
def test_where_no_pixel_can_be_matched_there_are_no_disparities(size, disparities, block):
    """OpenCV's StereoBM leaves what was in memory."""
    image = np.full(size, 128, np.uint8)
    values = {"disparities": disparities, "bm_block_size": block, "speckle_size": 0}
    made = params(method="bm", full_image=False, **values)
    assert rv.StereoMatcher(made).window(*size[::-1]) == (0, 0, 0, 0)
    assert np.isnan(rv.StereoMatcher(made).match(image, image, "mono8")).all()


def largest_ratio(**values):
    """The largest uniqueness_ratio that is possible."""
    try:
        rv.StereoMatcher(params(uniqueness_ratio=100, **values))
    except ValueError as error:
        return int(re.search("at most ([0-9]+) for", str(error)).group(1))
    return 100


@pytest.mark.parametrize("block, cap", [(1, 31), (5, 1), (5, 31), (7, 63), (9, 31), (11, 63)])
@pytest.mark.parametrize("method", METHODS[1:])
def test_with_a_larger_uniqueness_ratio_no_more_is_found(method, block, cap):
    """Of two images that have nothing to do with each other."""
    y, x = np.mgrid[:100, :160].astype(float)
    left, right = stereo_images.texture(x, y), stereo_images.texture(x + 1000.0, y + 1000.0)
    values = {"method": method, "block_size": block, "prefilter_cap": cap}
    largest = largest_ratio(**values)
    assert largest == 100 if method != "sgbm_3way" else largest < 100
    shares = [
        np.isfinite(
            disparity_of(left, right, uniqueness_ratio=ratio, disp12_max_diff=-1, **values)
        ).mean()
        for ratio in (5, largest // 2, largest)
    ]
    assert shares[0] > 0.02 and sorted(shares, reverse=True) == shares


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("full", [False, True])
def test_the_smallest_images_have_disparities_of_their_size(method, full):
    image = np.random.default_rng(1).integers(0, 256, (16, 17), np.uint8)
    values = {"method": method, "full_image": full, "disparities": 16, "bm_block_size": 5}
    assert disparity_of(image, image, **values).shape == (16, 17)


ONE_THREAD = """
import os
import numpy as np
import robot_vision as rv
rv.set_threads(4)
image = np.random.default_rng(1).integers(0, 256, (240, 320), np.uint8)
before = len(os.listdir("/proc/self/task"))
for method in ("bm", "sgbm", "sgbm_3way", "hh"):
    params = rv.StereoParams()
    params.method = method
    rv.StereoMatcher(params).match(image, image, "mono8")
print(before, len(os.listdir("/proc/self/task")))
"""


def test_one_thread_does_the_work():
    env = {**os.environ, "OPENCV_FOR_THREADS_NUM": "4"}
    result = subprocess.run(
        [sys.executable, "-c", ONE_THREAD], env=env, stdout=subprocess.PIPE, text=True, check=True
    )
    before, after = result.stdout.split()
    assert before == after


MOTORCYCLE = [
    pathlib.Path(skimage.data.__file__).parent / f"motorcycle_{name}"
    for name in ("left.png", "right.png", "disp.npz")
]


def right_share(found, truth):
    """Of all pixels whose disparity is known, those where it is found within 1 px."""
    known = np.isfinite(truth)
    return (np.abs(found - truth)[known] <= 1.0).mean()


@pytest.mark.skipif(
    not all(path.exists() for path in MOTORCYCLE), reason="this python3-skimage has no such pair"
)
@pytest.mark.parametrize("method, usual, gain", [("bm", 0.65, 0.07), ("sgbm_3way", 0.74, 0.04)])
def test_more_of_a_real_pair_is_right_than_with_opencv_alone(method, usual, gain):
    """The Middlebury pair Motorcycle, 741x500, with its true disparities."""
    left, right = (cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in MOTORCYCLE[:2])
    (truth,) = np.load(str(MOTORCYCLE[2])).values()
    made = params(method=method, disparities=80)
    plain = opencv(left, right, made)
    found = rv.StereoMatcher(made).match(left, right, "mono8")
    shares = [right_share(one, truth) for one in (plain, found)]
    assert shares[0] > usual
    assert shares[1] > shares[0] + gain
    # Nor is more of it wrong.
    known = np.isfinite(truth)
    wrong = [(np.abs(one - truth)[known & ~np.isnan(one)] > 1.0).mean() for one in (plain, found)]
    assert wrong[1] < wrong[0] + 0.005


def test_a_pair_is_matched_in_one_call():
    left, right = stereo_images.pair_of(Plane(10.0))
    found = stereo.match_rectified(left, right, "mono8", disparities=32)
    assert np.array_equal(np.nan_to_num(found), np.nan_to_num(disparity_of(left, right)))
    camera = rv.CameraModel(WIDTH, HEIGHT, [[150, 0, 100], [0, 150, 60], [0, 0, 1]])
    projection = np.float64([[150, 0, 100, 0], [0, 150, 60, 0], [0, 0, 1, 0]])
    shifted = projection.copy()
    shifted[0, 3] = -15.0
    pair = rv.StereoCamera(
        rv.RectifiedCamera(camera, np.eye(3), projection),
        rv.RectifiedCamera(camera, np.eye(3), shifted),
    )
    match = stereo.match(left, right, pair, "mono8", disparities=32)
    assert np.array_equal(match.image, cv2.cvtColor(left, cv2.COLOR_GRAY2BGR))
    assert np.array_equal(np.nan_to_num(match.disparity), np.nan_to_num(found))
    assert np.nanmedian(match.depth) == pytest.approx(1.5)
    assert match.points.shape == (HEIGHT, WIDTH, 3)
    with pytest.raises(AttributeError, match="there is no parameter block of StereoParams"):
        stereo.match_rectified(left, right, "mono8", block=3)
