"""Parts of a capture: which views are kept, and where an object is in an image."""

import numpy as np
import pytest

from robot_vision import CameraModel
from robot_vision.recognition.capture_mask import (
    PixelRays,
    Space,
    object_mask,
    sharpness,
    touches_border,
)
from robot_vision.recognition.capture_views import (
    View,
    ViewCollection,
    azimuth_of,
    elevation_of,
)

CAMERA = CameraModel(160, 120, [150.0, 0.0, 80.0, 0.0, 150.0, 60.0, 0.0, 0.0, 1.0])
PLATE = np.diag([1.0, -1.0, -1.0, 1.0])  # seen from right above
PLATE[2, 3] = 1.0
SPACE = Space(0.1, 0.01, 0.3)


def view(degrees, time=0.0, sharp=1.0, height=0.5):
    """What a camera sees that is 1 m away from the object's z axis."""
    angle = np.radians(degrees)
    pose = np.eye(4)
    pose[:3, 3] = -np.cos(angle), -np.sin(angle), -height
    return View(time, 0, None, None, None, None, pose, sharp)


def take(collection, one):
    """Offers a view after which nothing comes for a while, and keeps it if it is to be stored."""
    collection.add(one)
    done = collection.end()
    if done is not None:
        collection.keep(done)
    return done


def test_the_azimuth_is_where_the_camera_is():
    for degrees in (0, 90, 200, 355):
        assert np.degrees(azimuth_of(view(degrees).pose)) == pytest.approx(degrees)
        assert elevation_of(view(degrees).pose) == pytest.approx(np.arctan(0.5))


def test_the_sharpest_view_of_each_direction_is_kept():
    collection = ViewCollection(4)
    assert collection.add(view(0, 0.0, 1.0)) is None
    assert collection.add(view(10, 0.2, 3.0)) is None
    assert collection.add(view(-20, 0.4, 2.0)) is None
    stored = collection.add(view(90, 0.6))
    assert stored.sharpness == 3.0 and collection.kept == 0
    collection.keep(stored)
    assert collection.kept == 1
    collection.keep(collection.add(view(2, 0.8, 9.0)))  # that of 90 degrees
    assert collection.kept == 2  # The direction 0 has one already.
    assert collection.end() is None
    assert not collection.full


def test_a_plate_that_rests_does_not_wait_for_ever():
    collection = ViewCollection(4)
    assert collection.add(view(0, 0.0)) is None
    assert collection.add(view(0, 0.9, 5.0)) is None
    assert collection.add(view(0, 1.1)).sharpness == 5.0
    assert collection.add(view(0, 1.2)) is None


def test_times_that_jump_back_lose_no_view():
    collection = ViewCollection(4)
    collection.add(view(0, 100.0))
    assert collection.add(view(0, 3.0)) is not None


def test_what_is_missing_is_told_as_directions():
    collection = ViewCollection(8)
    assert collection.summary() == "0 of 8 views, missing at 0-360 degrees"
    for degrees in (45, 90, 225):
        take(collection, view(degrees))
    assert collection.summary() == "3 of 8 views, missing at 135-180, 270-0 degrees"
    for degrees in (0, 135, 180, 270, 315):
        take(collection, view(degrees))
    assert collection.full and collection.summary() == "8 of 8 views"


def test_earlier_views_from_the_same_height_count():
    earlier = [view(degrees).pose for degrees in (45, 90, 225)]
    same, higher = ViewCollection(8, earlier), ViewCollection(8, earlier)
    assert take(same, view(93, height=0.55)) is None
    assert take(same, view(180, height=0.45)) is not None
    assert same.summary() == "4 of 8 views, missing at 135, 270-0 degrees"
    assert take(higher, view(93, height=0.8)) is not None
    assert higher.summary() == "1 of 8 views, missing at 135-45 degrees"


def depth_with(*blocks):
    """The plate's depths in m, and those of blocks: (rows, columns, depth)."""
    depth = np.full((120, 160), 1.0, np.float32)
    for rows, columns, value in blocks:
        depth[rows, columns] = value
    return depth


def mask_of(depth):
    return object_mask(depth, PixelRays().of(CAMERA), PLATE, SPACE)


def test_what_is_above_the_plate_within_the_place_is_the_object():
    block = slice(55, 65), slice(75, 85), 0.9
    far = slice(5, 15), slice(75, 85), 0.9  # outside of the radius
    low = slice(55, 65), slice(88, 94), 0.995  # below the floor
    high = slice(66, 70), slice(75, 85), 0.6
    mask = mask_of(depth_with(block, far, low, high))
    expected = np.zeros((120, 160), bool)
    expected[55:65, 75:85] = True
    assert np.array_equal(mask > 0, expected) and set(np.unique(mask)) == {0, 255}
    millimetres = np.rint(1000.0 * depth_with(block, far, low, high)).astype(np.uint16)
    assert np.array_equal(mask_of(millimetres), mask)


def test_holes_without_a_depth_are_the_objects_and_others_are_not():
    block = slice(50, 70), slice(70, 90), 0.9
    no_depth = slice(58, 62), slice(74, 78), np.nan
    through = slice(58, 62), slice(82, 86), 1.0  # The plate is seen through it.
    mask = mask_of(depth_with(block, no_depth, through))
    assert mask[60, 76] == 255 and mask[60, 84] == 0
    assert mask[51:69, 71:73].all()


def test_specks_are_no_part_of_the_object():
    block = slice(50, 70), slice(70, 90), 0.9
    speck = slice(75, 76), slice(80, 81), 0.9
    assert mask_of(depth_with(block, speck))[75, 80] == 0
    assert not mask_of(np.zeros((120, 160), np.float32)).any()


def test_what_leaves_the_image_is_seen():
    mask = np.zeros((10, 12), np.uint8)
    mask[2:8, 3:9] = 255
    assert not touches_border(mask)
    for rows, columns in ((0, 5), (9, 5), (4, 0), (4, 11)):
        there = mask.copy()
        there[rows, columns] = 255
        assert touches_border(there)


def test_a_blurred_image_is_less_sharp():
    rng = np.random.RandomState(1)
    image = rng.randint(0, 255, (40, 40)).astype(np.uint8)
    mask = np.full((40, 40), 255, np.uint8)
    blurred = np.rint((image.astype(float) + np.roll(image, 1, axis=1)) / 2.0).astype(np.uint8)
    assert sharpness(image, mask) > sharpness(blurred, mask) > 0.0
    assert sharpness(image, np.zeros_like(mask)) == 0.0
