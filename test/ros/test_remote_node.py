"""remote.launch on two hosts, which are network namespaces, with a cable between them.

Only addresses inside these namespaces are used; they have no connection to the outside.
"""

import os
import re
import shutil
import subprocess
import time

import pytest
from support import wait_for

ROBOT, DESK = "10.231.7.1", "10.231.7.2"
CUT = 3.0  # s
STAMP = "/edge_detector/processed_image/header/stamp"


def ip(*words):
    subprocess.run(["ip", *words], check=True, stderr=subprocess.PIPE)


class Network:
    """Two hosts with a cable that can be unplugged."""

    def __init__(self):
        self.names = {host: f"robot_vision_{os.getpid()}_{host[-1]}" for host in (ROBOT, DESK)}
        self._ends = {host: f"rv{os.getpid()}_{host[-1]}" for host in (ROBOT, DESK)}

    def connect(self):
        for name in self.names.values():
            ip("netns", "add", name)
        robot, desk = (["name", self._ends[host], "netns", self.names[host]] for host in self.names)
        ip("link", "add", *robot, "type", "veth", "peer", *desk)
        for host, name in self.names.items():
            ip("-n", name, "address", "add", host + "/30", "dev", self._ends[host])
            for device in ("lo", self._ends[host]):
                ip("-n", name, "link", "set", device, "up")

    def cable(self, state):
        """Unplugs the cable ("down") or plugs it in ("up")."""
        ip("-n", self.names[ROBOT], "link", "set", self._ends[ROBOT], state)

    def remove(self):
        for name in self.names.values():
            subprocess.run(["ip", "netns", "delete", name], check=False, stderr=subprocess.DEVNULL)


@pytest.fixture
def network():
    if os.geteuid() != 0:
        pytest.skip("network namespaces need root")
    made = Network()
    try:
        made.connect()
    except (FileNotFoundError, subprocess.CalledProcessError) as error:
        made.remove()
        pytest.skip(f"no network namespaces to be had here: {error}")
    yield made
    made.remove()


@pytest.fixture
def run(network, start):
    """run(host, command, ...) starts a command on a host; it ends before the network does."""

    def on_host(host, command, *arguments):
        addresses = {"ROS_MASTER_URI": f"http://{ROBOT}:11311", "ROS_HOSTNAME": host}
        environment = {**addresses, "PYTHONUNBUFFERED": "1"}
        command = ["netns", "exec", network.names[host], shutil.which(command), *arguments]
        return start(shutil.which("ip"), *command, env=environment)

    return on_host


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
