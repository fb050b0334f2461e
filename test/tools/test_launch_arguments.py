"""Arguments that a launch file does not have are told, and those that it has."""

import pytest

from robot_vision.demo.check_arguments import unknown_arguments

TEXT = """\
<launch>
  <arg name="image" default="/usb_cam/image_raw" doc="the topic"/>
  <arg name="part" doc="which"/>
  <arg name="config" default="$(find robot_vision)/config/a.yaml" doc="YAML file"/>
  <arg name="fixed" value="1"/>
  <include file="other.xml"><arg name="inner" value="1"/></include>
</launch>
"""
LISTED = """\
our.launch has the arguments
  image: the topic [/usb_cam/image_raw]
  part: which
  config: YAML file
"""
ROSLAUNCH = ["/usr/bin/python3", "/usr/bin/roslaunch"]


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "our.launch"
    file.write_text(TEXT)
    return str(file)


@pytest.mark.parametrize(
    "arguments, told",
    [
        (["imgae:=/x"], "our.launch has no argument imgae, is image meant?\n" + LISTED),
        (["x:=1", "part:=a"], "our.launch has no argument x\n" + LISTED),
        (["fixed:=2"], "our.launch has no argument fixed\n" + LISTED),
        (["inner:=2"], "our.launch has no argument inner\n" + LISTED),
        (["image:=x:=y", "__ns:=/there"], ""),
        ([], ""),
    ],
)
def test_an_unknown_argument_is_told_with_those_that_there_are(path, arguments, told):
    assert unknown_arguments(path, [*ROSLAUNCH, "robot_vision", "our.launch", *arguments]) == told
    assert unknown_arguments(path, [*ROSLAUNCH, "--wait", *arguments, path]) == told


@pytest.mark.parametrize(
    "words",
    [
        ["their_package", "our.launch"],
        ["robot_vision", "theirs.launch"],
        ["/there/our.launch"],
        ["robot_vision", "our.launch", "theirs.launch"],
        [],
    ],
)
def test_another_launch_file_s_arguments_are_its_own(path, words):
    assert unknown_arguments(path, [*ROSLAUNCH, *words, "x:=1"]) == ""
