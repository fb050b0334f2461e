"""What the launch files ask for: of two hosts which this is, and no display that is not there."""

import contextlib
import io
import pathlib
import sys

import pytest
import rospy
import support
import yaml
from roslaunch import main
from sensor_msgs.msg import Image

LAUNCH = pathlib.Path(__file__).resolve().parents[2] / "launch"


def roslaunch(*arguments):
    """What roslaunch prints, which runs in this process: it takes a second to import."""
    printed, words = io.StringIO(), list(sys.argv)
    sys.argv[:] = ["roslaunch", *map(str, arguments)]  # in place: it holds on to this list
    try:
        with contextlib.redirect_stdout(printed), contextlib.suppress(SystemExit):
            main()
    finally:
        sys.argv[:] = words
    return printed.getvalue()


@pytest.mark.parametrize("path", sorted(LAUNCH.glob("*.launch")), ids=lambda path: path.name)
def test_no_argument_is_required_but_the_part_of_two_hosts(path):
    listed = roslaunch("--ros-args", path)
    assert "Optional Arguments:" in listed
    required = listed.partition("Required Arguments:\n")[2].partition("Optional")[0].split()
    assert required[:1] == (["part:"] if path.name == "remote.launch" else []), listed


@pytest.mark.parametrize(
    "display, arguments, windows",
    [(":7", (), 1), ("", (), 0), (":7", ("view:=false",), 0), ("", ("view:=true",), 1)],
)
def test_usb_cam_test_opens_a_window_where_there_is_a_display(
    monkeypatch, display, arguments, windows
):
    monkeypatch.setenv("DISPLAY", display)
    nodes = roslaunch("--nodes", LAUNCH / "usb_cam-test.launch", *arguments).split()
    assert nodes.count("/usb_cam") == 1
    assert nodes.count("/image_view") == windows


@pytest.mark.parametrize("arguments, loop", [((), False), (("loop:=true",), True)])
def test_a_folder_begins_again_if_that_is_said(arguments, loop):
    parameters = yaml.safe_load(roslaunch("--dump-params", LAUNCH / "camera.launch", *arguments))
    assert parameters["/usb_cam/loop"] is loop


def test_words_in_place_of_a_value_mean_that_there_is_none(start, tmp_path):
    home = {"ROS_HOME": str(tmp_path)}
    images = support.Messages("/usb_cam/image_raw", Image)
    start("/usr/bin/roslaunch", "robot_vision", "camera.launch", "source:=synthetic", env=home)
    images.wait()
    for launch_file, parameter, value in [
        ("face_recognizer.launch", "/face_recognizer/gallery", f"{tmp_path}/robot_vision/faces"),
        ("apriltag.launch", "/apriltag_detector/tag_size", 0.1),
    ]:
        start("/usr/bin/roslaunch", "robot_vision", launch_file, env=home)
        there = support.wait_for(lambda: rospy.get_param(parameter, None), parameter)  # noqa: B023
        assert there == value
