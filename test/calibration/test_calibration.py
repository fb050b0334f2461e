"""Known cameras, from images of every kind of board."""

import functools
from dataclasses import replace

import cv2
import numpy as np
import pytest
import yaml
from board_views import (
    BLACK,
    DOT,
    MARKER,
    SQUARE,
    WHITE,
    Studio,
    asymmetric_circles,
    charuco,
    chessboard,
    circles,
    marker,
)

import robot_vision as rv
from robot_vision.calibration import boards, solving
from robot_vision.calibration.boards import Observation
from robot_vision.calibration.camera_file import as_yaml, default_path
from robot_vision.calibration.coverage import UNSEEN, coverage_image, seen_cells
from robot_vision.calibration.headless_steps import UNSURE, is_unsure, parameters_report
from robot_vision.calibration.solving import calibrate
from robot_vision.calibration.views import ViewCollection, describe, edge_width
from robot_vision.dashboard.calibration_result import result_of

SIZE = (640, 480)
K = np.array([[520.0, 0.0, 331.0], [0.0, 524.0, 236.0], [0.0, 0.0, 1.0]])
WIDE = np.array([[290.0, 0.0, 322.0], [0.0, 291.0, 237.0], [0.0, 0.0, 1.0]])
CAMERAS = {
    "plumb_bob": rv.CameraModel(*SIZE, K, [-0.22, 0.07, 0.0008, -0.0005, 0.0]),
    "rational_polynomial": rv.CameraModel(
        *SIZE, K, [0.21, -0.04, 0.0006, -0.0004, 0.01, 0.42, 0.02, 0.0], "rational_polynomial"
    ),
    "equidistant": rv.CameraModel(*SIZE, WIDE, [0.02, -0.01, 0.004, -0.001], "equidistant"),
}
DICTIONARY = "4x4_50"
BOARDS = {
    "chessboard": (chessboard(8, 6), boards.chessboard(8, 6, SQUARE)),
    "circles": (circles(8, 6), boards.circles(8, 6, SQUARE)),
    "acircles": (asymmetric_circles(4, 9), boards.asymmetric_circles(4, 9, SQUARE)),
    "charuco": (
        charuco(8, 6, DICTIONARY),
        boards.charuco(8, 6, SQUARE, MARKER, DICTIONARY),
    ),
}


@functools.lru_cache(maxsize=None)
def collected(kind, model, count=16, seed=1):
    """The views of so many frames."""
    image, board = BOARDS[kind]
    studio = Studio(image, CAMERAS[model], seed)
    views = ViewCollection(board, 60, 6.0)
    for number in range(count):
        views.offer(str(number), studio.frame())
    return views


def numbers(camera):
    """fx, fy, cx, cy and D."""
    return np.array([*camera.K[[0, 1, 0, 1], [0, 1, 2, 2]], *camera.D])


def solved(views, model, **options):
    return calibrate([view.observation for view in views.views], views.size, model, **options)


def disagreement(found, truth, views):
    """How far apart, px, two cameras see 95 % of the points where the board was seen, at most.

    Elsewhere nothing holds a model with many coefficients.
    """
    seen = seen_cells([view.observation for view in views.views], SIZE)
    x, y = np.meshgrid(np.linspace(-1.0, 1.0, 21), np.linspace(-1.0, 1.0, 21))
    rays = np.stack([x.ravel(), y.ravel(), np.ones(x.size)], axis=1)
    pixels, _ = truth.project(rays)
    inside = ((pixels >= 0.0) & (pixels < SIZE)).all(axis=1)
    rays, pixels = rays[inside], pixels[inside]
    column, row = (pixels / SIZE * seen.shape[::-1]).astype(int).T
    camera = rv.CameraModel(*SIZE, found.K, found.D, found.model)
    apart = np.linalg.norm(camera.project(rays)[0] - pixels, axis=1)
    return np.percentile(apart[seen[row, column]], 95)


@pytest.mark.parametrize("model", CAMERAS)
@pytest.mark.parametrize("kind", BOARDS)
def test_a_known_camera_is_found(kind, model):
    """K within 0.5 %, although OpenCV finds points a little amiss where a lens bends much."""
    truth, views = CAMERAS[model], collected(kind, model)
    found = solved(views, model)
    assert (found.model, found.size) == (model, SIZE)
    error = np.abs(numbers(found) - numbers(truth))
    assert (error[:4] < 0.005 * numbers(truth)[[0, 1, 0, 1]]).all()
    assert found.error < 0.3
    assert disagreement(found, truth, views) < 1.0 + 10.0 * found.error


@functools.lru_cache(maxsize=None)
def projected(model, tilt, seed=1, count=6):
    """Views of a chessboard, by `tilt` rad to any side, whose corners are off by 0.1 px."""
    random, camera = np.random.RandomState(seed), CAMERAS[model]
    points, focal = BOARDS["chessboard"][1].points, camera.K[[0, 1], [0, 1]]
    middle, views = points.mean(axis=0), []
    while len(views) < count:
        axis, distance = random.uniform(0.0, 2.0 * np.pi), random.uniform(0.4, 0.8) * focal[0] / 520
        turn = cv2.Rodrigues(tilt * np.array([np.cos(axis), np.sin(axis), 0.0]))[0]
        place = distance * np.append((random.uniform(0.0, SIZE) - camera.K[:2, 2]) / focal, 1.0)
        pixels, _ = camera.project((points - middle) @ turn.T + place)
        if ((pixels > 0.0) & (pixels < SIZE)).all():
            views.append(Observation(points, pixels + random.normal(0.0, 0.1, pixels.shape)))
    return views


@pytest.mark.parametrize("model", CAMERAS)
def test_the_deviations_are_those_of_the_results(model):
    """Of K, as many different coefficients of rational_polynomial are almost the same lens."""
    truth, scores = numbers(CAMERAS[model])[:4], []
    for seed in range(12):
        found = calibrate(projected(model, 0.5, seed), SIZE, model)
        scores.append((numbers(found)[:4] - truth) / found.deviations[:4])
    assert 0.8 < np.sqrt(np.mean(np.square(scores))) < 1.25


@pytest.mark.parametrize("model", CAMERAS)
def test_a_board_that_was_tilted_tells_the_focal_length(model):
    found = calibrate(projected(model, 0.5, count=12), SIZE, model)
    assert not is_unsure(found) and result_of(found)["advice"] == ""


@pytest.mark.parametrize(
    "model, tilt",
    [
        ("plumb_bob", 0.0),
        ("plumb_bob", 0.01),
        ("rational_polynomial", 0.0),
        ("equidistant", 0.02),  # with less no camera is found
    ],
)
def test_a_board_that_was_never_tilted_does_not_tell_the_focal_length(model, tilt):
    """Nor how far away it was: a wrong focal length has no large error."""
    found = calibrate(projected(model, tilt, count=12), SIZE, model)
    off = abs(found.K[0, 0] - CAMERAS[model].K[0, 0])
    assert found.error < 0.2 and off < 3.0 * found.deviations[0]
    assert is_unsure(found) and result_of(found)["advice"] == UNSURE


def test_what_the_views_do_not_determine_is_infinite():
    random = np.random.default_rng(1)
    jacobian, residuals = random.normal(size=(40, 3)), random.normal(size=(20, 2))
    jacobian[:, 1] = 2.0 * jacobian[:, 0]  # of the first two only a sum is known
    deviations = solving._deviations(
        [jacobian[:15], jacobian[15:]], [residuals[:10], residuals[10:]]
    )
    first, last = jacobian[:, 0], jacobian[:, 2]
    alone = last - first * (first @ last) / (first @ first)
    variance = (residuals**2).sum() / (40 - 3 - 2 * 6)
    assert np.isinf(deviations[:2]).all()
    assert deviations[2] == pytest.approx(np.sqrt(variance / (alone @ alone)))


def test_what_the_views_do_not_determine_is_told():
    found = solved(collected("circles", "plumb_bob"), "plumb_bob")
    deviations = found.deviations.copy()
    deviations[:2] = np.inf
    found = replace(found, deviations=deviations)
    lines = parameters_report(found)
    assert lines[1] == f"  fx {found.K[0, 0]:.6g} px, which the views do not determine"
    assert " +- " in lines[3] and is_unsure(found)


def test_k3_is_0_unless_it_is_asked_for():
    views = collected("circles", "plumb_bob")
    without, with_it = solved(views, "plumb_bob"), solved(views, "plumb_bob", third=True)
    assert without.D[4] == without.deviations[8] == 0.0
    assert with_it.D[4] != 0.0 and with_it.deviations[8] > 0.0


def test_only_what_tells_something_new_is_kept():
    image, board = BOARDS["chessboard"]
    studio, views = Studio(image, CAMERAS["plumb_bob"]), ViewCollection(board, 3, 6.0)
    frame = studio.frame()
    moved = cv2.filter2D(frame, -1, np.full((1, 15), 1.0 / 15.0))  # while it was taken
    for gray in (frame, frame, moved, np.full(SIZE[::-1], 128, np.uint8)):
        views.offer("frame", gray)
    assert views.summary() == "4 images: 1 used, 1 without the board, 1 blurred, 1 like others"
    while not views.full:
        views.offer("more", studio.frame())
    assert len(views.views) == 3
    with pytest.raises(ValueError, match="it has 320x240, the images before 640x480"):
        views.offer("small", frame[::2, ::2])


def test_an_image_without_the_board_does_not_say_which_size_the_others_have():
    image, board = BOARDS["chessboard"]
    views = ViewCollection(board, 3, 6.0)
    views.offer("cover", np.full((100, 200), 128, np.uint8))
    assert views.size is None
    views.offer("frame", Studio(image, CAMERAS["plumb_bob"]).frame())
    assert views.summary() == "2 images: 1 used, 1 without the board, 0 blurred, 0 like others"
    assert views.size == SIZE


@pytest.mark.parametrize("direction", [(1, 15), (15, 1)])
def test_blur_is_measured_whatever_its_direction(direction):
    image, board = BOARDS["acircles"]
    frame = Studio(image, CAMERAS["plumb_bob"]).frame()
    pixels = board.find(frame).pixels
    moved = cv2.filter2D(frame, -1, np.full(direction, 1.0 / 15.0))
    assert edge_width(frame, pixels) < 4.5 < 9.0 < edge_width(moved, pixels)


@pytest.mark.parametrize(
    "light", [lambda x: 0.06, lambda x: 0.15 + 0.85 * x], ids=["dark", "shade on one side"]
)
def test_chessboards_are_found_in_bad_light(light):
    image, board = BOARDS["chessboard"]
    studio, shade = Studio(image, CAMERAS["plumb_bob"]), light(np.linspace(0.0, 1.0, SIZE[0]))
    for _ in range(5):
        assert board.find(np.rint(studio.frame() * shade).astype(np.uint8)) is not None


def seen_at(x, y, z, turn=0.0):
    """A chessboard, its middle there (m), turned around its upright axis (rad): its description."""
    points = np.array([[i % 8 - 3.5, i // 8 - 2.5, 0.0] for i in range(48)]) * SQUARE
    turned = points @ cv2.Rodrigues(np.array([0.0, turn, 0.0]))[0].T + [x, y, z]
    return describe(Observation(points, CAMERAS["plumb_bob"].project(turned)[0]), SIZE)


def test_views_are_described_by_place_size_and_tilt():
    middle = seen_at(0.0, 0.0, 0.5)
    assert np.allclose(middle[:2], 0.5, atol=0.06) and np.allclose(middle[3:], 0.0, atol=0.05)
    left, low, far = seen_at(-0.1, 0.0, 0.5), seen_at(0.0, 0.08, 0.5), seen_at(0.0, 0.0, 1.0)
    assert left[0] < middle[0] - 0.2 and left[1] == pytest.approx(middle[1], abs=0.02)
    assert low[1] > middle[1] + 0.2 and low[0] == pytest.approx(middle[0], abs=0.02)
    assert far[2] == pytest.approx(middle[2] / 2.0, rel=0.05)


def test_opposite_tilts_are_different_views():
    left, right = seen_at(0.0, 0.0, 0.5, -0.5), seen_at(0.0, 0.0, 0.5, 0.5)
    assert np.abs(left - right)[:4].sum() < 0.1 < 0.2 < np.abs(left - right).sum()


def test_a_part_of_a_charuco_board_is_enough():
    image, board = BOARDS["charuco"]
    frame = Studio(image, CAMERAS["plumb_bob"]).frame()
    whole = board.find(frame)
    x = int(np.median(whole.pixels[:, 0]))
    frame[:, x:] = 128
    part = board.find(frame)
    assert 6 <= len(part.points) < len(whole.points)
    at = {tuple(point): pixel for point, pixel in zip(whole.points.tolist(), whole.pixels)}
    for point, pixel in zip(part.points.tolist(), part.pixels):
        assert np.linalg.norm(at[tuple(point)] - pixel) < 1.0


@pytest.mark.parametrize("first", [BLACK, WHITE])
@pytest.mark.parametrize("size", [(8, 6), (7, 4), (5, 10)])
def test_charuco_boards_of_old_and_new_opencv_are_found(size, first):
    """Whole, with every corner in its place, whichever OpenCV has printed them."""
    columns, rows = size
    image = charuco(columns, rows, DICTIONARY, first)
    found = boards.charuco(columns, rows, SQUARE, MARKER, DICTIONARY).find(image)
    places = (found.points - found.points.min(axis=0))[:, :2] / SQUARE
    if np.corrcoef(places[:, 1], found.pixels[:, 1])[0, 1] < 0:  # before 4.6 their y is upwards
        places[:, 1] = places[:, 1].max() - places[:, 1]
    assert len({tuple(place) for place in np.rint(places)}) == (columns - 1) * (rows - 1)
    assert np.allclose(found.pixels, DOT * (places + 1.5) - 0.5, atol=1.0)


@pytest.mark.parametrize("number", [3, 17])
@pytest.mark.parametrize("size", [(8, 6), (5, 8), (7, 5)])
def test_strange_markers_cost_no_charuco_view(size, number):
    """Nor a corner: one of another board, with a number that this one has too."""
    columns, rows = size
    board = boards.charuco(columns, rows, SQUARE, MARKER, DICTIONARY)
    studio = Studio(charuco(columns, rows, DICTIONARY), CAMERAS["plumb_bob"])
    compared = 0
    for frame in (studio.frame() for _ in range(10)):
        expected = board.find(frame)
        if expected is None:
            continue
        compared += 1
        strange = frame.copy()
        strange[2:46, 2:46] = WHITE
        strange[8:40, 8:40] = marker(number, DICTIONARY, 32)
        found = board.find(strange)
        assert found is not None
        away = np.linalg.norm(expected.pixels[:, None] - found.pixels, axis=2).min(axis=1)
        assert np.count_nonzero(away < 0.5) > 0.9 * len(away)
    assert compared >= 8


def test_charuco_markers_that_fit_two_patterns_are_no_board():
    """Two rows of markers that are not neighbours: either pattern has them, at another place."""
    image = charuco(8, 6, DICTIONARY)
    image[DOT // 2 + DOT : DOT // 2 + 2 * DOT] = image[DOT // 2 + 3 * DOT :] = WHITE
    assert BOARDS["charuco"][1].find(image) is None


def test_too_few_views_are_refused():
    with pytest.raises(ValueError, match="2 views of the board, 5 are needed at least"):
        solved(collected("circles", "plumb_bob", 2), "plumb_bob")


@pytest.mark.parametrize("model", CAMERAS)
def test_corners_that_are_no_numbers_fit_no_camera(model):
    views = [
        view._replace(pixels=np.full_like(view.pixels, np.nan)) for view in projected(model, 0.5)
    ]
    with pytest.raises(ValueError, match="the views do not fit a camera"):
        calibrate(views, SIZE, model)


@pytest.mark.parametrize(
    "words, reason",
    [
        ((8, 6, SQUARE, MARKER, "9x9_50"), "dictionary is '9x9_50', must be one of .*4x4_50"),
        ((12, 12, SQUARE, MARKER, "4x4_50"), "dictionary 4x4_50 has 50 markers, the board 72"),
    ],
)
def test_charuco_boards_that_cannot_be(words, reason):
    with pytest.raises(ValueError, match=reason):
        boards.charuco(*words)


def test_opencv_without_aruco_is_named(monkeypatch):
    monkeypatch.delattr(cv2, "aruco")
    with pytest.raises(ValueError, match=r"OpenCV .* has no aruco, which ChArUco boards need"):
        boards.charuco(8, 6, SQUARE, MARKER, DICTIONARY)


def test_coverage_shows_where_the_board_was():
    observation = Observation(
        np.zeros((3, 3)), np.array([[5.0, 5.0], [300.0, 5.0], [300.0, 200.0]])
    )
    seen = seen_cells([observation], SIZE)
    assert seen.sum() == 3 and seen[0, 0] and seen[0, 4] and seen[3, 4]
    image = coverage_image([observation, observation], np.array([0.1, 0.1]), SIZE)
    assert image.shape == (480, 640, 3)
    assert tuple(image[470, 630]) == UNSEEN
    assert image[200, 300, 1] > 150 > image[200, 300, 2]  # a green dot


def test_the_file_is_camera_info_manager_s(monkeypatch):
    found = solved(collected("circles", "equidistant"), "equidistant")
    with pytest.raises(ValueError, match="K is -1, must be above 0"):
        as_yaml(replace(found, K=np.diag([-1.0, 1.0, 1.0])), "none")
    with pytest.raises(ValueError, match="P is nan, must be finite"):
        as_yaml(replace(found, P=np.full((3, 4), np.nan)), "none")
    written = yaml.safe_load(as_yaml(found, "no: 1"))
    assert (written["image_width"], written["image_height"]) == SIZE
    assert (written["camera_name"], written["distortion_model"]) == ("no: 1", "equidistant")
    for name, values in [
        ("camera_matrix", found.K),
        ("distortion_coefficients", found.D[None]),
        ("rectification_matrix", np.eye(3)),
        ("projection_matrix", found.P),
    ]:
        assert (written[name]["rows"], written[name]["cols"]) == values.shape
        assert written[name]["data"] == values.ravel().tolist()
    monkeypatch.setenv("ROS_HOME", "/home/of/ros")
    assert default_path("eye") == "/home/of/ros/camera_info/eye.yaml"
    monkeypatch.delenv("ROS_HOME")
    monkeypatch.setenv("HOME", "/home/me")
    assert default_path("eye") == "/home/me/.ros/camera_info/eye.yaml"
