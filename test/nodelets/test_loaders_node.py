"""Loaders of nodes in Python: the program of nodelet and python_nodelet.py, which becomes it."""

import os
import pathlib
import signal

import pytest
import rospy
import support
from frames import Camera
from python_manager import NAME, PythonManager
from ros_programs import ROSLAUNCH, program_of
from std_srvs.srv import Trigger

NODELET = program_of("nodelet", "nodelet")


@pytest.fixture
def manager(start):
    return PythonManager(start)


def loaded(start, manager, program):
    """A loader of /hsv, which has loaded it and formed its bond."""
    kind = "hsv_tracker" if program == "python_nodelet.py" else "robot_vision/hsv_tracker"
    words = ["__name:=hsv", "image:=/images", "_opening:=9", "objects:=/ignored"]
    loader = start(program, "load", kind, NAME[1:], *words, fork=False)
    support.wait_for(lambda: manager.loaded() == {"/hsv"}, "the node")
    return loader


@pytest.mark.parametrize("program", [NODELET, "python_nodelet.py"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_the_end_of_a_loader_unloads_its_node(start, manager, program, number):
    loader = loaded(start, manager, program)
    assert rospy.get_param("/hsv/opening") == 9
    assert support.reconfigured("/hsv")["opening"] == 9
    assert os.readlink(f"/proc/{loader.pid}/exe") == NODELET
    os.kill(loader.pid, number)
    support.wait_for(lambda: manager.loaded() == set(), "the end of the node")
    loader.exit_code()


def test_a_node_that_is_unloaded_ends_its_loader(start, manager):
    loader = loaded(start, manager, "python_nodelet.py")
    other = start("python_nodelet.py", "unload", "/hsv", NAME, fork=False)
    assert other.exit_code() == 0
    loader.exit_code()
    assert manager.loaded() == set()


def test_the_end_of_a_manager_ends_its_loaders(start, manager):
    loader = loaded(start, manager, "python_nodelet.py")
    manager.process.interrupt()
    assert manager.process.prompt_exit_code() == 0
    loader.exit_code()


def test_without_a_bond_the_node_stays(start, manager):
    loader = start(
        "python_nodelet.py", "load", "contours", NAME, "--no-bond", "__name:=lines", fork=False
    )
    support.wait_for(lambda: manager.loaded() == {"/lines"}, "the node")
    os.kill(loader.pid, signal.SIGKILL)
    loader.exit_code()
    rospy.wait_for_service("/lines/save_parameters", support.DEADLINE)
    assert manager.loaded() == {"/lines"}


def test_list_names_all_nodes(start, manager):
    manager.load("/b", "robot_vision/contours")
    manager.load("/a/c", "robot_vision/hough")
    listed = start("python_nodelet.py", "list", NAME[1:], fork=False)
    assert listed.exit_code() == 0
    assert listed.output().split() == ["/a/c", "/b"]
    listed = start("python_nodelet.py", "list", "nobody", fork=False)
    assert listed.exit_code() == 1
    assert "no answer of /nobody/list" in listed.output()


@pytest.mark.parametrize("kind", ["hsv_tracker", "robot_vision/hsv_tracker", "brightness"])
def test_standalone_runs_a_node(start, kind):
    process = start("python_nodelet.py", "standalone", kind, "__name:=alone", fork=False)
    rospy.wait_for_service("/alone/save_parameters", support.DEADLINE)
    process.interrupt()
    assert process.exit_code() == 0


def test_roslaunch_loads_and_a_required_node_ends_it(start, tmp_path):
    camera = Camera(rate=30.0)
    file = pathlib.Path(tmp_path / "both.launch")
    file.write_text(
        f"""<launch>
          <node pkg="robot_vision" type="python_manager.py" name="vision"/>
          <group ns="left">
            <node pkg="robot_vision" type="python_nodelet.py" name="hsv" required="true"
                args="load hsv_tracker /vision">
              <remap from="image" to="{camera.topic}"/>
              <param name="opening" value="7"/>
            </node>
          </group>
        </launch>"""
    )
    launch = start(ROSLAUNCH, file)
    rospy.wait_for_service("/left/hsv/save_parameters", support.DEADLINE)
    assert support.reconfigured("/left/hsv")["opening"] == 7
    assert "~config_file" in rospy.ServiceProxy("/left/hsv/save_parameters", Trigger)().message
    unload = start("python_nodelet.py", "unload", "/left/hsv", NAME, fork=False)
    assert unload.exit_code() == 0
    launch.exit_code()
