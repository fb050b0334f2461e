"""Tables with the noise of every sensor against the truth, and as messages, markers and overlay."""

import functools
import re

import numpy as np
import pytest
import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import Header
from table_world import (
    BOXES,
    MIDDLE,
    NOISE,
    TABLE,
    UP,
    box_pose,
    camera_of,
    render_depth,
    table_pose,
)
from tag_studio import matrix_of
from visualization_msgs.msg import Marker

import robot_vision as rv
from robot_vision.depth.box_covariance import EDGE_ERROR, UNKNOWN, box_covariance
from robot_vision.depth.depth_overlay import depth_gray
from robot_vision.depth.depth_range import NEAREST, within
from robot_vision.depth.table_markers import markers
from robot_vision.depth.table_messages import object_array, table_array, transforms
from robot_vision.depth.table_overlay import draw_tables
from robot_vision.msg import Table, TableArray

CAMERA = camera_of(320)
BENT = (-0.1, 0.02, 0.001, -0.001, 0.0)
# As NOISE in table_world, but with a focal length of 272 px.
WORLD_NOISE = {"none": 0.0005, "kinect": 0.004, "stereo": 0.008, "tof": 0.001}
ALIKE = {"stereo": 2.0}  # errors that are alike in blocks of pixels bend planes: as larger ones
FLYING = {"stereo": 0.01, "tof": 0.01}  # m, by which pixels that mix two surfaces move the middle
HEADER = Header(stamp=rospy.Time(1), frame_id="eye")


def finder_of(camera, noise=0.0005, **values):
    planes, params = rv.PlaneParams(), rv.TabletopParams()
    planes.noise = noise
    for name, value in values.items():
        setattr(params, name, value)
    return rv.TabletopFinder(camera, planes, params)


@functools.lru_cache(maxsize=None)
def exact_tables():
    """The tables of the exact world without a floor, and the labels of what stands on them."""
    return finder_of(CAMERA).find(render_depth(CAMERA, floor=None), UP)


def degrees_between(a, b):
    return np.degrees(np.arccos(np.clip(a @ b, -1.0, 1.0)))


@pytest.mark.parametrize("lens", [(), BENT], ids=["pinhole", "bent"])
@pytest.mark.parametrize("sensor", WORLD_NOISE)
def test_a_table_and_its_boxes_are_where_they_are(sensor, lens):
    """The plane within 2 mm and 0.2 degrees.

    A plane that is fitted to n pixels with errors of sigma is wrong by sigma / sqrt(n), and its
    tilt by that over its extent: of the noisiest sensor 0.1 mm and 0.03 degrees.
    """
    camera = camera_of(320, lens)
    measured = rv.DepthNoise(sensor, camera).apply(0, render_depth(camera))
    tables, labels = finder_of(camera, WORLD_NOISE[sensor]).find(measured, UP)
    table, truth = tables[0], table_pose()
    plane = table.plane
    assert abs(MIDDLE @ plane.normal + plane.distance) < 0.002
    assert degrees_between(plane.normal, UP) < 0.2
    sigma = WORLD_NOISE[sensor] * MIDDLE[2] ** 2 + 0.001
    assert np.linalg.norm(table.pose[:3, 3] - MIDDLE) < 0.015 + sigma
    assert np.abs(np.subtract(table.size, TABLE)).max() < 0.03 + 2.0 * sigma
    assert table.pose[:3, 0] @ truth[:3, 0] > 0.999
    assert len(table.objects) == len(BOXES)
    for box in BOXES:
        expected = box_pose(box)
        found = min(
            table.objects, key=lambda thing: np.linalg.norm(thing.pose[:3, 3] - expected[:3, 3])
        )
        # Noise moves sides outwards, which are where the outermost pixels are.
        beyond = 2.0 * sigma + FLYING.get(sensor, 0.0)
        assert np.linalg.norm(found.pose[:3, 3] - expected[:3, 3]) < 0.01 + beyond
        assert np.all(found.size > np.array(box.size) - 0.01 - sigma)
        assert np.all(found.size < np.array(box.size) + 0.01 + 4.0 * beyond)
        assert found.pixels <= (labels > 0).sum()
        if sensor == "none":
            assert found.pose[:3, 0] @ expected[:3, 0] > 0.99


@pytest.mark.parametrize("sensor", NOISE)
def test_the_floor_of_the_scene_is_a_table_that_things_stand_on(sensor):
    scene, frame = rv.Scene(), 30
    camera, view = scene.view_camera("depth"), scene.view_pose("depth")
    measured = rv.DepthNoise(sensor, camera).apply(frame, scene.render_depth(frame))
    truth = scene.truth(frame)
    eye = truth.camera @ view  # the depth camera in the world, whose z is up
    up, height = eye[2, :3], eye[2, 3]
    noise = NOISE[sensor] * ALIKE.get(sensor, 1.0)
    tables, _ = finder_of(camera, noise).find(measured, up)
    plane = min(tables, key=lambda table: abs(table.plane.distance - height)).plane
    assert abs(plane.distance - height) < 0.002
    assert degrees_between(plane.normal, up) < 0.2
    things = [thing for table in tables for thing in table.objects]
    (box,) = (thing for thing in truth.objects if thing.name == "box")
    place = (np.linalg.inv(view) @ box.pose)[:3, 3]
    found = min(things, key=lambda thing: np.linalg.norm(thing.pose[:3, 3] - place))
    sigma = NOISE[sensor] * place[2] ** 2 + 0.001
    assert np.linalg.norm(found.pose[:3, 3] - place) < 0.04 + 2.0 * sigma
    assert found.size[2] == pytest.approx(0.28, abs=0.02 + 2.0 * sigma)
    # The walls that the floor ends at stand on nothing.
    assert all(thing.size.max() < 1.5 for thing in things)


def test_depths_that_count_are_within_a_range():
    millimetres = np.array([[0, 9, 10, 2000, 2001, 65535]], np.uint16)
    kept = within(millimetres, 2.0)
    assert kept.dtype == np.uint16 and kept.tolist() == [[0, 0, 10, 2000, 0, 0]]
    assert millimetres[0, 5] == 65535
    metres = np.float32([[np.nan, np.inf, -np.inf, -1.0, 0.0, 1e-40, 0.5, 2.0, 2.1, 1e38]])
    kept = within(metres, 2.0)
    assert kept.dtype == np.float32
    assert np.isnan(kept[0]).tolist() == [True] * 6 + [False, False] + [True] * 2
    assert kept[0, 6:8].tolist() == [0.5, 2.0] and NEAREST == 0.01


def test_the_error_of_a_box_is_along_its_ray_and_across():
    pose = table_pose()
    pose[:3, 3] = 0.2, -0.1, 2.0
    found = box_covariance(pose, (0.3, 0.1, 0.2), (1.0, 0.5), CAMERA, 0.01)
    assert np.allclose(found, found.T, atol=0.0) and (np.linalg.eigvalsh(found) > 0.0).all()
    assert found[2, 2] == pytest.approx(0.01**2)
    across = EDGE_ERROR * 2.0 / CAMERA.K[0, 0]
    assert found[0, 0] == pytest.approx(across**2 + (0.1 * 0.01) ** 2)
    assert found[1, 1] == pytest.approx(across**2 + (0.05 * 0.01) ** 2)
    own = pose[:3, :3].T @ found[3:, 3:] @ pose[:3, :3]
    error = np.hypot(0.01, across)
    expected = [(2.0 * error / lever) ** 2 for lever in (0.5, 0.5, 0.3 - 0.1)]
    assert own == pytest.approx(np.diag(expected), abs=1e-12)
    assert not found[:3, 3:].any()


@pytest.mark.parametrize("size", [(0.1, 0.1, 0.2), (0.0, 0.0, 0.2)])
def test_a_box_without_a_longer_side_has_no_direction(size):
    pose = table_pose()
    found = box_covariance(pose, size, (0.0, 0.0), CAMERA, 0.01)
    own = pose[:3, :3].T @ found[3:, 3:] @ pose[:3, :3]
    assert own == pytest.approx(UNKNOWN * np.eye(3), abs=1e-12)


def test_messages_of_tables_are_those_of_ork_s_clients():
    """They know a message by its md5 sum, whatever the package is called."""
    assert Table._md5sum == "39efebc7d51e44bd2d72f2df6c7823a2"
    assert TableArray._md5sum == "d1c853e5acd0ed273eb6682dc01ab428"


def test_the_hull_is_in_the_frame_of_its_table():
    (table,), _ = exact_tables()
    (message,) = table_array(HEADER, [table]).tables
    assert message.header == HEADER
    pose = matrix_of(message.pose)
    assert pose == pytest.approx(table.pose, abs=1e-9)
    corners = np.array([(corner.x, corner.y, corner.z) for corner in message.convex_hull])
    assert len(corners) >= 4 and not corners[:, 2].any()
    assert corners @ pose[:3, :3].T + pose[:3, 3] == pytest.approx(table.plane.hull, abs=1e-9)
    # The smallest rectangle around it has its middle at the origin.
    assert corners[:, :2].max(axis=0) == pytest.approx(np.array(table.size) / 2.0, abs=1e-6)
    assert corners[:, :2].min(axis=0) == pytest.approx(-np.array(table.size) / 2.0, abs=1e-6)
    sides = np.roll(corners, -1, axis=0) - corners
    # Each corner turns left, and the origin is left of each side: counter-clockwise around it.
    assert (np.cross(sides, -corners)[:, 2] > 0.0).all()


def test_objects_of_all_tables_are_detections():
    tables, labels = exact_tables()
    noise = rv.PlaneParams()
    found = object_array(HEADER, tables, CAMERA, noise)
    assert found.header == HEADER and len(found.detections) == 2
    for number, (message, thing) in enumerate(zip(found.detections, tables[0].objects), 1):
        assert (message.label, message.id, message.score) == ("object", -1, 1.0)
        assert (message.frame_id, message.has_orientation) == ("", True)
        box = message.box
        assert (box.x_offset, box.y_offset, box.width, box.height) == thing.box
        assert message.pixels == thing.pixels == (labels == number).sum()
        assert matrix_of(message.pose.pose) == pytest.approx(thing.pose, abs=1e-9)
        assert (message.size.x, message.size.y, message.size.z) == tuple(thing.size)
        deviation = noise.noise * thing.pose[2, 3] ** 2 + noise.min_noise
        expected = box_covariance(thing.pose, thing.size, tables[0].size, CAMERA, deviation)
        assert np.reshape(message.pose.covariance, (6, 6)) == pytest.approx(expected)


def test_frames_of_tables_are_counted():
    tables, _ = exact_tables()
    found = transforms(HEADER, "desk", [tables[0], tables[0]]).transforms
    assert [transform.child_frame_id for transform in found] == ["desk_0", "desk_1"]
    for transform in found:
        assert transform.header == HEADER
        assert matrix_of(transform.transform) == pytest.approx(tables[0].pose, abs=1e-9)


def test_markers_are_hulls_axes_boxes_and_sizes():
    tables, _ = exact_tables()
    table, things = tables[0], tables[0].objects
    made = markers(HEADER, tables).markers
    by_name = {(marker.ns, marker.id): marker for marker in made}
    names = {("tables", 0), ("axes", 0)}
    names |= {(kind, number) for kind in ("objects", "sizes") for number in range(2)}
    assert by_name.keys() == names and len(made) == len(names)
    for marker in made:
        assert marker.header == HEADER and marker.action == Marker.ADD
        assert marker.lifetime.to_sec() > 0.0 and marker.color.a > 0.0
    hull, axes = by_name["tables", 0], by_name["axes", 0]
    assert hull.type == Marker.LINE_STRIP and hull.points[0] == hull.points[-1]
    assert hull.points[:-1] == table_array(HEADER, tables).tables[0].convex_hull
    assert axes.type == Marker.LINE_LIST and len(axes.points) == len(axes.colors) == 6
    assert axes.points[::2] == [Point()] * 3 and axes.points[5].z > 0.0
    for marker in (hull, axes):
        assert matrix_of(marker.pose) == pytest.approx(table.pose, abs=1e-9)
        assert marker.scale.x > 0.0
    for number, thing in enumerate(things):
        box, text = by_name["objects", number], by_name["sizes", number]
        assert box.type == Marker.CUBE
        assert (box.scale.x, box.scale.y, box.scale.z) == tuple(thing.size)
        assert matrix_of(box.pose) == pytest.approx(thing.pose, abs=1e-9)
        assert text.type == Marker.TEXT_VIEW_FACING and text.scale.z > 0.0
        assert re.fullmatch(rf"{number}: \d\.\d\d x \d\.\d\d x \d\.\d\d m", text.text)
        above = (matrix_of(text.pose) - thing.pose)[:3, 3] @ UP
        assert above > thing.size[2] / 2.0


def test_no_tables_are_empty_messages():
    assert table_array(HEADER, []).tables == []
    assert object_array(HEADER, [], CAMERA, rv.PlaneParams()).detections == []
    assert markers(HEADER, []).markers == [] and transforms(HEADER, "table", []).transforms == []


def test_depths_are_drawn_bright_where_they_are_near():
    metres = np.float32([[np.nan, 0.5, 1.0, 4.0, 100.0, np.inf]])
    drawn = depth_gray(metres, 4.0)
    assert (drawn.shape, drawn.dtype) == ((1, 6, 3), np.uint8)
    assert (drawn == drawn[:, :, :1]).all()
    none, near, farther, end, beyond, nowhere = drawn[0, :, 0].astype(int)
    assert none == nowhere == 0 < beyond == end < farther < near
    millimetres = np.array([[0, 500, 1000, 4000]], np.uint16)
    assert np.array_equal(depth_gray(millimetres, 4.0), drawn[:, :4])


def test_objects_are_tinted_where_they_are_and_hulls_and_boxes_drawn():
    tables, labels = exact_tables()
    before = depth_gray(render_depth(CAMERA, floor=None), 5.0)
    drawn = before.copy()
    draw_tables(drawn, tables, labels, CAMERA)
    colored = (drawn != drawn[:, :, :1]).any(axis=2)
    assert colored[labels > 0].mean() > 0.95
    for points in (tables[0].plane.hull, [thing.pose[:3, 3] for thing in tables[0].objects]):
        for x, y in np.rint(CAMERA.project(np.array(points))[0]).astype(int):
            assert colored[max(y - 1, 0) : y + 2, max(x - 1, 0) : x + 2].any()
    untouched = before.copy()
    draw_tables(untouched, [], labels, CAMERA)
    assert np.array_equal(untouched, before)


def garbage():
    """Images that no camera makes, by their names."""
    rng = np.random.default_rng(7)
    shape = CAMERA.height, CAMERA.width
    floats = rng.standard_normal(shape).astype(np.float32)
    huge = (10.0 ** rng.uniform(-44, 38, shape)).astype(np.float32)
    holes = render_depth(CAMERA)
    holes[rng.random(shape) < 0.5] = np.nan
    stripes = np.full(shape, np.inf, np.float32)
    stripes[::3] = 1.0
    return {
        "noise in mm": rng.integers(0, 65536, shape, np.uint16),
        "noise in m": floats,
        "huge and tiny": huge,
        "half of it": holes,
        "stripes": stripes,
        "a wall at the lens": np.full(shape, 0.01, np.float32),
        "nothing": np.full(shape, np.nan, np.float32),
    }


@pytest.mark.parametrize("what", garbage())
def test_no_message_of_any_image_has_a_number_that_is_none(what):
    image = within(garbage()[what], 100.0)
    for up in (UP, (0.0, 0.0, 0.0), (1e-300, 0.0, 0.0), (0.0, 0.0, -1e200)):
        found, labels = finder_of(CAMERA, min_pixels=1, min_table_area=0.0).find(image, up)
        messages = [
            table_array(HEADER, found),
            object_array(HEADER, found, CAMERA, rv.PlaneParams()),
            markers(HEADER, found),
            transforms(HEADER, "table", found),
        ]
        for message in messages:
            assert not re.search(r"\b(nan|inf)\b", str(message))
        draw_tables(depth_gray(image, 5.0), found, labels, CAMERA)
