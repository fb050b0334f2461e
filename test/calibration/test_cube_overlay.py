"""Poses of calibration boards, and cubes on them, against the truth of what was drawn."""

import itertools

import cv2
import numpy as np
import pytest
from board_views import (
    DOT,
    MARKER,
    SQUARE,
    asymmetric_circles,
    charuco,
    chessboard,
    circles,
)

import robot_vision as rv
from robot_vision.calibration import boards, cube_drawing
from robot_vision.calibration.board_pose import (
    MAX_GAP,
    Orientation,
    quarter_turns,
    solve_pose,
)
from robot_vision.calibration.board_search import BoardParams, BoardSearch, make_board

SIZE = (640, 480)
K = np.array([[520.0, 0.0, 331.0], [0.0, 524.0, 236.0], [0.0, 0.0, 1.0]])
PINHOLE = rv.CameraModel(*SIZE, K)
LENSES = {
    "pinhole": PINHOLE,
    "plumb_bob": rv.CameraModel(*SIZE, K, [-0.22, 0.07, 0.0008, -0.0005, 0.0]),
    "equidistant": rv.CameraModel(*SIZE, K, [0.02, -0.01, 0.004, -0.001], "equidistant"),
}
IMAGES = {
    "chessboard": chessboard(8, 6),
    "circles": circles(8, 6),
    "acircles": asymmetric_circles(4, 9),
    "charuco": charuco(8, 6, "4x4_50"),
}
ON_FLOOR = np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def pose_of(turn, place):
    """The pose of a board that faces the camera and is then turned by a rotation vector."""
    pose = np.eye(4)
    pose[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ cv2.Rodrigues(np.array(turn, float))[0]
    pose[:3, 3] = place
    return pose


def seen(image, pose, camera=PINHOLE, noise=1.0):
    """What a camera sees of the image of a board in this pose: gray, on a gray floor."""
    size = np.array(image.shape[::-1]) / DOT * SQUARE
    floor = rv.FloorScene(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), tuple(size), camera)
    gray = cv2.cvtColor(floor.render(np.linalg.inv(pose @ ON_FLOOR)), cv2.COLOR_BGR2GRAY)
    noisy = gray + np.random.RandomState(1).normal(0.0, noise, gray.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


def params_of(kind, **values):
    size = {"columns": 4, "rows": 9} if kind == "acircles" else {}
    return BoardParams(kind, square=SQUARE, marker=MARKER, **size, **values)


def angle(a, b):
    """The angle between two poses, degrees."""
    return np.degrees(np.linalg.norm(cv2.Rodrigues(a[:3, :3].T @ b[:3, :3])[0]))


def test_poses_are_those_of_the_calibration_scene():
    scene = rv.CalibrationScene(rv.SceneParams())
    board = boards.chessboard(8, 6, 0.05)
    search = BoardSearch(board, 320, 0.25)
    orientation = Orientation(quarter_turns("chessboard", 8, 6, board))
    for frame in range(0, 300, 12):
        gray = cv2.cvtColor(scene.render(frame), cv2.COLOR_BGR2GRAY)
        found = solve_pose(board, search.find(frame, gray), scene.camera)  # each frame a first one
        pose = orientation.continued(2.0 * frame, found.pose)
        truth = scene.truth(frame).objects[0].pose
        assert np.linalg.norm(pose[:3, 3] - truth[:3, 3]) < 0.001
        assert angle(pose, truth) < 0.1
        assert found.error < 0.2


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("kind", IMAGES)
def test_every_board_has_a_pose_through_every_lens(kind, lens):
    truth = pose_of((0.35, -0.3, 0.2), (0.03, -0.02, 0.42))
    params, camera = params_of(kind), LENSES[lens]
    board = make_board(params)
    found = board.find(seen(IMAGES[kind], truth, camera))
    solved = solve_pose(board, found, camera)
    # The middle of a circle that is seen is not quite where the lens shows the circle's middle.
    assert np.linalg.norm(solved.pose[:3, 3] - truth[:3, 3]) < 0.001
    turns = quarter_turns(params.board, params.columns, params.rows, board)
    assert angle(Orientation(turns).continued(0.0, solved.pose), truth) < 0.5
    assert solved.error < 0.5
    if lens != "pinhole":  # as if there were no lens
        assert solve_pose(board, found, PINHOLE).error > 2.0 * solved.error


def test_the_error_is_that_of_the_pixels():
    board = boards.chessboard(8, 6, SQUARE)
    gray = seen(IMAGES["chessboard"], pose_of((0.3, 0.2, 0.1), (0.0, 0.0, 0.4)))
    found = board.find(gray)
    rough = np.random.RandomState(2).normal(0.0, 3.0, found.pixels.shape)
    solved = solve_pose(board, found._replace(pixels=found.pixels + rough), PINHOLE)
    # 96 errors, of which the 6 numbers of the pose take some away.
    assert solved.error == pytest.approx(3.0 * np.sqrt(2.0 * 90 / 96), rel=0.2)


def test_points_on_one_line_have_no_pose():
    board = boards.chessboard(8, 6, SQUARE)
    pixels = np.column_stack([np.linspace(100.0, 500.0, 48), np.full(48, 200.0)])
    solved = solve_pose(board, boards.Observation(board.points, pixels), PINHOLE)
    assert solved is None or solved.error > 10.0
    pixels[3:] = np.nan
    assert solve_pose(board, boards.Observation(board.points, pixels), PINHOLE) is None


@pytest.mark.parametrize(
    "kind, columns, rows, turns",
    [
        ("chessboard", 8, 6, [0, 2]),
        ("chessboard", 7, 6, [0]),
        ("chessboard", 7, 7, [0, 2]),
        ("chessboard", 6, 6, [0, 1, 2, 3]),
        ("circles", 7, 6, [0, 2]),
        ("circles", 5, 5, [0, 1, 2, 3]),
        ("acircles", 4, 11, [0]),
        ("acircles", 4, 10, [0, 2]),
    ],
)
def test_which_turns_leave_a_board_as_it_is(kind, columns, rows, turns):
    board = boards.BOARDS[kind](columns, rows, SQUARE)
    assert quarter_turns(kind, columns, rows, board) == turns
    if kind != "chessboard":
        return
    image = chessboard(columns, rows)
    same = [n for n in range(4) if np.array_equal(np.rot90(image, n), image)]
    assert same == turns


@pytest.mark.parametrize("size", [(8, 6), (6, 6), (7, 6)])
def test_the_orientation_goes_on_while_the_board_is_turned(size):
    board, image = boards.chessboard(*size, SQUARE), chessboard(*size)
    orientation = Orientation(quarter_turns("chessboard", *size, board))
    for step in range(0, 400, 40):
        truth = pose_of((0.0, 0.0, np.radians(step)), (0.0, 0.0, 0.5))
        truth[:3, :3] = cv2.Rodrigues(np.array([0.3, 0.2, 0.0]))[0] @ truth[:3, :3]
        found = solve_pose(board, board.find(seen(image, truth)), PINHOLE)
        assert angle(orientation.continued(step / 400.0, found.pose), truth) < 1.0, step


def test_after_a_gap_up_is_what_is_up_in_the_image():
    orientation = Orientation([0, 2])
    over = pose_of((0.0, 0.0, np.pi), (0.0, 0.0, 0.5))
    upright = pose_of((0.0, 0.0, 0.0), (0.0, 0.0, 0.5))
    for roll in np.linspace(0.0, np.pi, 10):
        last = orientation.continued(roll / 10.0, pose_of((0.0, 0.0, roll), (0.0, 0.0, 0.5)))
    assert angle(last, over) < 0.1
    assert angle(orientation.continued(0.5, over), over) < 0.1
    assert angle(orientation.continued(0.6 + MAX_GAP, over), upright) < 0.1
    assert angle(orientation.continued(0.0, over), upright) < 0.1  # a bag starts again


class Far:
    """A board so far away that it is not found in an image of half the size."""

    board = boards.chessboard(8, 6, SQUARE)

    def __init__(self):
        image = IMAGES["chessboard"]
        self.frames = [
            seen(image, pose_of((0.2, 0.1, 0.0), (x, 0.05, 1.1)), noise=0.5) for x in (0.0, 0.04)
        ]
        self.nothing = np.full(SIZE[::-1], 150, np.uint8)


def test_a_board_far_away_is_found_now_and_then_and_then_followed():
    far, search = Far(), BoardSearch(Far.board, 320, 0.25)
    assert search.find(0.0, far.nothing) is None
    assert search.find(0.1, far.frames[0]) is None  # the full size is not due
    found = search.find(0.3, far.frames[0])
    assert np.array_equal(found.pixels, far.board.find(far.frames[0]).pixels)
    followed = search.find(0.31, far.frames[1])
    assert np.abs(followed.pixels - far.board.find(far.frames[1]).pixels).max() < 0.02
    assert search.find(0.32, far.nothing) is None
    assert search.find(0.33, far.frames[1]) is None
    assert BoardSearch(far.board, 640, 60.0).find(0.0, far.frames[0]) is not None


def test_corners_found_in_a_small_image_are_as_exact():
    board, search = boards.chessboard(8, 6, SQUARE), BoardSearch(Far.board, 240, 60.0)
    gray = seen(IMAGES["chessboard"], pose_of((0.3, -0.2, 0.1), (0.02, 0.0, 0.4)))
    search.find(0.0, np.zeros(SIZE[::-1], np.uint8))  # the full size is not due for a minute
    found, expected = search.find(0.1, gray).pixels, board.find(gray).pixels
    assert np.abs(found - expected).max() < 0.02


def test_what_was_hidden_of_a_board_is_found_within_the_period():
    board = make_board(params_of("charuco"))
    search = BoardSearch(board, 320, 0.25)
    shown = seen(IMAGES["charuco"], pose_of((0.2, 0.1, 0.0), (0.0, 0.0, 0.3)), noise=0.5)
    hidden = shown.copy()
    hidden[:185] = 150  # the upper two of five rows of corners
    everything, part = len(board.points), len(board.find(hidden).points)
    assert len(board.find(shown).points) == everything > part
    counts = [
        len(search.find(time, gray).points)
        for time, gray in ((0.0, hidden), (0.1, hidden), (0.2, shown), (0.36, shown), (0.4, shown))
    ]
    assert counts[:2] == [part, part] and counts[2] < everything  # the full size is not due
    assert counts[3:] == [everything, everything]


def test_a_board_is_found_in_images_of_another_size_than_the_last():
    board = boards.chessboard(8, 6, SQUARE)
    large = np.full((960, 1280), 150, np.uint8)
    small = seen(IMAGES["chessboard"], pose_of((0.2, 0.1, 0.0), (0.0, 0.0, 0.5)))
    large[480:, 640:] = small
    search = BoardSearch(board, 640, 60.0)
    for gray in (large, small, large):
        found = search.find(0.0, gray)
        assert np.abs(found.pixels - board.find(gray).pixels).max() < 0.02


@pytest.mark.parametrize("shape", [(1, 1), (1, 640), (7, 5), (481, 641)])
def test_images_without_a_board_have_none(shape):
    noise = np.random.RandomState(1).randint(100, 110, shape).astype(np.uint8)
    kinds = ("chessboard", "circles", "charuco")
    for image, kind in itertools.product((np.zeros(shape, np.uint8), noise), kinds):
        search = BoardSearch(make_board(params_of(kind)), 320, 0.25)
        assert search.find(0.0, image) is None


def entered_face(camera, pose, edge, pixels):
    """The face by which the rays of pixels, (n, 2), enter a cube: (n,) of 2 * axis + side, or -1.

    By the distances at which each ray crosses the planes of the cube.
    """
    rays = np.column_stack([camera.rays(pixels), np.ones(len(pixels))])
    eye, rays = -pose[:3, :3].T @ pose[:3, 3], rays @ pose[:3, :3]
    low, high = edge * np.array([-0.5, -0.5, 0.0]), edge * np.array([0.5, 0.5, 1.0])
    with np.errstate(divide="ignore"):  # A ray may be parallel to a plane.
        crossings = np.sort([(low - eye) / rays, (high - eye) / rays], axis=0)
    axis = crossings[0].argmax(axis=1)
    hit = crossings[0].max(axis=1) < crossings[1].min(axis=1)
    side = np.take_along_axis(rays, axis[:, None], axis=1)[:, 0] < 0.0
    return np.where(hit, 2 * axis + side, -1)


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize(
    "turn", [(0.5, 0.4, 0.3), (-0.6, 0.3, 2.0), (0.0, 0.0, 0.0), (0.7, -0.6, -1.0)]
)
def test_each_pixel_of_the_cube_shows_the_face_that_its_ray_meets_first(lens, turn):
    camera, edge = LENSES[lens], 3 * SQUARE
    pose = pose_of(turn, (0.05, -0.02, 0.4))
    image = np.zeros((*SIZE[::-1], 3), np.uint8)
    cube_drawing.draw_cube(image, pose, edge, camera)
    x, y = np.meshgrid(np.arange(1, 640, 4), np.arange(1, 480, 4))
    pixels = np.column_stack([x.ravel(), y.ravel()]).astype(float)
    face = entered_face(camera, pose, edge, pixels)
    around = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False))
    shifts = [4.0 * np.array([at.real, at.imag]) for at in around]  # px, to leave out the edges
    inside = np.all(
        [entered_face(camera, pose, edge, pixels + shift) == face for shift in shifts], axis=0
    )
    drawn = image[y.ravel(), x.ravel()]
    assert not drawn[inside & (face < 0)].any()
    colors = [np.unique(drawn[inside & (face == one)], axis=0) for one in range(6)]
    shown = [color for color in colors if len(color)]
    assert all(len(color) == 1 for color in shown)  # each face has one color of its own
    assert len({tuple(color[0]) for color in shown}) == len(shown)
    assert len(colors[5]) == 1  # the face on top, 5, is always seen


def test_the_corners_of_the_cube_are_where_the_lens_shows_them():
    camera, edge = LENSES["plumb_bob"], 3 * SQUARE
    pose = pose_of((0.5, 0.4, 0.3), (0.05, -0.02, 0.4))
    image = np.zeros((*SIZE[::-1], 3), np.uint8)
    cube_drawing.draw_cube(image, pose, edge, camera)
    corners = edge * np.array(list(itertools.product((-0.5, 0.5), (-0.5, 0.5), (0.0, 1.0))))
    pixels, _ = camera.project(corners @ pose[:3, :3].T + pose[:3, 3])
    whites = np.argwhere((image > 250).all(axis=2))[:, ::-1]
    away = np.linalg.norm(pixels[:, None] - whites, axis=2).min(axis=1)
    # One corner of a cube is behind it, and only this one has no edge in sight.
    assert (np.sort(away)[:7] < 1.5).all() and np.sort(away)[7] > 5.0


def test_the_edges_of_the_cube_bend_as_the_lens_bends_them():
    camera, edge = LENSES["plumb_bob"], 0.3
    pose = pose_of((0.0, 0.0, 0.0), (0.0, 0.0, 0.7))
    image = np.zeros((*SIZE[::-1], 3), np.uint8)
    cube_drawing.draw_cube(image, pose, edge, camera)
    whites = np.argwhere((image > 250).all(axis=2))[:, ::-1]
    ends = edge * np.array([[-0.5, 0.5, 1.0], [0.5, 0.5, 1.0]])  # the upper edge of the face on top
    places = np.vstack([ends, ends.mean(axis=0)]) @ pose[:3, :3].T + pose[:3, 3]
    pixels, _ = camera.project(places)
    straight = pixels[:2].mean(axis=0)
    assert np.linalg.norm(pixels[2] - straight) > 4.0
    assert np.linalg.norm(whites - pixels[2], axis=1).min() < 1.0
    assert np.linalg.norm(whites - straight, axis=1).min() > 2.0


def test_axes_end_where_the_lens_shows_their_ends():
    camera, length = LENSES["plumb_bob"], 0.09
    pose = pose_of((0.5, 0.4, 0.3), (0.05, -0.02, 0.4))
    image = np.zeros((*SIZE[::-1], 3), np.uint8)
    cube_drawing.draw_axes(image, pose, length, camera)
    for axis, channel in enumerate((2, 1, 0)):  # x red, y green, z blue
        places = np.array([0.1, 0.5, 0.97, 1.08])[:, None] * length * np.eye(3)[axis]
        pixels, _ = camera.project(places @ pose[:3, :3].T + pose[:3, 3])
        values = [image[y, x, channel] for x, y in np.rint(pixels).astype(int)]
        assert (np.array(values) > 200).tolist() == [True, True, True, False]


@pytest.mark.parametrize("draw", [cube_drawing.draw_cube, cube_drawing.draw_axes])
def test_what_reaches_behind_the_camera_is_not_drawn(draw):
    image = np.zeros((*SIZE[::-1], 3), np.uint8)
    draw(image, pose_of((0.0, 1.2, 0.0), (0.0, 0.0, 0.05)), 0.2, PINHOLE)
    if draw is cube_drawing.draw_cube:
        assert not image.any()
    else:
        assert not image[:, :, 0].any()  # z ends behind the camera


@pytest.mark.parametrize(
    "values, text",
    [
        ({"board": "cheese"}, "board is 'cheese', must be chessboard, circles, acircles or charu"),
        ({"columns": 2}, "columns is 2, must be from 3 to 100"),
        ({"rows": 101}, "rows is 101, must be from 3 to 100"),
        ({"square": 0.0}, "square is 0, must be from 0.0001 to 10"),
        ({"square": float("nan")}, "square is nan, must be from 0.0001 to 10"),
        ({"board": "charuco", "marker": 0.03}, "marker is 0.03, must be below square, 0.025"),
        ({"dictionary": ""}, "dictionary is '', must be one of OpenCV's, such as 4x4_50"),
        ({"search_size": 63}, "search_size is 63, must be from 64 to 8192"),
        ({"search_period": -1.0}, "search_period is -1, must be from 0 to 60"),
    ],
)
def test_boards_that_cannot_be_are_refused(values, text):
    with pytest.raises(ValueError, match=text):
        BoardParams(**values)


def test_a_dictionary_that_opencv_lacks_is_refused():
    with pytest.raises(ValueError, match="dictionary is '9x9_9', must be one of "):
        make_board(params_of("charuco", dictionary="9x9_9"))
