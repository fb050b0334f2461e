"""A camera is calibrated by camera_calibration, and its images are rectified by image_proc."""

import re
import shutil
import subprocess

import cv2
import numpy as np
import pytest
import rospy
import support
import yaml
from sensor_msgs.msg import CameraInfo, Image
from sensor_msgs.srv import SetCameraInfo, SetCameraInfoResponse

from robot_vision import CalibrationScene, SceneParams
from robot_vision.calibration.boards import chessboard
from robot_vision.calibration.camera_file import as_yaml
from robot_vision.calibration.solving import Calibration, calibrate

BUTTON = (155, 155, 80)  # BGR, of one that can be pressed
CORNERS = (8, 6)
SHOWN = ["_source:=synthetic", "_scene:=calibration", "__name:=usb_cam"]


def buttons(screen):
    """The middles, [(x, y), ...], of the buttons that can be pressed: one below another."""
    mask = np.uint8((support.screen(screen) == BUTTON).all(axis=2))
    x, y, side, height = cv2.boundingRect(mask)
    return [(x + side // 2, y + side * i + side // 2) for i in range(round(height / max(side, 1)))]


def press(screen, number, of):
    """Presses one of so many buttons once they can be pressed."""
    support.wait_for(lambda: len(buttons(screen)) == of, f"{of} buttons", 120.0)
    at = map(str, buttons(screen)[number])
    subprocess.run(["xdotool", "mousemove", *at, "click", "1"], check=True)


def corners_of(message):
    """(6, 8, 2) px, or None if the whole board is not in the image."""
    rows = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
    found, corners = cv2.findChessboardCorners(rows, CORNERS)
    if not found:
        return None
    end = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 30, 0.001)
    return cv2.cornerSubPix(rows, corners, (5, 5), (-1, -1), end).reshape(6, 8, 2)


def bend(corners):
    """The largest RMS distance of a row or column from its straight line, px."""

    def residual(line):
        return np.linalg.svd(line - line.mean(axis=0), compute_uv=False)[1] / np.sqrt(len(line))

    return max(map(residual, [*corners, *corners.swapaxes(0, 1)]))


def bends(raw, rectified, count):
    """Of so many boards in different poses, before and after: (count, 2) px."""
    topics = [support.Messages(topic, Image) for topic in (raw, rectified)]
    boards = []

    def look():
        pair = support.same_frame(*topics)
        board = [corners_of(message) for message in pair]
        new = all(corners is not None for corners in board) and not any(
            np.allclose(board, old, atol=2.0) for old in boards
        )
        if new:
            boards.append(board)
        return len(boards) == count

    support.wait_for(look, f"{count} boards on {raw} and {rectified}")
    for topic in topics:
        topic.close()
    return np.array([[bend(corners) for corners in board] for board in boards])


def uncertainty():
    """The standard deviations of D by as many views as the calibrator asks for at least."""
    params = SceneParams()
    params.rate = 2.0  # each frame another pose
    scene, board = CalibrationScene(params), chessboard(*CORNERS, 0.05)
    views = [board.find(cv2.cvtColor(scene.render(i), cv2.COLOR_BGR2GRAY)) for i in range(12)]
    return calibrate(views, (640, 480), "plumb_bob").deviations[4:]


def test_from_the_board_to_straight_lines(start, display, tmp_path):
    """calibrate.launch as people use it, the next start of the camera, and rectify.launch."""
    roslaunch, kept = shutil.which("roslaunch"), tmp_path / "kept.yaml"
    shown = [*SHOWN, f"_camera_info_url:=file://{kept}"]  # or the scene knows it without
    camera = start("camera_node", *shown)
    rospy.wait_for_service("/usb_cam/set_camera_info", support.DEADLINE)
    calibrator = start(roslaunch, "robot_vision", "calibrate.launch")
    press(display, 0, of=1)  # CALIBRATE
    press(display, 2, of=3)  # COMMIT
    calibrator.exit_code()
    camera.interrupt()
    assert camera.exit_code() == 0
    assert kept.exists(), calibrator.output()

    start("camera_node", *shown)
    infos = support.Messages("/usb_cam/camera_info", CameraInfo)
    info, truth = infos.wait()[0], CalibrationScene().camera
    infos.close()
    assert np.allclose(info.K, truth.K.ravel(), rtol=0.005)
    assert info.D != truth.D
    assert (np.abs(np.subtract(info.D, truth.D)) <= 4.0 * uncertainty()).all()

    start(roslaunch, "robot_vision", "rectify.launch")
    before, after = bends("/usb_cam/image_mono", "/usb_cam/image_rect", 5).T
    assert after.max() < 0.1 and before.mean() > 3.0 * after.mean()
    color = support.Messages("/usb_cam/image_rect_color", Image).wait()[0]
    assert (color.encoding, color.header.frame_id) == ("bgr8", "head_camera")


def test_a_pair_is_calibrated_together_in_the_window(start, display, tmp_path):
    """calibrate_stereo.launch as people use it: both views get the same P, but for the baseline."""
    kept = [tmp_path / f"head_camera_{side}.yaml" for side in ("left", "right")]
    small = ["_views:=stereo", "_image_width:=320", "_image_height:=240", "_framerate:=10"]
    camera = start(
        "camera_node", *SHOWN, *small, f"_camera_info_url:=file://{tmp_path}/${{NAME}}.yaml"
    )
    rospy.wait_for_service("/usb_cam/right/set_camera_info", support.DEADLINE)
    calibrator = start(shutil.which("roslaunch"), "robot_vision", "calibrate_stereo.launch")
    press(display, 0, of=1)  # CALIBRATE
    press(display, 2, of=3)  # COMMIT
    calibrator.exit_code()
    assert all(path.exists() for path in kept), calibrator.output() + camera.output()
    left, right = (
        np.reshape(yaml.safe_load(path.read_text())["projection_matrix"]["data"], (3, 4))
        for path in kept
    )
    assert np.allclose(left[:, :3], right[:, :3]) and not left[:, 3].any()
    params = SceneParams()
    params.width, params.height = 320, 240
    baseline = CalibrationScene(params).view_pose("right")[0, 3]
    assert -right[0, 3] / right[0, 0] == pytest.approx(baseline, rel=0.01)


ERRORS = r"Linearity RMS Error: ([\d.]+) Pixels +Reprojection RMS Error: ([\d.]+) Pixels"


@pytest.mark.skipif(not hasattr(np, "product"), reason="cameracheck.py is older than this NumPy")
def test_cameracheck_tells_how_good_a_calibration_is(start, tmp_path):
    """First of a calibration that has no distortion, then of the right one.

    At 2 Hz each frame shows the board in another pose, so that five are not all in the middle of
    the image, where both calibrations are good.
    """
    truth, kept = CalibrationScene().camera, tmp_path / "kept.yaml"
    flat = np.zeros(5)
    wrong = Calibration(
        (640, 480), "plumb_bob", truth.K, flat, projection(truth.K), flat, 0.0, flat
    )
    kept.write_text(as_yaml(wrong, "head_camera"))
    start("camera_node", *SHOWN, "_framerate:=2", f"_camera_info_url:=file://{kept}")
    unbuffered = {"PYTHONUNBUFFERED": "1"}
    check = start(shutil.which("roslaunch"), "robot_vision", "cameracheck.launch", env=unbuffered)

    def errors():
        """Linearity and reprojection, px, of each image in which the board was found."""
        return np.array(re.findall(ERRORS, check.output()), float).reshape(-1, 2)

    support.wait_for(lambda: len(errors()) >= 5, "errors of the wrong calibration", 60.0)
    before = np.median(errors(), axis=0)
    right = CameraInfo(width=640, height=480, distortion_model="plumb_bob")
    right.K, right.P, right.D = truth.K.ravel(), projection(truth.K).ravel(), truth.D
    right.R = np.eye(3).ravel()
    assert rospy.ServiceProxy("/usb_cam/set_camera_info", SetCameraInfo)(right).success
    last = {}

    def small():
        last["errors"] = np.median(errors()[-5:], axis=0)
        return (last["errors"] < 0.1).all()

    support.wait_for(small, "small errors of the right calibration", 60.0)
    assert (before > 3.0 * last["errors"]).all()


def projection(matrix):
    return np.hstack([matrix, np.zeros((3, 1))])


def test_a_camera_in_the_root_namespace_is_found(start, display):
    service = rospy.Service("/set_camera_info", SetCameraInfo, lambda _: SetCameraInfoResponse())
    command = ["roslaunch", "robot_vision", "calibrate.launch", "image:=/image_raw"]
    calibrator = start(shutil.which(command[0]), *command[1:], env={"PYTHONUNBUFFERED": "1"})
    calibrator.wait_for_output("/set_camera_info ...\nOK\n")
    service.shutdown()
