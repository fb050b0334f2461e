"""A calibration as the dashboard runs it: what it says of each frame, and what it finds."""

import threading

import cv2
import numpy as np
import pytest
import support
import yaml
from board_views import MARKER, SQUARE, Studio, asymmetric_circles, charuco, circles
from std_msgs.msg import Header

from robot_vision import CalibrationScene, SceneParams
from robot_vision.calibration.board_search import BoardParams
from robot_vision.calibration.boards import Observation
from robot_vision.calibration.view_progress import is_enough, view_progress
from robot_vision.dashboard import board_watch, calibration_run
from robot_vision.dashboard.calibration_feature import NOBODY, CalibrationFeature
from robot_vision.dashboard.calibration_run import CalibrationRun
from robot_vision.dashboard.settings import Settings
from robot_vision.ros.transport import Frame

TOPIC = "/eye/image_raw"
BOARD = BoardParams(board="chessboard", columns=8, rows=6, square=0.05)
COUNT = 12


class Hub:
    """An ImageHub whose frames are given by the test, in its thread."""

    def __init__(self):
        self.callbacks = []

    def watch(self, topic, callback):
        assert topic == TOPIC
        self.callbacks.append(callback)
        return self

    def close(self):
        self.callbacks.pop()

    def give(self, image, encoding="bgr8"):
        for callback in self.callbacks:
            callback(Frame(image, encoding, Header()))


@pytest.fixture(scope="module")
def scene():
    params = SceneParams()
    params.rate = 2.0  # each frame another pose
    return CalibrationScene(params)


@pytest.fixture(scope="module")
def images(scene):
    return [scene.render(number) for number in range(COUNT)]


@pytest.fixture(autouse=True)
def no_waiting(monkeypatch):
    monkeypatch.setattr(calibration_run, "MIN_PERIOD", 0.0)
    monkeypatch.setattr(board_watch, "KEPT_TIME", 0.0)


@pytest.fixture
def hub():
    return Hub()


class Told(list):
    """The states that were told, also when the run went on or paused."""

    of_frame = (
        None  # the number of the one that is told of the newest frame, after it was looked at
    )


@pytest.fixture
def start(hub):
    runs = []

    def begin(params=BOARD, model="plumb_bob"):
        told = Told()
        run = CalibrationRun(TOPIC, params, model, hub, told.append)
        look = run._watch.look

        def noted(frame):
            look(frame)
            told.of_frame = len(told)

        run._watch.look = noted
        runs.append(run)
        run.resume()
        return run, told

    yield begin
    for run in runs:
        run.close()


def shown(run, told, hub, image, encoding="bgr8"):
    """The state after the run has looked at an image."""
    told.of_frame = None
    hub.give(image, encoding)
    support.wait_for(lambda: told.of_frame is not None and told[told.of_frame :], "a state")
    return told[told.of_frame]


def solved(run, told):
    run.solve()
    return support.wait_for(lambda: told[-1]["result"] and told[-1], "a result")


def test_from_the_first_board_to_the_camera(start, hub, images, scene):
    run, told = start()
    assert run.state()["state"] == f"waiting for images of {TOPIC}"
    for number, image in enumerate(images, 1):
        state = shown(run, told, hub, image)
        assert state["views"] >= min(number, 5) and state["size"] == [640, 480]
        assert len(state["corners"]) == 48
    assert state["progress"]["x"] > 0.3 and state["progress"]["skew"] > 0.3
    found = solved(run, told)["result"]
    saved = yaml.safe_load(found["yaml"])
    truth = scene.camera
    assert np.allclose(saved["camera_matrix"]["data"], truth.K.ravel(), rtol=0.005)
    assert np.allclose(saved["distortion_coefficients"]["data"], truth.D, atol=0.02)
    assert 0.0 < found["error"] < 0.3
    assert found["lines"][0] == "plumb_bob, 640x480"
    assert found["lines"][1].startswith(f"  fx {truth.K[0, 0]:.6g}"[:7])
    assert found["lines"][-1] == f"reprojection error: {found['error']:.3f} px"
    assert not found["unsure"] and found["advice"] == ""


def test_corners_are_where_the_board_is(start, hub, images):
    run, told = start()
    state = shown(run, told, hub, images[0])
    gray = cv2.cvtColor(images[0], cv2.COLOR_BGR2GRAY)
    truth = cv2.findChessboardCorners(gray, (8, 6))[1].reshape(-1, 2)
    assert np.abs(np.array(state["corners"]) - truth).max() < 1.0
    cells = np.zeros((8, 10), bool)
    for x, y in truth:
        cells[int(y / 480 * 8), int(x / 640 * 10)] = True
    assert np.count_nonzero(np.array(state["coverage"]) != cells) <= 2  # corners on the border
    assert np.array(state["coverage"]).shape == (8, 10)


def test_each_frame_is_told_in_words(start, hub, images):
    run, told = start()
    blurred = cv2.GaussianBlur(images[0], (0, 0), 5.0)
    state = shown(run, told, hub, blurred)
    assert state["state"] == "hold it still: the image is blurred" and state["views"] == 0
    assert len(state["corners"]) == 48  # shown all the same
    state = shown(run, told, hub, np.full((480, 640, 3), 128, np.uint8))
    assert (state["state"], state["corners"]) == ("no board in the image", [])
    assert shown(run, told, hub, images[0])["state"] == "kept view 1"
    state = shown(run, told, hub, images[0])
    assert state["state"] == "this view is like one before: move the board, or tilt it"
    assert state["views"] == 1
    state = shown(run, told, hub, images[1][::2, ::2].copy())
    assert "cannot be used: it has 320x240, the images before 640x480" in state["state"]
    assert shown(run, told, hub, images[1])["state"] == "kept view 2"


HOSTILE_IMAGES = {
    "of one pixel": (np.zeros((1, 1, 3), np.uint8), "bgr8"),
    "of one row": (np.zeros((1, 640), np.uint8), "mono8"),
    "of depths": (np.zeros((48, 64), np.float32), "32FC1"),
    "of another encoding": (np.zeros((48, 64), np.uint8), "bgr8"),
    "of an unknown encoding": (np.zeros((48, 64), np.uint8), "mono7\n\x1b"),
    "of 16 bits": (np.zeros((48, 64), np.uint16), "mono16"),
}


@pytest.mark.parametrize("hostile", HOSTILE_IMAGES.values(), ids=list(HOSTILE_IMAGES))
def test_images_of_no_use_are_told_in_a_line_and_harm_nothing(start, hub, images, hostile):
    run, told = start()
    state = shown(run, told, hub, *hostile)
    assert state["state"].isprintable() and state["views"] == 0 and state["corners"] == []
    fresh, told = start()
    shown(fresh, told, hub, images[0])
    state = shown(fresh, told, hub, *hostile)
    assert state["views"] == 1 and state["size"] == [640, 480] and state["corners"] == []
    assert shown(fresh, told, hub, images[1])["views"] == 2


def test_too_few_views_are_not_solved(start, hub, images):
    run, told = start()
    for image in images[:4]:
        shown(run, told, hub, image)
    with pytest.raises(ValueError, match="4 views of the board, 5 are needed at least"):
        run.solve()
    with pytest.raises(ValueError, match="there is no result yet: solve first"):
        run.commit()


def test_a_result_ends_the_subscription_and_more_views_continue_it(start, hub, images):
    run, told = start()
    for image in images[:6]:
        shown(run, told, hub, image)
    assert len(hub.callbacks) == 1
    solved(run, told)
    support.wait_for(lambda: not hub.callbacks, "the end of the subscription")
    run.resume()
    assert not hub.callbacks
    assert run.state()["state"] == "the camera is computed"
    run.more()
    assert hub.callbacks and run.state()["result"] is None and run.state()["views"] == 6
    assert shown(run, told, hub, images[6])["views"] == 7


def test_a_pause_keeps_the_views(start, hub, images):
    run, told = start()
    shown(run, told, hub, images[0])
    run.pause()
    assert not hub.callbacks and run.state()["views"] == 1
    run.resume()
    assert shown(run, told, hub, images[1])["views"] == 2
    run.close()
    assert not hub.callbacks
    run.resume()
    assert not hub.callbacks


def test_views_that_fit_no_camera_are_a_problem_in_words(start, hub, images, monkeypatch):
    run, told = start()
    for image in images[:5]:
        shown(run, told, hub, image)

    def fail(*_):
        raise ValueError("the views do not fit a camera (plumb_bob)")

    monkeypatch.setattr(calibration_run, "calibrate", fail)
    run.solve()
    support.wait_for(lambda: not told[-1]["solving"], "the end")
    assert told[-1]["state"] == "the views do not fit a camera (plumb_bob)"
    assert told[-1]["result"] is None and hub.callbacks
    monkeypatch.undo()
    assert solved(run, told)["result"]


def test_frames_that_come_meanwhile_are_not_kept(start, hub, images, monkeypatch):
    """Only the newest waits: however fast frames come, no queue grows."""
    run, told = start()
    looked = []
    look = run._watch.look
    entered, go = threading.Event(), threading.Event()

    def slow(frame):
        looked.append(frame.image)
        entered.set()
        assert go.wait(support.DEADLINE)
        look(frame)

    monkeypatch.setattr(run._watch, "look", slow)
    hub.give(images[0])
    assert entered.wait(support.DEADLINE)
    for image in images[1:5]:
        hub.give(image)
    go.set()
    support.wait_for(lambda: told and told[-1]["views"] == 2, "two views")
    assert [id(image) for image in looked] == [id(images[0]), id(images[4])]


class Session:
    """One that controls, and keeps what it is told."""

    id, role = 1, "control"

    def __init__(self):
        self.told = []

    def on_close(self, callback):
        pass

    def push(self, kind, data):
        self.told.append((kind, data))


def test_no_state_is_told_of_a_run_that_was_stopped_meanwhile(hub, monkeypatch):
    """Its thread has made the state before, and comes to tell it after that nobody calibrates."""
    state = CalibrationRun.state
    made, go = threading.Event(), threading.Event()

    def slow(run):
        found = state(run)
        if threading.current_thread() is run._thread:
            made.set()
            assert go.wait(support.DEADLINE)
        return found

    monkeypatch.setattr(CalibrationRun, "state", slow)
    feature, session = CalibrationFeature(Settings(), hub), Session()
    do = {one.name: one.run for one in feature.operations}
    board = {**vars(BOARD), "kind": BOARD.board, "topic": TOPIC, "model": "plumb_bob"}
    do["calibration_start"](session, board)
    thread = feature._run._thread
    assert made.wait(support.DEADLINE)
    do["calibration_stop"](session, {})
    go.set()
    thread.join(support.DEADLINE)
    assert session.told == [("calibration", NOBODY)]


@pytest.mark.parametrize(
    "board, image",
    [
        (BoardParams("circles", 7, 5, SQUARE), circles(7, 5)),
        (BoardParams("acircles", 4, 7, SQUARE), asymmetric_circles(4, 7)),
        (BoardParams("charuco", 7, 5, SQUARE, MARKER, "4x4_50"), charuco(7, 5, "4X4_50")),
    ],
    ids=["circles", "acircles", "charuco"],
)
def test_other_boards_are_found_and_no_other_is_taken_for_them(
    start, hub, scene, images, board, image
):
    run, told = start(board)
    state = shown(run, told, hub, Studio(image, scene.camera).frame(), "mono8")
    assert state["state"] == "kept view 1" and len(state["corners"]) >= 20
    assert state["settings"]["kind"] == board.board
    blank = np.full((480, 640), 200, np.uint8)
    assert shown(run, told, hub, blank, "mono8")["state"] == "no board in the image"


def quad(x, y, side, lean=0.0):
    """A view of a square board with its corners there, px; `lean` shears it."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    pixels = np.array([[x, y], [x + side, y], [x + side + lean, y + side], [x + lean, y + side]])
    return Observation(points, pixels)


def test_progress_is_that_of_camera_calibration():
    """Ranges of 0.7 of the place, 0.4 of the size and 0.5 of the skew are enough."""
    size = (1000, 1000)
    assert view_progress([], size) == {"x": 0.0, "y": 0.0, "size": 0.0, "skew": 0.0}
    one = view_progress([quad(0, 0, 200)], size)
    assert one == {"x": 0.0, "y": 0.0, "size": pytest.approx(0.5), "skew": pytest.approx(0.0)}
    # Of the 800 px that a board of 200 px can move it has moved 280 across, and all along.
    two = view_progress([quad(0, 0, 200), quad(280, 800, 200)], size)
    assert two["x"] == pytest.approx(0.35 / 0.7) and two["y"] == 1.0
    # Sheared by 45 degrees the skew is 2 * pi / 4, at most 1.
    assert view_progress([quad(0, 0, 200, 200)], size)["skew"] == 1.0
    assert view_progress([quad(0, 0, 900)], size)["size"] == 1.0


def test_enough_is_all_of_it_or_many_views():
    full = dict.fromkeys(["x", "y", "size", "skew"], 1.0)
    assert is_enough(full, 5) and is_enough(dict(full, x=0.1), 40)
    assert not is_enough(dict(full, x=0.99), 39)
