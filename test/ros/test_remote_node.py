"""remote.launch on two hosts, with a cable between them."""

import re
import shutil
import subprocess
import time

import pytest
from support import wait_for
from two_hosts import DESK, ROBOT, network_of_two, runner

CUT = 3.0  # s
STAMP = "/edge_detector/processed_image/header/stamp"


@pytest.fixture
def network():
    with network_of_two() as made:
        yield made


@pytest.fixture
def run(network, start):
    return runner(network, start)


def transport():
    """The transport compressed, if image_transport has it."""
    command = ["rosrun", "image_transport", "list_transports"]
    found = subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True).stdout
    return "compressed" if '"image_transport/compressed"' in found else "raw"


def test_images_come_again_after_the_network_was_cut(network, run):
    launch = ["robot_vision", "remote.launch", f"transport:={transport()}"]
    robot = run(ROBOT, "roslaunch", *launch, "part:=capture", "source:=synthetic")
    robot.wait_for_output("started core service")  # the desk needs the master
    desk = run(DESK, "roslaunch", *launch, "part:=processing")
    stamps = run(DESK, "rostopic", "echo", "-p", STAMP)

    def newest():
        """The stamp, in s, of the newest image whose edges have arrived on the desk."""
        taken = re.findall(r"^\d+,(\d+)\n", stamps.output(), re.MULTILINE)
        return int(taken[-1]) * 1e-9 if taken else 0.0

    wait_for(newest, "edges on the desk", 60.0)
    network.cable("down")
    wait_for(lambda: time.time() - newest() > CUT, "the images that were under way to pass")
    network.cable("up")
    restored = time.time()
    wait_for(lambda: newest() > restored + 1.0, "images of later on", 60.0)
    for process in (robot, desk):
        assert process.running() and "has died" not in process.output(), process.output()


def test_the_part_is_required(start):
    """Without it the second host would capture as well."""
    launch = start(shutil.which("roslaunch"), "robot_vision", "remote.launch")
    assert launch.exit_code() == 1
    assert "requires the 'part' arg to be set" in launch.output()


def test_an_unknown_part_is_an_error(start):
    launch = start(shutil.which("roslaunch"), "robot_vision", "remote.launch", "part:=procesing")
    assert launch.exit_code() == 1
    assert "'part:=capture or part:=processing, not part:=procesing,'" in launch.output()
