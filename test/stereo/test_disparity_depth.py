"""Depth, points and colors of disparities, against the formulas and OpenCV's Q."""

import cv2
import numpy as np
import pytest

import robot_vision as rv

SIZE = WIDTH, HEIGHT = 64, 48
FX, FY, CX, CY, BASELINE = 500.0, 510.0, 33.0, 22.0, 0.12  # px, m
NAN = float("nan")
CAMERA = rv.CameraModel(*SIZE, [[FX, 0, CX], [0, FY, CY], [0, 0, 1]])  # sees the left images


def geometry(offset=0.0):
    """The geometry of a pair whose principal points differ by `offset` px."""
    camera = rv.CameraModel(*SIZE, [[FX, 0, CX], [0, FX, CY], [0, 0, 1]])
    projections = [
        np.float64([[FX, 0, cx, tx], [0, FY, CY, 0], [0, 0, 1, 0]])
        for cx, tx in ((CX, 0.0), (CX - offset, -FX * BASELINE))
    ]
    return rv.StereoCamera(
        *(rv.RectifiedCamera(camera, np.eye(3), P) for P in projections)
    ).geometry


def disparities():
    """Of all sizes, with holes."""
    rng = np.random.default_rng(6)
    found = (rng.integers(1, 1000, (HEIGHT, WIDTH)) / 16).astype(np.float32)
    found[rng.random(found.shape) < 0.2] = NAN
    return found


def test_the_geometry_is_that_of_p():
    seen = geometry(2.5)
    assert (seen.fx, seen.fy, seen.cx, seen.cy, seen.offset) == (FX, FY, CX, CY, 2.5)
    assert seen.baseline == pytest.approx(BASELINE)


@pytest.mark.parametrize("offset", [0.0, 2.5, -3.0])
def test_depth_is_f_b_over_the_disparity_beyond_that_of_infinity(offset):
    found = disparities()
    before = found.copy()
    depth = rv.depth_from_disparity(found, geometry(offset))
    assert (depth.dtype, depth.shape) == (np.float32, found.shape)
    beyond = found - offset
    with np.errstate(invalid="ignore", divide="ignore"):
        expected = np.where(beyond > 0, FX * BASELINE / beyond, NAN)
    assert np.array_equal(np.isnan(depth), np.isnan(expected))
    assert np.nan_to_num(depth) == pytest.approx(np.nan_to_num(expected), rel=1e-6)
    assert np.array_equal(np.nan_to_num(found), np.nan_to_num(before))


def test_what_is_not_nearer_than_infinity_has_no_depth():
    found = np.float32([[0, -1, NAN, 1e-3, 4]])
    depth = rv.depth_from_disparity(found, geometry())
    assert np.isnan(depth[0, :3]).all()
    assert depth[0, 3:] == pytest.approx([60000.0, 15.0], rel=1e-6)


@pytest.mark.parametrize("offset", [0.0, 2.5])
def test_points_are_those_of_opencv_s_q(offset):
    """Q as cv2.stereoRectify makes it, where fx and fy are equal; here rows have their own."""
    found, of = disparities(), geometry(offset)
    points = rv.DepthPoints(CAMERA).points(rv.depth_from_disparity(found, of))
    assert (points.dtype, points.shape) == (np.float32, (HEIGHT, WIDTH, 3))
    tx = -BASELINE
    of_opencv = np.float64(
        [
            [1, 0, 0, -CX],
            [0, FX / FY, 0, -CY * FX / FY],
            [0, 0, 0, FX],
            [0, 0, -1 / tx, offset / tx],
        ]
    )
    expected = cv2.reprojectImageTo3D(np.nan_to_num(found, nan=-1.0), of_opencv)
    known = found - offset > 0
    assert np.array_equal(~np.isnan(points).any(axis=2), known)
    assert np.isnan(points[~known]).all()
    assert points[known] == pytest.approx(expected[known], rel=1e-4, abs=1e-6)


def test_points_project_onto_their_pixels():
    found, of = disparities(), geometry()
    points = rv.DepthPoints(CAMERA).points(rv.depth_from_disparity(found, of))
    known = ~np.isnan(found)
    x, y, z = points[known].T
    rows, columns = np.nonzero(known)
    assert FX * x / z + CX == pytest.approx(columns, abs=1e-3)
    assert FY * y / z + CY == pytest.approx(rows, abs=1e-3)


def test_depth_in_millimetres_is_rounded_and_0_where_it_does_not_fit():
    depth = np.float32([[NAN, 0.0004, 0.0006, 1.2344, 1.2346, 65.535, 65.5354, 65.536, 1e9, -1.0]])
    encoded = rv.encode_depth(depth)
    assert encoded.dtype == np.uint16
    assert encoded.tolist() == [[0, 0, 1, 1234, 1235, 65535, 65535, 0, 0, 0]]
    same = rv.encode_depth(depth, "32FC1")
    assert same.dtype == np.float32 and np.array_equal(np.nan_to_num(same), np.nan_to_num(depth))
    with pytest.raises(ValueError, match="depth_encoding is mono8, must be 32FC1 or 16UC1"):
        rv.encode_depth(depth, "mono8")


def test_disparities_are_colors_between_two_ends():
    found = np.float32([[-5, 0, 16, 32, 99, NAN]])
    colors = rv.disparity_to_colors(found, 0.0, 32.0)[0]
    assert np.array_equal(colors[0], colors[1]) and np.array_equal(colors[3], colors[4])
    assert not colors[5].any()
    levels = np.uint8([[0, 127, 128, 255]])
    scale = cv2.applyColorMap(levels, cv2.COLORMAP_TURBO)[0]
    assert np.array_equal(colors[1], scale[0]) and np.array_equal(colors[3], scale[3])
    assert any(np.array_equal(colors[2], one) for one in scale[1:3])
    with pytest.raises(ValueError, match="the highest disparity is 3, must be above the lowest, 3"):
        rv.disparity_to_colors(found, 3.0, 3.0)


@pytest.mark.parametrize("shape", [(0, 0), (4,), (4, 4, 1)])
def test_what_is_no_image_is_refused(shape):
    empty = np.zeros(shape, np.float32)
    of = geometry()
    for call in (
        lambda: rv.depth_from_disparity(empty, of),
        lambda: rv.encode_depth(empty),
        lambda: rv.disparity_to_colors(empty, 0.0, 1.0),
    ):
        with pytest.raises(ValueError):
            call()
