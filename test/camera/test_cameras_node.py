"""Several cameras in one nodelet manager: each works whatever becomes of the others."""

import contextlib
import os
import pathlib
import signal
import socket
import sys

import cv2
import numpy as np
import pytest
import rosgraph
import rospy
import support
import yaml
from nodelet.srv import NodeletList, NodeletUnload
from ros_programs import ROSLAUNCH, program_of
from sensor_msgs.msg import CameraInfo, Image
from support import Messages, wait_for

MANAGER = "/camera_manager"
PROMPT = {"PYTHONUNBUFFERED": "1"}  # else rospy's INFO lines wait in a buffer
BOND_TIMEOUT = 6.0  # s after which a bond surely breaks: 4 s after the last heartbeat, and a margin
SMALL = {"source": "synthetic", "image_width": 160, "image_height": 120}


@pytest.fixture
def lasting_bonds():
    with support.missed_signs_allowed():
        yield


def loaded():
    return set(rospy.ServiceProxy(MANAGER + "/list", NodeletList)().nodelets)


def loaded_now():
    """What is loaded, or None while there is no manager."""
    with contextlib.suppress(rospy.ServiceException, rospy.ROSException):
        return loaded()


def process_of(node):
    """The process id of a node."""
    return support.node_api(node).getPid("/test")[2]


def assert_frames(topic, width, frame_id):
    images = Messages(topic + "/image_raw", Image)
    infos = Messages(topic + "/camera_info", CameraInfo)
    image, info = support.same_frame(images, infos)
    assert (image.width, image.header.frame_id) == (width, frame_id)
    assert info.header == image.header or info.header.frame_id == frame_id
    images.close()
    infos.close()


def test_cameras_of_a_launch_file(start, tmp_path):
    """Two work, two are wrong and a device is missing; the manager dies, then the loader."""
    cameras = [
        {"name": "front", "rate": 20, **SMALL},
        {"name": "wrong", "source": "/no/such/file.mp4"},
        {"name": "mad", "source": "synthetic", "image_width": -1},
        {"name": "missing", "source": "/dev/robot_vision_none"},
        {"name": "rear", **SMALL, "image_width": 200, "camera_frame_id": "rear_eye"},
    ]
    config = tmp_path / "cameras.yaml"
    config.write_text(yaml.safe_dump({"cameras": cameras}))
    command = [ROSLAUNCH, "robot_vision", "cameras.launch", f"config:={config}"]
    process = start(*command, env=PROMPT)
    victims = (MANAGER, "/camera_loader", None)
    times = 0  # that the last camera was loaded; again, too, when a bond breaks on a busy machine
    for victim in victims:
        wait_for(lambda: process.output().count("/rear: loaded") > times, "the cameras")  # noqa: B023
        assert_frames("/front", 160, "front")
        assert_frames("/rear", 200, "rear_eye")
        wait_for(lambda: loaded_now() == {"/front", "/rear", "/missing"}, "all that can be loaded")
        times = process.output().count("/rear: loaded")
        if victim:
            os.kill(process_of(victim), signal.SIGKILL)
    output = process.output()
    assert "/no/such/file.mp4: no such file or folder" in output
    assert "image_width is -1, must be from 16 to 8192" in output
    for name in ("/wrong", "/mad"):
        assert f"{name}: not loaded, the manager says why; trying again in 1 s" in output
    assert "responded with an error" not in output and "b'" not in output


@pytest.mark.usefixtures("lasting_bonds")
def test_lost_cameras_are_loaded_again_until_ctrl_c(start):
    manager = start(program_of("nodelet", "nodelet"), "manager", "__name:=camera_manager")
    rospy.set_param("/camera_loader/cameras", [{"name": "front", **SMALL}])
    loader = start("camera_loader.py", env=PROMPT)
    loader.wait_for_output("/front: loaded")
    assert loaded() == {"/front"}
    rospy.ServiceProxy(MANAGER + "/unload_nodelet", NodeletUnload)("/front")
    loader.wait_for_output("/front: lost, the manager has died or unloaded it")
    wait_for(lambda: loader.output().count("/front: loaded") == 2, "it to be loaded again")
    assert loaded() == {"/front"}
    loader.interrupt()
    assert loader.exit_code() == 0
    assert loaded() == set()
    assert manager.running()


def test_a_restarted_loader_takes_over_the_cameras_of_its_predecessor(start):
    """Whether or not the manager has noticed yet that the first one is gone."""
    start(program_of("nodelet", "nodelet"), "manager", "__name:=camera_manager")
    rospy.set_param("/camera_loader/cameras", [{"name": "front", **SMALL}])
    start("camera_loader.py", env=PROMPT).wait_for_output("/front: loaded")
    os.kill(process_of("/camera_loader"), signal.SIGKILL)
    loader = start("camera_loader.py", env=PROMPT)
    loader.wait_for_output("/front: loaded")
    assert "not loaded" not in loader.output()
    assert_frames("/front", 160, "front")


def test_a_loader_takes_over_the_cameras_of_a_killed_one(start):
    """It does so before the manager has noticed that the first loader is gone."""
    start(program_of("nodelet", "nodelet"), "manager", "__name:=camera_manager")
    cameras = [{"name": "front", **SMALL}]
    rospy.set_param("/camera_loader/cameras", cameras)
    start("camera_loader.py", env=PROMPT).wait_for_output("/front: loaded")
    rospy.set_param("/second/cameras", [])
    loader = start("camera_loader.py", "__name:=second", env=PROMPT)
    loader.wait_for_output("waiting for another list")  # there are seconds for what follows
    with support.missed_signs_allowed():
        os.kill(process_of("/camera_loader"), signal.SIGKILL)
        rospy.set_param("/second/cameras", cameras)
        loader.wait_for_output("/front: unloaded, another loader has left it")
    loader.wait_for_output("/front: loaded")
    assert "not loaded" not in loader.output()
    assert_frames("/front", 160, "front")
    # The bond of the dead loader would break now.
    rospy.rostime.wallsleep(BOND_TIMEOUT)
    assert loaded() == {"/front"} and "/front: lost" not in loader.output()


def test_a_camera_that_fails_to_load_is_tried_again(start, tmp_path):
    image = tmp_path / "later.png"
    start(program_of("nodelet", "nodelet"), "manager", "__name:=camera_manager")
    rospy.set_param("/camera_loader/cameras", [{"name": "front", "source": str(image)}])
    loader = start("camera_loader.py", env=PROMPT)
    for seconds in (1, 2):
        loader.wait_for_output(f"trying again in {seconds} s")
    rospy.delete_param("/front")  # as if the master had been restarted
    cv2.imwrite(str(image), np.zeros((48, 64, 3), np.uint8))
    loader.wait_for_output("/front: loaded")
    assert_frames("/front", 64, "front")


def test_a_camera_that_kills_the_manager_is_left_out(start):
    script = str(pathlib.Path(support.__file__).with_name("dying_manager.py"))
    rospy.set_param(
        "/camera_loader/cameras",
        [{"name": name, "source": "synthetic"} for name in ("front", "bad", "rear")],
    )
    loader = start("camera_loader.py", "_manager:=/manager", env=PROMPT)
    loader.wait_for_output("waiting for the manager /manager")
    for end in ("/bad: the manager died of it; once more", "of it; it is left out"):
        manager = start(sys.executable, script)
        loader.wait_for_output(end)
        assert manager.exit_code() == 1
        assert "loaded /front robot_vision/camera" in manager.output()
    manager = start(sys.executable, script)
    manager.wait_for_output("loaded /rear robot_vision/camera")
    assert manager.running() and "loaded /front robot_vision/camera" in manager.output()


def test_the_port_of_a_killed_manager_may_belong_to_what_never_answers(start):
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        port, master = silent.getsockname()[1], rosgraph.Master(MANAGER)
        uri = f"http://127.0.0.1:{port}/"
        master.registerService(MANAGER + "/load_nodelet", "rosrpc://127.0.0.1:1", uri)
        rospy.set_param("/camera_loader/cameras", [{"name": "front", **SMALL}])
        loader = start("camera_loader.py", env=PROMPT)
        loader.wait_for_output(f"waiting for the manager {MANAGER}")
        start(program_of("nodelet", "nodelet"), "manager", "__name:=camera_manager")
        loader.wait_for_output("/front: loaded")


def test_a_camera_that_was_loaded_is_tried_as_often_again(start):
    script = str(pathlib.Path(support.__file__).with_name("dying_manager.py"))
    rospy.set_param("/camera_loader/cameras", [{"name": "bad", "source": "synthetic"}])
    loader = start("camera_loader.py", "_manager:=/manager", env=PROMPT)

    def wait_for_said(text, times):
        support.wait_for(lambda: loader.output().count(text) == times, f"'{text}' {times} times")

    for deaths in (1, 2):
        rospy.set_param("/withstands", False)
        start(sys.executable, script)
        wait_for_said("/bad: the manager died of it; once more", deaths)
        rospy.set_param("/withstands", True)
        manager = start(sys.executable, script)
        wait_for_said("/bad: loaded", deaths)
        manager.end()


def test_interrupt_while_loading(start):
    """One camera is loaded, the manager is still busy with the next."""
    names = ("front", "endless", "rear")
    cameras = [{"name": name, "source": "synthetic"} for name in names]
    rospy.set_param("/camera_loader/cameras", cameras)
    manager = start(sys.executable, pathlib.Path(support.__file__).with_name("dying_manager.py"))
    loader = start("camera_loader.py", "_manager:=/manager", env=PROMPT)
    manager.wait_for_output("loaded /endless")
    loader.interrupt()
    assert loader.prompt_exit_code() == 0, loader.output()
    assert "Traceback" not in loader.output(), loader.output()
    assert manager.running() and "/rear" not in manager.output()


def test_an_invalid_list_is_reported_once_and_a_valid_one_awaited(start, tmp_path):
    """The loader must not end, because roslaunch would start it again and again."""
    config = tmp_path / "cameras.yaml"
    config.write_text(yaml.safe_dump({"cameras": [{"name": "front"}]}))
    command = [ROSLAUNCH, "robot_vision", "cameras.launch", f"config:={config}"]
    process = start(*command, env=PROMPT)
    process.wait_for_output("cameras[0] (front): there is no source; waiting for another list")
    rospy.set_param("/camera_loader/cameras", [])
    process.wait_for_output("cameras is [], must be a list of maps with name and source; waiting")
    rospy.set_param("/camera_loader/cameras", [{"name": "front", **SMALL}])
    process.wait_for_output("/front: loaded")
    assert process.output().count("there is no source") == 1
    assert "has died" not in process.output(), process.output()


@pytest.mark.usefixtures("lasting_bonds")
def test_a_new_list_changes_only_the_cameras_that_differ(start):
    start(program_of("nodelet", "nodelet"), "manager", "__name:=camera_manager")
    front, side, rear = ({"name": name, **SMALL} for name in ("front", "side", "rear"))
    rospy.set_param("/camera_loader/cameras", [front, side, {**rear, "rate": 15}])
    loader = start("camera_loader.py", env=PROMPT)
    wait_for(lambda: loader.output().count(": loaded") == 3, "the cameras")
    rospy.set_param("/camera_loader/cameras", [front, {"name": "rear"}])
    loader.wait_for_output("cameras[1] (rear): there is no source; waiting for another list")
    assert loaded() == {"/front", "/side", "/rear"}
    back = {"name": "back", **SMALL}
    rospy.set_param("/camera_loader/cameras", [back, front, {**rear, "image_width": 200}])
    wait_for(lambda: loader.output().count(": loaded") == 5, "the cameras that are new")
    assert loaded() == {"/front", "/rear", "/back"}
    assert_frames("/rear", 200, "rear")
    assert_frames("/back", 160, "back")
    assert rospy.get_param("/rear/framerate") != 15  # dynamic_reconfigure puts the default there
    assert not rospy.has_param("/side")
    output = loader.output()
    assert "/side: removed" in output and "lost" not in output
    assert output.count("/front: loaded") == 1 and output.count("there is no source") == 1
    rospy.delete_param("/camera_loader/cameras")  # as if the master had been restarted
    rospy.set_param("/camera_loader/cameras", [front])
    wait_for(lambda: loaded() == {"/front"}, "the others to be removed")
    assert loader.output().count("/front: loaded") == 1


def test_help_does_not_mention_saving_parameters(start):
    process = start("camera_loader.py", "--help")
    assert process.exit_code() == 0
    assert "Loads the cameras of the list ~cameras" in process.output()
    assert "save_parameters" not in process.output()
