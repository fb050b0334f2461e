"""Nodes of a user who is not root: they work, or one line says what cannot be written."""

import os
import pathlib
import shutil
import tempfile

import cv2
import pytest
import rospy
import support
from sensor_msgs.msg import CameraInfo, Image
from sensor_msgs.srv import SetCameraInfo
from std_srvs.srv import Trigger
from unprivileged import BECOME_NOBODY, NOBODY, needs_root, skip_unless_all_may_look

from robot_vision import CalibrationScene, SceneParams
from robot_vision.msg import DetectionArray

pytestmark = needs_root
DENIED = "cannot be written: Permission denied"
HOMES = pytest.mark.parametrize("has_home", [False, True], ids=["no home", "locked home"])
BOARD = ["--size", "8x6", "--square", "0.05"]


@pytest.fixture
def own():
    """A folder that belongs to the user nobody, beside a locked one that nobody may only read."""
    # Other users may not read pytest's own folders.
    with tempfile.TemporaryDirectory() as top:
        os.chmod(top, 0o755)
        path = pathlib.Path(top, "own")
        path.mkdir()
        path.with_name("locked").mkdir()
        os.chown(str(path), NOBODY, NOBODY)
        yield path


@pytest.fixture
def locked(own):
    return own.with_name("locked")


@pytest.fixture
def start_as_nobody(start):
    """start_as_nobody(folder, home, name, "arg", ...) starts a command of this package there.

    If home is None, the command has none.
    """
    skip_unless_all_may_look()

    def run(folder, home, name, *arguments):
        words = ["-C", folder, "-uROS_HOME", f"HOME={home}" if home else "-uHOME", *BECOME_NOBODY]
        return start(shutil.which("env"), *words, support.executable(name), *arguments)

    return run


def assert_saves_where_it_may(node, own, locked):
    """Values are saved in a writable file; for the other one there is an error."""
    service = f"/{node}/save_parameters"
    rospy.wait_for_service(service, support.DEADLINE)
    for folder in (own, locked):
        path = folder / f"{node}.yaml"
        rospy.set_param(f"/{node}/config_file", str(path))
        answer = rospy.ServiceProxy(service, Trigger)()
        assert answer.success == path.exists() == (folder == own), answer
        assert folder == own or answer.message.startswith(f"{path} {DENIED}; ")
    assert os.stat(str(own / f"{node}.yaml")).st_uid == NOBODY


def test_nodes(start_as_nobody, own, locked):
    """Frames pass from a C++ node to a Python node in a folder where they may not write."""
    images = support.Messages("/camera/image_raw", Image)
    codes = support.Messages("/code_reader/codes", DetectionArray)
    url = f"_camera_info_url:=file://{locked}/camera.yaml"
    camera = start_as_nobody(locked, None, "camera_node", "_source:=synthetic", url)
    reader = start_as_nobody(locked, None, "code_reader.py", "image:=/camera/image_raw")
    images.wait()
    codes.wait()
    for node in ("camera", "code_reader"):
        assert_saves_where_it_may(node, own, locked)
    give = rospy.ServiceProxy("/camera/set_camera_info", SetCameraInfo)
    size = {"width": images.received[0].width, "height": images.received[0].height}
    answer = give(CameraInfo(**size, K=[500, 0, 320, 0, 500, 240, 0, 0, 1]))
    assert not answer.success and answer.status_message == f"{locked}/camera.yaml {DENIED}"
    for process in (camera, reader):
        process.interrupt()
        assert process.prompt_exit_code() == 0, process.output()
        assert "Traceback" not in process.output(), process.output()
    assert list(locked.iterdir()) == []


@pytest.mark.parametrize("node", ["camera_node", "code_reader.py"])
def test_files_that_roscpp_cannot_write_are_reported(start_as_nobody, own, locked, node):
    """roscpp makes ~/.ros in an existing home; without a home no node starts."""
    process = start_as_nobody(own, locked, node)
    assert process.exit_code() == 1
    (fatal,) = [line for line in process.output().splitlines() if "FATAL" in line]
    assert f'Permission denied: "{locked}/.ros/"; ROS_HOME names a folder' in fatal
    assert "Traceback" not in process.output() and list(locked.iterdir()) == []


def test_a_log_of_another_user_is_reported(start_as_nobody, own):
    """Root may have left it there."""
    log = own / ".ros" / "log" / "code_reader.log"
    log.parent.mkdir(parents=True)
    log.touch(0o644)
    process = start_as_nobody(own, own, "code_reader.py")
    assert process.exit_code() == 1
    (fatal,) = process.output().splitlines()
    assert "FATAL" in fatal and f"{log}: Permission denied; ROS_HOME names a folder" in fatal


def test_a_node_without_a_log_still_reports_errors(start_as_nobody, locked):
    rospy.set_param("/code_reader/max_search_period", -1.0)
    process = start_as_nobody(locked, None, "code_reader.py")
    assert process.exit_code() == 1
    (fatal,) = [line for line in process.output().splitlines() if "FATAL" in line]
    assert "/code_reader: max_search_period is -1," in fatal


@HOMES
def test_create_marker(start_as_nobody, own, locked, has_home):
    """It writes to its working folder and to another one."""
    for folder, arguments, path in (
        (own, [], "tag36h11_1.png"),
        (locked, ["--output", own / "a.png"], own / "a.png"),
        (locked, [], "tag36h11_1.png"),
        (own, ["--output", locked / "a.png"], locked / "a.png"),
    ):
        home = locked if has_home else None
        process = start_as_nobody(folder, home, "create_marker.py", *arguments, "1")
        if (folder / path).parent == own:
            assert process.exit_code() == 0, process.output()
            assert os.stat(str(folder / path)).st_uid == NOBODY
        else:
            assert process.exit_code() == 1
            assert process.output() == f"create_marker.py: {path} {DENIED}\n"
    assert list(locked.iterdir()) == []


@HOMES
def test_calibrate_headless(start_as_nobody, own, locked, has_home):
    """Before the work it names the file it may not write, then the images it may not read."""
    params = SceneParams()
    params.rate = 2.0  # so that each frame shows another pose
    scene = CalibrationScene(params)
    images = own / "images"
    images.mkdir()
    for number in range(6):
        cv2.imwrite(str(images / f"{number}.png"), scene.render(number))
    (images / "0.png").chmod(0o600)
    command = [locked if has_home else None, "calibrate_headless.py", *BOARD, images, "--output"]
    process = start_as_nobody(locked, *command, own / "a.yaml")
    assert process.exit_code() == 0, process.output()
    assert f"skipped {images}/0.png: Permission denied\n" in process.output()
    assert os.stat(str(own / "a.yaml")).st_uid == NOBODY and (own / "a.png").exists()
    process = start_as_nobody(own, *command, locked / "a.yaml")
    assert process.exit_code() == 1
    reason = f"{locked}/a.yaml cannot be written: {locked} may not be written to"
    assert process.output() == f"calibrate_headless.py: {reason}\n"
    process = start_as_nobody(own, *command[:-1])  # into the user's home
    assert process.exit_code() == 1
    (line,) = process.output().splitlines()
    assert line.startswith("calibrate_headless.py: /") and line.endswith(" may not be written to")
    assert ".ros/camera_info/head_camera.yaml cannot be written: /" in line
    images.chmod(0o700)
    process = start_as_nobody(own, *command, own / "b.yaml")
    assert process.exit_code() == 1
    reason = f"{images} cannot be read: Permission denied"
    assert process.output() == f"calibrate_headless.py: {reason}\n"
    assert list(locked.iterdir()) == []
