"""Known pairs of cameras, from images of boards, and pairs that cannot be."""

import functools

import cv2
import numpy as np
import pytest
import yaml
from board_views import SQUARE, PairStudio, charuco, chessboard, circles

import robot_vision as rv
from robot_vision.calibration import boards
from robot_vision.calibration.board_pose import quarter_turns
from robot_vision.calibration.boards import Observation
from robot_vision.calibration.camera_file import as_yaml, camera_yaml, read_camera
from robot_vision.calibration.pair_solving import calibrate_pair
from robot_vision.calibration.pair_views import PairCollection
from robot_vision.calibration.same_points import SamePoints
from robot_vision.calibration.solving import calibrate

SIZE = (640, 480)
LENSES = {
    "plumb_bob": (
        ([520, 0, 331, 0, 524, 236, 0, 0, 1], [-0.22, 0.07, 0.0008, -0.0005, 0.0]),
        ([505, 0, 315, 0, 503, 244, 0, 0, 1], [-0.15, 0.03, -0.0006, 0.0004, 0.0]),
    ),
    "equidistant": (
        ([290, 0, 322, 0, 291, 237, 0, 0, 1], [0.02, -0.01, 0.004, -0.001]),
        ([283, 0, 316, 0, 282, 243, 0, 0, 1], [0.03, -0.012, 0.003, -0.0008]),
    ),
}
TURN = cv2.Rodrigues(np.array([0.010, 0.015, -0.012]))[0]  # by 1.2 degrees
PLACE = np.array([0.06, 0.001, -0.002])  # m, of the right camera in the left one's frame
BASELINE = np.linalg.norm(PLACE)
BOARDS = {
    "chessboard": (chessboard(8, 6), boards.chessboard(8, 6, SQUARE)),
    "circles": (circles(8, 6), boards.circles(8, 6, SQUARE)),
}


def cameras_of(model):
    return [rv.CameraModel(*SIZE, K, D, model) for K, D in LENSES[model]]


def collection(kind="chessboard"):
    board = BOARDS[kind][1]
    return PairCollection(board, quarter_turns(kind, 8, 6, board), 60, 6.0)


@functools.lru_cache(maxsize=None)
def collected(kind, model, count=14):
    """The views of so many pairs."""
    to_right = np.eye(4)
    to_right[:3, :3], to_right[:3, 3] = TURN, -TURN @ PLACE
    studio = PairStudio(BOARDS[kind][0], *cameras_of(model), to_right)
    pairs = collection(kind)
    for number in range(count):
        pairs.offer(str(number), studio.pair())
    return pairs


def found_cameras(pairs, model):
    found = [calibrate(pairs.of_camera(side), SIZE, model) for side in (0, 1)]
    return [rv.CameraModel(*SIZE, one.K, one.D, model) for one in found]


def degrees_apart(one, other):
    return np.degrees(np.linalg.norm(cv2.Rodrigues(one.T @ other)[0]))


@pytest.mark.parametrize(
    "kind, model",
    [("chessboard", "plumb_bob"), ("circles", "plumb_bob"), ("chessboard", "equidistant")],
)
def test_a_known_pair_is_found(kind, model):
    """Two lenses that differ, and all of it from the images: the cameras, too."""
    pairs = collected(kind, model)
    assert len(pairs.pairs) > 10 and pairs.size == SIZE
    found = calibrate_pair(pairs.pairs, found_cameras(pairs, model))
    assert found.used.all()
    assert found.pair.geometry.baseline == pytest.approx(BASELINE, rel=0.005)
    assert found.error < 0.2
    assert degrees_apart(found.rotation, TURN) < 0.2


def test_known_cameras_stay_as_they_are_and_tell_more():
    pairs, cameras = collected("chessboard", "plumb_bob"), cameras_of("plumb_bob")
    found = calibrate_pair(pairs.pairs, cameras)
    for camera, rectified in zip(cameras, (found.pair.left, found.pair.right)):
        assert np.array_equal(rectified.model.K, camera.K) and rectified.model.D == camera.D
    assert found.pair.geometry.baseline == pytest.approx(BASELINE, rel=0.001)
    assert degrees_apart(found.rotation, TURN) < 0.02
    assert found.translation == pytest.approx(-TURN @ PLACE, abs=2e-4)


def test_what_the_rectified_images_show_is_in_the_same_rows_and_as_far_as_it_is():
    """Checked by a point, not by the board: the pair against the true cameras."""
    pairs = collected("chessboard", "plumb_bob")
    found = calibrate_pair(pairs.pairs, found_cameras(pairs, "plumb_bob"))
    points = np.random.default_rng(3).uniform((-0.15, -0.1, 0.5), (0.15, 0.1, 1.0), (50, 3))
    of_right = (points - PLACE) @ TURN.T
    places = []
    for of, camera, rectified in zip(
        (points, of_right), cameras_of("plumb_bob"), (found.pair.left, found.pair.right)
    ):
        rays = rectified.model.rays(camera.project(of)[0])
        turned = np.column_stack([rays, np.ones(50)]) @ rectified.R.T
        places.append((turned @ rectified.P[:, :3].T / turned[:, 2:])[:, :2])
    left, right = places
    assert np.abs(left[:, 1] - right[:, 1]).max() < 0.5
    geometry = found.pair.geometry
    depth = geometry.fx * geometry.baseline / (left[:, 0] - right[:, 0] - geometry.offset)
    expected = (points @ found.pair.left.R.T)[:, 2]
    assert depth == pytest.approx(expected, rel=0.01)


def with_right(view, pixels):
    return view._replace(right=view.right._replace(pixels=pixels))


@pytest.mark.parametrize("shift", [(0.0, 2.0), (3.0, 0.0), (40.0, -30.0)])
def test_a_view_that_does_not_fit_the_others_is_refused(shift):
    """Also one that moved along the rows between both images, which no epipolar line tells."""
    views = list(collected("chessboard", "plumb_bob").pairs)
    views[3] = with_right(views[3], views[3].right.pixels + shift)
    found = calibrate_pair(views, cameras_of("plumb_bob"))
    assert np.flatnonzero(~found.used).tolist() == [3]
    assert found.pair.geometry.baseline == pytest.approx(BASELINE, rel=0.002)
    assert found.error < 0.2


def test_images_of_other_moments_are_no_pairs():
    views = collected("chessboard", "plumb_bob").pairs
    later = [with_right(a, b.right.pixels) for a, b in zip(views, views[1:] + views[:1])]
    with pytest.raises(ValueError, match=r"do not fit each other: .* taken at the same moment"):
        calibrate_pair(later, cameras_of("plumb_bob"))


def test_cameras_that_are_swapped_or_in_one_place_are_told():
    views, cameras = collected("chessboard", "plumb_bob").pairs, cameras_of("plumb_bob")
    swapped = [view._replace(left=view.right, right=view.left) for view in views]
    with pytest.raises(ValueError, match=r"swapped: the right camera is 0\.06\d* m to the left"):
        calibrate_pair(swapped, cameras[::-1])
    same = [view._replace(right=view.left) for view in views]
    with pytest.raises(ValueError, match=r"the right camera is at x, y, z = .*, must be beside"):
        calibrate_pair(same, [cameras[0]] * 2)


def test_cameras_above_each_other_are_told():
    """As if both were turned by a quarter turn: what is to the right is below then."""
    turned = []
    for (fx, _, cx, _, fy, cy, *_), (k1, k2, p1, p2, k3) in LENSES["plumb_bob"]:
        matrix = [fy, 0, SIZE[1] - 1 - cy, 0, fx, cx, 0, 0, 1]
        turned.append(rv.CameraModel(SIZE[1], SIZE[0], matrix, [k1, k2, -p2, -p1, k3]))

    def turn(seen):
        x, y = seen.pixels.T
        return seen._replace(pixels=np.column_stack([SIZE[1] - 1 - y, x]))

    views = [
        view._replace(left=turn(view.left), right=turn(view.right))
        for view in collected("chessboard", "plumb_bob").pairs
    ]
    with pytest.raises(
        ValueError, match=r"x, y, z = .*, 0\.06.* m of the left one, must be beside"
    ):
        calibrate_pair(views, turned)


def test_too_few_pairs_are_refused():
    views = collected("chessboard", "plumb_bob").pairs
    with pytest.raises(ValueError, match="4 pairs with the board, 5 are needed at least"):
        calibrate_pair(views[:4], cameras_of("plumb_bob"))


def test_pairs_are_counted_by_what_they_show():
    pairs, gray = collection(), np.full(SIZE[::-1], 128, np.uint8)
    board = cv2.resize(BOARDS["chessboard"][0], None, fx=0.8, fy=0.8)
    shown = gray.copy()
    shown[50 : 50 + board.shape[0], 60 : 60 + board.shape[1]] = board
    for images in ((shown, shown), (shown, shown), (shown, gray), (gray, shown), (gray, gray)):
        pairs.offer("pair", images)
    assert pairs.summary() == (
        "5 pairs: 1 used, 1 with a sharp board in the left image only, 1 in the right one only, "
        "1 in none, 1 like others"
    )
    with pytest.raises(
        ValueError, match=r"1 pairs show the board .*; 1 show it in the left one only, 1 in the"
    ):
        pairs.require_enough()
    small = gray[::2, ::2]
    with pytest.raises(ValueError, match="the left image has 640x480, the right one 320x240"):
        pairs.offer("odd", (gray, small))
    with pytest.raises(ValueError, match="it has 320x240, the images before 640x480"):
        pairs.offer("small", (small, small))


@pytest.mark.parametrize("side", [0, 1])
def test_the_first_board_says_which_size_all_images_have(side):
    pairs, gray = collection(), np.full(SIZE[::-1], 128, np.uint8)
    small = gray[::2, ::2]
    pairs.offer("without", (small, small))
    board = BOARDS["chessboard"][0]
    shown = [gray.copy(), gray.copy()]
    shown[side][50 : 50 + board.shape[0], 60 : 60 + board.shape[1]] = board
    pairs.offer("one", tuple(shown))
    assert pairs.size == SIZE
    with pytest.raises(ValueError, match="it has 320x240, the images before 640x480"):
        pairs.offer("small", (small, small))


def test_what_one_camera_sees_alone_tells_something_about_that_camera():
    pairs, gray = collection(), np.full(SIZE[::-1], 128, np.uint8)
    board = BOARDS["chessboard"][0]
    near, far = (cv2.resize(board, None, fx=scale, fy=scale) for scale in (0.9, 0.4))
    shown = []
    for part in (near, far):
        image = gray.copy()
        image[9 : 9 + part.shape[0], 9 : 9 + part.shape[1]] = part
        shown.append(image)
    pairs.offer("both", (shown[0], shown[0]))
    pairs.offer("right", (gray, shown[1]))
    assert [len(pairs.of_camera(side)) for side in (0, 1)] == [1, 2]


def test_nothing_more_is_waited_for_when_neither_camera_keeps_more():
    board, gray = BOARDS["chessboard"][1], np.full(SIZE[::-1], 128, np.uint8)
    image = cv2.resize(BOARDS["chessboard"][0], None, fx=0.8, fy=0.8)
    shown = gray.copy()
    shown[50 : 50 + image.shape[0], 60 : 60 + image.shape[1]] = image
    turns = quarter_turns("chessboard", 8, 6, board)
    pairs = PairCollection(board, turns, 1, 6.0)
    pairs.offer("left", (shown, gray))
    assert not pairs.full
    pairs.offer("right", (gray, shown))
    assert pairs.full and not pairs.pairs
    pairs = PairCollection(board, turns, 1, 6.0)
    pairs.offer("both", (shown, shown))
    assert pairs.full and len(pairs.pairs) == 1


def observation(board, order):
    """A board of which each point's pixel is its own place, in mm, listed in this order."""
    points = board.points[order]
    return Observation(board.points[: len(order)], 1000.0 * points[:, :2] + (5.0, 7.0))


@pytest.mark.parametrize("kind", ["chessboard", "circles"])
def test_points_are_matched_if_one_image_is_counted_from_the_other_end(kind):
    board = BOARDS[kind][1]
    order = np.arange(len(board.points))
    straight, reverse = observation(board, order), observation(board, order[::-1])
    same = SamePoints(board, quarter_turns(kind, 8, 6, board))
    for left, right in ((straight, straight), (straight, reverse), (reverse, straight)):
        found = same.of(left, right)
        assert np.array_equal(found[0].points, found[1].points)
        assert np.array_equal(found[0].pixels, found[1].pixels)
        assert np.array_equal(found[0].points, left.points)


def test_points_of_a_part_of_a_charuco_board_are_matched():
    board = boards.charuco(8, 6, SQUARE, 0.022, "4x4_50")
    whole = board.find(charuco(8, 6, "4x4_50"))
    left, right = (
        Observation(whole.points[part], whole.pixels[part]) for part in (slice(25), slice(9, 35))
    )
    same = SamePoints(board, [0])
    found = same.of(left, right)
    assert len(found[0].points) == 16
    assert np.array_equal(found[0].pixels, found[1].pixels)
    assert same.of(left, Observation(whole.points[22:], whole.pixels[22:])) is None


def test_the_files_are_camera_info_manager_s_and_can_be_kept(tmp_path):
    found = calibrate_pair(collected("chessboard", "plumb_bob").pairs, cameras_of("plumb_bob"))
    for side, camera in (("left", found.pair.left), ("right", found.pair.right)):
        path = tmp_path / f"{side}.yaml"
        path.write_text(camera_yaml(camera.model, camera.R, camera.P, f"eyes_{side}"))
        written = yaml.safe_load(path.read_text())
        assert written["camera_name"] == f"eyes_{side}"
        assert written["rectification_matrix"]["data"] == camera.R.ravel().tolist()
        assert written["projection_matrix"]["data"] == camera.P.ravel().tolist()
        kept = read_camera(str(path))
        assert (kept.width, kept.height, kept.D) == (*SIZE, camera.model.D)
        assert np.array_equal(kept.K, camera.model.K)
    assert written["projection_matrix"]["data"][3] == pytest.approx(
        -camera.P[0, 0] * BASELINE, rel=0.002
    )


@pytest.mark.parametrize(
    "text, reason",
    [
        ("a: 1", "it is no calibration of a camera"),
        ("- 1", "it is no calibration of a camera"),
        ("a: [", "line 1, column"),
        ("", "it is no calibration of a camera"),
    ],
)
def test_a_file_that_is_no_calibration_is_named(tmp_path, text, reason):
    path = tmp_path / "eye.yaml"
    path.write_text(text)
    with pytest.raises(ValueError) as error:
        read_camera(str(path))
    assert str(error.value).startswith(f"{path}: ") and reason in str(error.value)


def test_the_file_of_a_camera_without_a_model_can_be_kept(tmp_path):
    """Drivers leave the model empty where there is no distortion."""
    path = tmp_path / "eye.yaml"
    camera = rv.CameraModel(*SIZE, np.diag([500.0, 500.0, 1.0]), [], "")
    projection = np.column_stack([np.reshape(camera.K, (3, 3)), np.zeros(3)])
    path.write_text(camera_yaml(camera, np.eye(3), projection, "eye"))
    kept = read_camera(str(path))
    assert (kept.distortion_model, list(kept.D)) == ("plumb_bob", [])


def file_of_an_eye(path):
    camera = rv.CameraModel(*SIZE, np.diag([500.0, 500.0, 1.0]), [0.1, 0, 0, 0, 0], "plumb_bob")
    projection = np.column_stack([np.reshape(camera.K, (3, 3)), np.zeros(3)])
    path.write_text(camera_yaml(camera, np.eye(3), projection, "eye"))
    return path


def test_a_file_that_names_no_model_is_of_plumb_bob(tmp_path):
    """So it is for camera nodes; camera_calibration wrote none before others were there."""
    path = file_of_an_eye(tmp_path / "eye.yaml")
    path.write_text(path.read_text().replace("distortion_model: plumb_bob\n", ""))
    kept = read_camera(str(path))
    assert (kept.distortion_model, list(kept.D)) == ("plumb_bob", [0.1, 0, 0, 0, 0])


@pytest.mark.parametrize(
    "valid, wrong, reason",
    [
        ("cols: 4", "cols: 3", "projection_matrix is 3x3 with 12 numbers, must be 3x4 with as"),
        ("cols: 5", "cols: 4", "distortion_coefficients is 1x4 with 5 numbers, must be 1x0 to"),
        ("rows: 1\n  cols: 5", "rows: -1\n  cols: -5", "distortion_coefficients is -1x-5 with 5"),
        ("cols: 5", "cols: 500000000", "distortion_coefficients is 1x500000000 with 5 numbers"),
        ("cols: 5", "cols: five", "it is no calibration of a camera"),
    ],
)
def test_matrices_of_another_size_are_refused_as_by_a_camera(tmp_path, valid, wrong, reason):
    path = file_of_an_eye(tmp_path / "eye.yaml")
    path.write_text(path.read_text().replace(valid, wrong))
    with pytest.raises(ValueError, match=f"^{path}: {reason}"):
        read_camera(str(path))


def test_a_file_of_a_camera_that_is_not_calibrated_is_named(tmp_path):
    path = tmp_path / "eye.yaml"
    found = calibrate(collected("circles", "plumb_bob").of_camera(0), SIZE, "plumb_bob")
    text = as_yaml(found, "eye")
    data = ", ".join(map(repr, found.K.ravel().tolist()))
    assert data in text
    path.write_text(text.replace(data, ", ".join(["0.0"] * 9)))
    with pytest.raises(ValueError, match=r"eye.yaml: K is 0 everywhere, must be that of a"):
        read_camera(str(path))
