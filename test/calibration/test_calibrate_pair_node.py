"""calibrate_headless.py --stereo: from files, a bag and a camera, and clear errors."""

import itertools
import os
import pathlib
import re

import cv2
import numpy as np
import pytest
import rosbag
import rospy
import support
import yaml
from frames import message
from sensor_msgs.msg import CameraInfo, Image
from sensor_msgs.srv import SetCameraInfo, SetCameraInfoResponse

from robot_vision import CalibrationScene, CameraModel, SceneParams
from robot_vision.calibration.calibrate_headless import main
from robot_vision.calibration.camera_file import camera_yaml

BASELINE = 0.1  # m, of the scene's pair
TOPICS = LEFT, RIGHT = "/eyes/left/image_raw", "/eyes/right/image_raw"
SIDES = ("left", "right")
BOARD = ["--stereo", "--size", "8x6", "--square", "0.05"]
LIVE = ["--left", LEFT, "--right", RIGHT]
COUNT = 12  # of which both images show the board in more than five


@pytest.fixture(scope="module")
def pairs():
    params = SceneParams()
    params.rate = 2.0  # each frame another pose
    scene = CalibrationScene(params)
    return [(scene.render(i), scene.render(i, "right")) for i in range(COUNT)]


@pytest.fixture(scope="module")
def folders(pairs, tmp_path_factory):
    """The folders of the left and the right images."""
    path = tmp_path_factory.mktemp("pairs")
    for side, images in zip(SIDES, zip(*pairs)):
        (path / side).mkdir()
        for number, image in enumerate(images):
            cv2.imwrite(str(path / side / f"{side}_{number:02}.png"), image)
    return [path / side for side in SIDES]


@pytest.fixture
def calibrate(run_main):
    """Runs the command here: its exit code and its output."""

    def run(*arguments):
        return run_main(main, ["calibrate_headless.py", *BOARD, *arguments])

    return run


def refused(calibrate, *arguments):
    """The error of a command that ends with 1."""
    code, output = calibrate(*arguments)
    *_, error = output.splitlines()
    assert code == 1 and error.startswith("calibrate_headless.py: "), output
    return error


def assert_found(left, right):
    """Both files are those of the scene's pair, whose cameras are the same and parallel."""
    truth = CalibrationScene().camera
    found = [yaml.safe_load(path.read_text()) for path in (left, right)]
    for one in found:
        assert np.allclose(one["camera_matrix"]["data"], truth.K.ravel(), rtol=0.005)
        rotation = np.reshape(one["rectification_matrix"]["data"], (3, 3))
        assert np.degrees(np.linalg.norm(cv2.Rodrigues(rotation)[0])) < 0.5
    of_left, of_right = (np.reshape(one["projection_matrix"]["data"], (3, 4)) for one in found)
    assert np.array_equal(of_left[:, :3], of_right[:, :3])
    assert not of_left[:, 3].any() and not of_right[1:, 3].any()
    assert of_right[0, 3] == pytest.approx(-of_right[0, 0] * BASELINE, rel=0.005)


def test_from_two_folders_to_the_files_that_a_camera_loads(
    calibrate, folders, monkeypatch, tmp_path
):
    """A camera of this name with two views."""
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    code, output = calibrate(*folders, "--camera-name", "eyes")
    assert code == 0, output
    lines = output.splitlines()
    assert "left: plumb_bob, 640x480" in lines and "right: plumb_bob, 640x480" in lines
    (baseline,) = re.findall(r"^baseline: (\S+) m, turned by \S+ degrees$", output, re.MULTILINE)
    assert float(baseline) == pytest.approx(BASELINE, rel=0.005)
    (error,) = re.findall(r"^epipolar error: (\S+) px$", output, re.MULTILINE)
    assert float(error) < 0.2
    assert len(re.findall(r"^  reprojection error: 0\.\d+ px$", output, re.MULTILINE)) == 2
    left, right = (tmp_path / "camera_info" / f"eyes_{side}.yaml" for side in SIDES)
    assert f"saved in {left} and {right}" in lines
    assert_found(left, right)
    assert [yaml.safe_load(path.read_text())["camera_name"] for path in (left, right)] == [
        "eyes_left",
        "eyes_right",
    ]
    coverage = cv2.imread(str(tmp_path / "camera_info" / "eyes.png"))
    assert coverage.shape == (480, 2 * 640, 3)
    assert f"{left} is there already; --force replaces it" in refused(
        calibrate, *folders, "--camera-name", "eyes"
    )
    left.write_text("old")
    kept = ["--keep", right, right]
    code, output = calibrate(*folders, "--camera-name", "eyes", "--force", *kept)
    assert code == 0 and "plumb_bob" not in output, output
    assert_found(left, right)


def test_files_that_come_during_the_work_are_left_and_the_results_beside_them(
    calibrate, folders, monkeypatch, tmp_path
):
    from robot_vision.calibration import headless_pair

    def work(*arguments, solve=headless_pair.calibrate_pair):
        (tmp_path / "eyes_right.yaml").write_text("another's")
        return solve(*arguments)

    monkeypatch.setattr(headless_pair, "calibrate_pair", work)
    code, output = calibrate(*folders, "--output", tmp_path / "eyes.yaml")
    assert code == 0, output
    assert (tmp_path / "eyes_right.yaml").read_text() == "another's"
    assert f"{tmp_path}/eyes_right.yaml has come meanwhile and is not replaced" in output
    assert_found(tmp_path / "eyes_left-1.yaml", tmp_path / "eyes_right-1.yaml")
    assert not (tmp_path / "eyes_left.yaml").exists()


def write_bag(path, pairs, late=0.0):
    """A bag in which the right images come, and are stamped, `late` s after the left ones."""
    with rosbag.Bag(str(path), "w") as made:
        for number, images in enumerate(pairs):
            for topic, image, delay in zip(TOPICS, images, (0.0, late)):
                sent = message(image, "bgr8")
                sent.header.stamp = rospy.Time.from_sec(1.0 + number + delay)
                made.write(topic, sent, sent.header.stamp)
        info = CameraInfo(width=640, height=480, distortion_model="plumb_bob")
        truth = CalibrationScene().camera
        info.K, info.D = truth.K.ravel(), truth.D
        info.binning_x = info.binning_y = 2  # which some drivers tell of the images themselves
        made.write("/eyes/left/camera_info", info, rospy.Time(1))


def test_from_a_bag(calibrate, pairs, tmp_path):
    bag, output = tmp_path / "eyes.bag", tmp_path / "eyes.yaml"
    found = [tmp_path / f"eyes_{side}.yaml" for side in SIDES]
    write_bag(bag, pairs, late=0.02)
    error = refused(calibrate, "--bag", bag, *LIVE, "--output", output)
    assert f"{bag} has no pairs: the stamps on {LEFT} and {RIGHT} do not meet: " in error
    assert error.endswith("must be equal; --slop allows cameras that are not in step")
    info = "/eyes/left/camera_info"
    code, printed = calibrate(
        *("--bag", bag, *LIVE, "--slop", "0.05", "--keep", info, info, "--output", output)
    )
    assert code == 0, printed
    assert_found(*found)
    truth = CalibrationScene().camera
    data = yaml.safe_load(found[0].read_text())["camera_matrix"]["data"]
    assert np.array_equal(data, truth.K.ravel())
    other = ["--bag", bag, "--left", LEFT, "--right", "/other", "--output", tmp_path / "a.yaml"]
    assert f"has no images on '/other', but on {LEFT}, {RIGHT}" in refused(calibrate, *other)


def test_live_and_given_to_the_camera(start, tmp_path):
    """From the running camera, and back to both of its views; Ctrl-C ends the recording.

    The cameras are those that the scene publishes, and stay as they are.
    """
    url = f"_camera_info_url:=file://{tmp_path}/${{NAME}}.yaml"
    scene = ["_source:=synthetic", "_scene:=calibration", "_views:=stereo"]
    start("camera_node", "__name:=eyes", "_camera_name:=eyes", *scene, url)
    known = [f"/eyes/{side}/camera_info" for side in SIDES]
    for side, topic in zip(SIDES, known):
        rospy.wait_for_service(f"/eyes/{side}/set_camera_info", support.DEADLINE)
        support.Messages(topic, CameraInfo).wait()
    words = ["--keep", *known, "--set", "/eyes", "--output", tmp_path / "result.yaml"]
    command = [*BOARD, *LIVE, *words]
    process = start("calibrate_headless.py", *command)
    support.wait_for(lambda: re.search(r": ([7-9]|\d\d) used", process.output()), "seven pairs")
    process.interrupt()
    assert process.exit_code() == 0, process.output()
    assert process.output().endswith("set in /eyes/left\nset in /eyes/right\n")
    kept = [tmp_path / f"eyes_{side}.yaml" for side in SIDES]
    assert_found(*kept)
    infos = [support.Messages(f"/eyes/{side}/camera_info", CameraInfo) for side in SIDES]
    for path, info in zip(kept, infos):
        found = yaml.safe_load(path.read_text())
        assert np.allclose(found["camera_matrix"]["data"], CalibrationScene().camera.K.ravel())
        assert np.allclose(info.wait()[0].P, found["projection_matrix"]["data"], rtol=1e-6)


def test_what_a_camera_refuses_is_not_lost(start, folders, tmp_path):
    refuse = SetCameraInfoResponse(success=False, status_message="read only")
    answers = {"left": SetCameraInfoResponse(success=True), "right": refuse}
    services = [
        rospy.Service(f"/broken/{side}/set_camera_info", SetCameraInfo, lambda _, to=to: to)
        for side, to in answers.items()
    ]
    words = [*BOARD, *folders, "--set", "/broken"]
    process = start("calibrate_headless.py", *words, env={"ROS_HOME": str(tmp_path)})
    assert process.exit_code() == 1
    for service in services:
        service.shutdown()
    name = f"{tmp_path}/camera_info/head_camera-calibrated"
    left, right = (pathlib.Path(f"{name}_{side}.yaml") for side in SIDES)
    *_, error = process.output().splitlines()
    assert error == (
        "calibrate_headless.py: /broken/right/set_camera_info: read only; the calibration of both "
        f"cameras is in {left} and {right}"
    )
    assert "set in /broken/left\n" in process.output()
    assert_found(left, right)


def test_stamps_that_never_meet_are_told_while_it_waits(start, pairs, tmp_path):
    publishers = [rospy.Publisher(topic, Image, queue_size=1) for topic in TOPICS]
    process = start("calibrate_headless.py", *BOARD, *LIVE, "--output", tmp_path / "eyes.yaml")
    times, sent = itertools.count(1000), [message(image, "bgr8") for image in pairs[0]]

    def told():
        stamp = rospy.Time(next(times))
        for publisher, image, late in zip(publishers, sent, (0.0, 0.1)):
            image.header.stamp = stamp + rospy.Duration(late)
            publisher.publish(image)
        return "do not meet" in process.output()

    support.wait_for(told, "what is wrong")
    expected = f"waiting: no pair comes: the stamps on {LEFT} and {RIGHT} do not meet: the newest"
    assert expected in process.output()
    process.interrupt()
    assert process.exit_code() == 1
    assert "calibrate_headless.py: there were no pairs\n" in process.output()
    for publisher in publishers:
        publisher.unregister()


def test_what_is_no_pair_is_named(calibrate, pairs, folders, tmp_path):
    def error(*arguments):
        return refused(calibrate, *arguments, "--output", tmp_path / "eyes.yaml")

    left, right = folders
    few, gray, small = (tmp_path / name for name in ("few", "gray", "small"))
    for folder in (few, gray, small):
        folder.mkdir()
    for number in range(COUNT):
        name = f"right_{number:02}.png"
        cv2.imwrite(str(gray / name), np.full((480, 640), 99, np.uint8))
        cv2.imwrite(str(small / name), pairs[number][1][::2, ::2])
    cv2.imwrite(str(few / "right_00.png"), pairs[0][1])
    assert f"{left} and {few} have 12 and 1 files, must have one image of each pair" in error(
        left, few
    )
    assert "left and right are swapped: the right camera is 0.1 m to the left" in error(right, left)
    assert "0 pairs show the board well in both images, 5 are needed at least; 12 show" in error(
        left, gray
    )
    code, printed = calibrate(left, small, "--output", tmp_path / "eyes.yaml")
    assert code == 1 and "there were no pairs that can be used" in printed
    assert "the left image has 640x480, the right one 320x240, must be equal\n" in printed
    shifted = tmp_path / "shifted"
    shifted.mkdir()
    for number in range(COUNT):
        image = pairs[(number + 1) % COUNT][1]
        cv2.imwrite(str(shifted / f"right_{number:02}.png"), image)
    assert "the images of a pair do not fit each other" in error(left, shifted)
    os.rename(shifted / "right_00.png", shifted / "right_99.png")
    assert f"{left}/left_00.png and {shifted}/right_01.png are no pair" in error(left, shifted)
    truth = CalibrationScene().camera
    half = tmp_path / "half.yaml"
    camera = CameraModel(320, 240, truth.K, truth.D, "plumb_bob")
    half.write_text(camera_yaml(camera, np.eye(3), np.eye(3, 4), "half"))
    assert f"{half} is of images of 320x240, these have 640x480" in error(
        left, right, "--keep", half, half
    )
    assert not [path for path in tmp_path.iterdir() if path.name.startswith("eyes")]


def test_a_camera_whose_views_do_not_run_is_told_before_the_work(start, folders):
    process = start("calibrate_headless.py", *BOARD, *folders, "--set", "/nobody")
    assert process.exit_code() == 1
    service = "/nobody/left/set_camera_info"
    assert process.output() == (
        f"calibrate_headless.py: there is no service {service}: does the camera run?\n"
    )


@pytest.mark.parametrize(
    "arguments, reason",
    [
        ([], "the pairs are from two FILEs or from --left and --right"),
        (["a", "b", "--left", "/l", "--right", "/r"], "the pairs are from two FILEs or from"),
        (["a"], "--stereo has two FILEs, of the left camera and of the right one"),
        (["a", "b", "--bag", "c.bag"], "--stereo has two FILEs"),
        (["--left", "/l"], "--left and --right are two topics"),
        (["--left", "/l", "--right", "/l"], "--left and --right are two topics"),
        (["--topic", "/l"], "--topic and --image are of one camera"),
        (["a", "b", "--slop", "0.1"], "--slop is of images with stamps, not of files"),
        ([*LIVE, "--slop", "11"], "--slop: 11 must be from 0 to 10"),
        (["a", "b", "--keep", "/l", "/r"], "with FILEs, --keep has two .yaml files"),
    ],
)
def test_what_is_no_command_is_refused(calibrate, arguments, reason):
    code, output = calibrate(*arguments)
    assert code == 2 and reason in output, output


def test_what_is_of_pairs_needs_stereo(run_main):
    words = ["calibrate_headless.py", *BOARD[1:], "--left", "/l", "--right", "/r"]
    code, output = run_main(main, words)
    assert code == 2 and "--left, --right, --slop and --keep are of --stereo" in output
