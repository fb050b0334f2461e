"""The simulated robot, its track and its camera, compared with geometry computed otherwise."""

import math

import cv2
import numpy as np
import pytest
from simulation import (
    FLOOR_COLOUR,
    LINE_COLOUR,
    LINE_WIDTH,
    DifferentialDrive,
    FloorCamera,
    TrackWorld,
)
from track import Pose, Segment, Track, course_track

import robot_vision as rv

STRAIGHT = Track([Segment(10.0)], Pose(-5.0, 0.0, 0.0))


def place(pose, tolerance=1e-9):
    return pytest.approx((pose.x, pose.y, pose.heading), abs=tolerance)


def astuple(pose):
    return pose.x, pose.y, pose.heading


@pytest.mark.parametrize("dt", [1.0 / 30.0, 0.5])
@pytest.mark.parametrize("linear, angular", [(0.2, 0.3), (0.2, -0.3), (-0.4, 0.1), (0.3, 1e-12)])
def test_drive_follows_the_circle(linear, angular, dt):
    start = Pose(0.4, -0.2, 0.7)
    robot = DifferentialDrive(start)
    radius = linear / angular
    center = start.x - radius * math.sin(start.heading), start.y + radius * math.cos(start.heading)
    for i in range(1, 61):
        robot.drive(linear, angular, dt)
        heading = start.heading + angular * i * dt
        expected = Pose(
            center[0] + radius * math.sin(heading), center[1] - radius * math.cos(heading), heading
        )
        # The centre of a nearly straight drive's circle is so far away that it is rounded.
        assert astuple(robot.pose) == place(expected, 1e-9 if abs(radius) < 100 else 1e-3)


def test_drive_in_a_line_and_on_the_spot():
    robot = DifferentialDrive(Pose(1.0, 2.0, math.pi / 2))
    for _ in range(30):
        robot.drive(0.2, 0.0, 0.1)
    assert astuple(robot.pose) == place(Pose(1.0, 2.6, math.pi / 2))
    for _ in range(30):
        robot.drive(0.0, -0.5, 0.1)
    assert astuple(robot.pose) == place(Pose(1.0, 2.6, math.pi / 2 - 1.5))


def test_course_track_is_closed_and_has_curves_and_straights():
    track = course_track(0.9)
    assert astuple(track.end) == place(Pose(0.0, 0.0, 2.0 * math.pi))
    assert track.length == pytest.approx(3.0 * math.pi * 0.9 + 4.0 * 0.9 * math.sqrt(0.5))
    assert {np.sign(segment.angle) for segment in track.segments} == {-1.0, 0.0, 1.0}
    bends = [segment for segment in track.segments if segment.angle]
    assert all(segment.length / abs(segment.angle) == pytest.approx(0.9) for segment in bends)


@pytest.mark.parametrize("left", [0.0, 0.03, -0.2, 0.5, -0.5])
def test_places_beside_the_track(left):
    track = course_track()
    before = 0.0
    for start, segment in zip(track.starts, track.segments):
        for part in (0.01, 0.3, 0.7, 0.99):
            on = start.along_arc(part * segment.length, part * segment.angle)
            x, y = on.x - left * math.sin(on.heading), on.y + left * math.cos(on.heading)
            progress = before + part * segment.length
            assert track.lateral_error(x, y) == pytest.approx(left)
            assert track.progress(x, y) == pytest.approx(progress)
            assert track.reversed().lateral_error(x, y) == pytest.approx(-left)
            assert track.reversed().progress(x, y) == pytest.approx(track.length - progress)
            assert track.mirrored().lateral_error(x, -y) == pytest.approx(-left)
            assert track.mirrored().progress(x, -y) == pytest.approx(progress)
        before += segment.length


def test_places_are_continuous_at_the_joints():
    track = course_track()
    random = np.random.RandomState(3)
    for dtype in (np.float64, np.float32):
        for start in track.starts:
            across = random.uniform(-0.3, 0.3, 1000)
            x = (start.x - across * math.sin(start.heading)).astype(dtype)
            y = (start.y + across * math.cos(start.heading)).astype(dtype)
            assert np.allclose(track.locate(x, y)[0], across, atol=1e-5)


def test_points_beyond_an_open_end_have_no_place():
    track = Track([Segment(1.0), Segment(1.0, math.pi / 2)])
    for x, y in ((-0.01, 0.0), (1.0 + 2.0 / math.pi, 2.0 / math.pi + 0.01)):
        assert math.isnan(track.lateral_error(x, y))
        assert math.isnan(track.progress(x, y))


def test_far_points_may_be_left_out_but_near_ones_are_not():
    track = course_track()
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-1, 4, 90), np.linspace(-1, 3, 90)))
    everywhere, near = track.locate(x, y)[0], track.locate(x, y, within=0.1)[0]
    assert not np.isnan(everywhere).any()
    beside = np.abs(everywhere) <= 0.1
    assert 200 < beside.sum() < 2000
    assert np.array_equal(near[beside], everywhere[beside])
    assert np.isnan(near[~beside]).all()


def projected(camera, robot, points):
    """Projects points on the floor, (n, 3) in the world, with cv2: (n, 2) px."""
    cos, sin = math.cos(robot.heading), math.sin(robot.heading)
    forward, left, up = np.array([cos, sin, 0.0]), np.array([-sin, cos, 0.0]), np.array([0, 0, 1.0])
    axis = math.cos(camera.pitch) * forward - math.sin(camera.pitch) * up
    rotation = np.array([-left, np.cross(axis, -left), axis])  # optical: right, down, ahead
    eye = np.array([robot.x, robot.y, 0.0]) + camera.forward * forward + camera.above * up
    center = (camera.width - 1) / 2.0, (camera.height - 1) / 2.0
    matrix = np.array([[camera.focal, 0, center[0]], [0, camera.focal, center[1]], [0, 0, 1.0]])
    return cv2.projectPoints(points, cv2.Rodrigues(rotation)[0], -rotation @ eye, matrix, None)[0][
        :, 0
    ]


def share_of_line(image):
    """The share of each pixel that is line, computed from its blue."""
    return (FLOOR_COLOUR[0] - image[:, :, 0].astype(float)) / (FLOOR_COLOUR[0] - LINE_COLOUR[0])


@pytest.mark.parametrize("robot", [Pose(), Pose(0.3, 0.05, -0.3), Pose(-1.0, -0.1, 0.4)], ids=str)
def test_line_is_where_the_camera_projects_it(robot):
    camera = FloorCamera()
    share = share_of_line(TrackWorld(STRAIGHT, camera, noise=0.0).render(robot))
    ends = robot.x + 0.3, robot.x + 1.3
    points = [(x, y, 0.0) for y in (LINE_WIDTH / 2, -LINE_WIDTH / 2) for x in ends]
    edges = projected(camera, robot, np.array(points)).reshape(2, 2, 2)
    widths, middles = [], []  # errors, px
    for row in range(camera.height):
        left, right = (
            near[0] + (row - near[1]) * (far[0] - near[0]) / (far[1] - near[1])
            for near, far in edges
        )
        if left < 2.0 or right > camera.width - 3.0:
            continue
        widths.append(share[row].sum() - (right - left))
        middle = (share[row] * np.arange(camera.width)).sum() / share[row].sum()
        middles.append(middle - (left + right) / 2.0)
    assert len(widths) > 60
    # The error is larger where a row changes from one resolution of the floor to the next.
    for errors, usual in ((widths, 0.1), (middles, 0.1)):
        assert np.percentile(np.abs(errors), 98) < usual and np.max(np.abs(errors)) < 0.7


def test_line_ends_where_its_track_ends():
    robot = Pose()
    world = TrackWorld(Track([Segment(0.4)]), noise=0.0)
    middle = share_of_line(world.render(robot))[:, 160]
    (end,) = projected(world.camera, robot, np.array([[0.4, 0.0, 0.0]]))
    assert np.argmax(middle > 0.5) == pytest.approx(end[1], abs=1.0)
    assert ((middle > 0.02) & (middle < 0.98)).sum() <= 4
    assert {middle.min(), middle.max()} == {0.0, 1.0}


def test_hsv_range_of_the_line_follower_finds_the_line_only():
    robot = Pose(0.0, 0.04, 0.2)
    share = share_of_line(TrackWorld(STRAIGHT, noise=0.0).render(robot))
    for frame in range(20):
        image = TrackWorld(STRAIGHT, noise=2.0).render(robot, frame)
        mask = cv2.inRange(cv2.cvtColor(image, cv2.COLOR_BGR2HSV), (0, 35, 0), (57, 255, 255))
        assert mask[share > 0.5].all()
        assert not mask[share == 0.0].any()


def test_images_are_the_same_for_the_same_frame_and_seed():
    robot = Pose(0.1, 0.02, 0.1)
    world = TrackWorld(course_track(), noise=4.0, seed=7)
    image = world.render(robot, 3)
    assert image.shape == (240, 320, 3) and image.dtype == np.uint8
    again = TrackWorld(course_track(), noise=4.0, seed=7).render(robot, 3)
    assert np.array_equal(again, image)
    assert np.array_equal(world.render(robot, 3, top=180), image[180:])
    clean = TrackWorld(course_track(), noise=0.0).render(robot, 3).astype(int)
    for other in (world.render(robot, 4), TrackWorld(course_track(), noise=4.0).render(robot, 3)):
        assert (other != image).mean() > 0.8
        assert (other - clean).std() == pytest.approx(4.0, rel=0.05)
        assert abs((other - clean).mean()) < 0.1


def test_floor_is_seen_through_a_lens():
    """The points of a white square on black are where OpenCV projects them."""
    matrix, distortion = (
        np.array([[300.0, 0, 160], [0, 300.0, 120], [0, 0, 1]]),
        [-0.2, 0.05, 0.001, -0.002],
    )
    floor = np.zeros((400, 400, 3), np.uint8)
    floor[100:300, 100:300] = 255
    scene = rv.FloorScene(
        floor, (2.0, 2.0), rv.CameraModel(320, 240, matrix, distortion), (0, 0, 0)
    )
    looking_down = np.array([[0.0, -1, 0, 0.02], [-1, 0, 0, -0.03], [0, 0, -1, 1.5], [0, 0, 0, 1]])
    image = scene.render(looking_down)
    assert image.shape == (240, 320, 3)
    xs, ys = np.meshgrid(np.linspace(-0.9, 0.9, 40), np.linspace(-0.9, 0.9, 40))
    points = np.stack([xs.ravel(), ys.ravel(), np.zeros(xs.size)], axis=1)
    inverse = np.linalg.inv(looking_down)
    pixels = cv2.projectPoints(
        points, cv2.Rodrigues(inverse[:3, :3])[0], inverse[:3, 3], matrix, np.array(distortion)
    )[0][:, 0]
    inside = ((pixels >= 1) & (pixels <= [318, 238])).all(axis=1)
    clear = (np.abs(np.abs(points[:, :2]) - 0.5) > 0.03).all(axis=1) & inside
    assert clear.sum() > 500
    expected = (np.abs(points[:, :2]) < 0.5).all(axis=1)
    for (x, y), white in zip(np.rint(pixels[clear]).astype(int), expected[clear]):
        assert (image[y, x] == (255 if white else 0)).all(), (x, y)


@pytest.mark.parametrize(
    "floor, size, camera, match",
    [
        (np.zeros((4, 4), np.uint8), (1, 1), np.eye(4), "bgr8 image"),
        (np.zeros((4, 4, 3), np.uint8), (0, 1), np.eye(4), r"size is 0, must be positive \(m\)"),
        (np.zeros((4, 4, 3), np.uint8), (1, 1), np.eye(3), "expected a 4x4 pose of the camera"),
    ],
)
def test_invalid_floors_are_refused(floor, size, camera, match):
    model = FloorCamera().model()
    with pytest.raises(ValueError, match=match):
        rv.FloorScene(floor, size, model).render(camera)


def test_camera_must_not_see_the_horizon():
    with pytest.raises(ValueError, match=r"pitch is 0.3, the horizon would be in view"):
        FloorCamera(pitch=0.3)
