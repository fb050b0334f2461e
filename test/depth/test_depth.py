"""Depth images in Python: arrays, parameters and errors. The gtests test the algorithms."""

import numpy as np
import pytest

import robot_vision as rv
from robot_vision import depth

WIDTH, HEIGHT = 64, 48
K = [[55.0, 0, 31.5], [0, 55.0, 23.5], [0, 0, 1]]
CAMERA = rv.CameraModel(WIDTH, HEIGHT, K)
LARGE = rv.CameraModel(2 * WIDTH, 2 * HEIGHT, np.diag([2, 2, 1]) @ K)
NAN = float("nan")


def moved(x=0.0):
    pose = np.eye(4)
    pose[0, 3] = x
    return pose


def wall(z=2.0):
    return np.full((HEIGHT, WIDTH), z, np.float32)


def millimetres(metres):
    return (np.nan_to_num(metres) * 1000).astype(np.uint16)


def step():
    """A wall with a board before its right half, and a hole."""
    metres = wall()
    metres[:, WIDTH // 2 :] = 1.0
    metres[4:9, 4:9] = NAN
    return metres


def test_units():
    metres = np.float32([[NAN, 0.5, -1.0, np.inf, 1.2346]])
    assert depth.to_millimetres(metres).tolist() == [[0, 500, 0, 0, 1235]]
    back = depth.to_metres(np.uint16([[0, 500, 65535]]))
    assert back.dtype == np.float32 and np.isnan(back[0, 0])
    assert back[0, 1:].tolist() == [0.5, np.float32(65.535)]
    cleaned = depth.to_metres(metres)
    assert np.isnan(cleaned[0, [0, 2, 3]]).all() and cleaned[0, 1] == 0.5


def test_odd_numbers_are_told():
    assert depth.odd_depth(wall()) == "" and depth.odd_depth(millimetres(wall())) == ""
    assert "median depth is 2000 m" in depth.odd_depth(wall(2000.0))
    assert depth.odd_depth(wall(NAN)) == "none of the 64x48 pixels has a depth"


@pytest.mark.parametrize("kind", [np.uint16, np.float32])
def test_a_camera_in_the_same_place_sees_the_same(kind):
    image = millimetres(step()) if kind == np.uint16 else step()
    before = image.copy()
    seen = depth.register(image, CAMERA, CAMERA, moved())
    assert seen.dtype == kind
    assert np.nan_to_num(seen) == pytest.approx(np.nan_to_num(image), rel=1e-6)
    assert np.array_equal(np.isnan(seen), np.isnan(image))
    assert np.array_equal(np.nan_to_num(image), np.nan_to_num(before))


def test_a_color_camera_beside_it_with_more_pixels():
    """20 mm to the right, things are seen farther left, near ones more."""
    seen = depth.register(step(), CAMERA, LARGE, moved(-0.02))
    assert seen.shape == (2 * HEIGHT, 2 * WIDTH)
    row = seen[60]
    (board,) = np.nonzero(row == 1.0)
    # f = 110 px: the edge at x of about (31.5 - 31.5) / 55 m, half a pixel before it, 20 mm moved.
    assert board[0] == pytest.approx(2 * WIDTH / 2 - 110 * 0.02, abs=2.0)
    assert np.isnan(row).sum() < 5
    registration = rv.DepthRegistration(CAMERA, LARGE, moved(-0.02))
    assert np.array_equal(np.nan_to_num(registration.apply(step())), np.nan_to_num(seen))
    registration.set_transform(moved())
    assert np.array_equal(
        np.nan_to_num(registration.apply(step())),
        np.nan_to_num(depth.register(step(), CAMERA, LARGE, moved())),
    )


def test_parts_of_larger_arrays_are_used():
    padded = np.zeros((HEIGHT, WIDTH + 9), np.uint16)
    padded[:, :WIDTH] = millimetres(step())
    part = padded[:, :WIDTH]
    expected = depth.points(part.copy(), CAMERA)
    for view in (part, np.asfortranarray(part)):
        assert np.array_equal(np.nan_to_num(depth.points(view, CAMERA)), np.nan_to_num(expected))


def test_points_and_clouds():
    image = step()
    xyz = depth.points(image, CAMERA)
    assert (xyz.shape, xyz.dtype) == ((HEIGHT, WIDTH, 3), np.float32)
    v, u = np.mgrid[:HEIGHT, :WIDTH]
    expected = np.dstack([(u - 31.5) / 55 * image, (v - 23.5) / 55 * image, image])
    assert np.nan_to_num(xyz) == pytest.approx(np.nan_to_num(expected), abs=1e-6)
    assert np.array_equal(np.isnan(xyz), np.isnan(expected))
    bgr = np.random.default_rng(1).integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8)
    maker = rv.DepthPoints(CAMERA)
    assert (maker.cloud(image)[:, :, 3] == 1.0).all()
    packed = maker.cloud(image, bgr)[:, :, 3].view(np.uint32)
    blue, green, red = np.moveaxis(bgr.astype(np.uint32), 2, 0)
    assert np.array_equal(packed, red << 16 | green << 8 | blue)


def test_normals_point_to_the_camera():
    normals = depth.normals(step(), CAMERA, radius=2)
    known = ~np.isnan(normals).any(axis=2)
    assert known.sum() > 0.75 * WIDTH * HEIGHT
    assert not known[:, WIDTH // 2].any() and not known[6, 6]
    assert normals[known] == pytest.approx(np.tile([0, 0, -1], (known.sum(), 1)), abs=1e-3)


def test_planes_and_their_pixels():
    found, labels = depth.planes(step(), CAMERA)
    assert [plane.pixels for plane in found] == [(labels == 1).sum(), (labels == 2).sum()]
    distances = sorted(plane.distance for plane in found)
    assert distances == pytest.approx([1.0, 2.0], abs=1e-4)
    for plane in found:
        assert plane.normal == pytest.approx([0, 0, -1], abs=1e-3)
        assert (plane.hull @ plane.normal) == pytest.approx(-plane.distance, abs=1e-6)
        assert plane.center[2] == pytest.approx(plane.distance, abs=1e-4)
    assert depth.planes(step(), CAMERA, max_planes=1)[0][0].pixels == found[0].pixels
    assert depth.planes(wall(NAN), CAMERA)[0] == []


def test_a_board_on_a_wall_as_a_table_with_an_object():
    """What is up is to the camera; the board is too small for a table."""
    image = wall()
    image[10:30, 20:40] = 1.9
    to_camera, smallest = (0, 0, -1), 1.0  # m^2
    (table,), labels = depth.tables(image, CAMERA, to_camera, min_table_area=smallest)
    (board,) = table.objects
    assert board.box == (20, 10, 20, 20)
    assert board.pixels == (labels == 1).sum() == 400
    side = 19 / 55 * 1.9
    assert board.size == pytest.approx([side, side, 0.1], abs=2e-3)
    place = [(29.5 - 31.5) / 55 * 1.9, (19.5 - 23.5) / 55 * 1.9, 1.95]
    assert board.pose[:3, 3] == pytest.approx(place, abs=2e-3)
    assert board.pose[:3, 2] == pytest.approx([0, 0, -1], abs=1e-3)
    assert table.plane.distance == pytest.approx(2.0, abs=1e-3)
    assert table.size == pytest.approx((63 / 55 * 2, 47 / 55 * 2), abs=2e-2)
    assert len(depth.tables(image, CAMERA)[0]) == 1  # the largest plane
    assert depth.tables(image, CAMERA, up=(0, -1, 0))[0] == []


def test_what_cannot_be_used_is_refused():
    for bad in (np.zeros((4, 4), np.int32), np.zeros((4, 4), np.float64)):
        with pytest.raises(TypeError, match="expected depths of uint16"):
            depth.to_metres(bad)
    with pytest.raises(ValueError, match="dimensions"):
        depth.to_metres(np.zeros((4, 4, 3), np.uint16))
    with pytest.raises(ValueError, match="empty"):
        depth.to_metres(np.zeros((0, 4), np.uint16))
    with pytest.raises(ValueError, match="size of the depth image is 4x4, must be 64x48"):
        depth.points(np.zeros((4, 4), np.uint16), CAMERA)
    with pytest.raises(ValueError, match="expected a 4x4 pose"):
        depth.register(wall(), CAMERA, CAMERA, np.eye(3))
    with pytest.raises(ValueError, match="must be that of a rigid body"):
        depth.register(wall(), CAMERA, CAMERA, np.diag([2.0, 1, 1, 1]))
    with pytest.raises(ValueError, match="radius is 99, must be from 1 to 50"):
        depth.normals(wall(), CAMERA, radius=99)
    with pytest.raises(AttributeError, match="no parameter speed of PlaneParams"):
        depth.planes(wall(), CAMERA, speed=1)
