"""Readers that cannot read a publisher's memory: another user's, and on another host."""

import os
import shutil

import pytest
import support
from frames import Source, message, new_topic, noise
from sensor_msgs.msg import Image
from shared_images import REPUBLISH, Reader, share, uses_raw
from two_hosts import DESK, ROBOT, network_of_two, runner

NOBODY = 65534
BECOME_NOBODY = [f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups"]
WARNING = "images come over raw, not shm: "


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can become another user")
def test_another_user_gets_raw_and_one_warning(start, tmp_path_factory):
    source, topic = Source(new_topic()), new_topic()
    share(start, source.topic, topic)
    source.wait_for()
    image = message(noise("bgr8"), "bgr8")
    reader = Reader(start, topic, "shm", shutil.which("setpriv"), *BECOME_NOBODY)
    out = support.Messages(reader.target, Image)

    def warned():
        source.send(image)
        return WARNING in reader.process.output() and out.received

    support.wait_for(warned, "a warning")

    def only_raw():
        source.send(image)
        return uses_raw(reader.node, topic)

    support.wait_for(only_raw, "raw alone")
    count = len(out.received)
    support.wait_for(lambda: source.send(image) or len(out.received) > count + 5, "further frames")
    assert reader.process.output().count(WARNING) == 1
    assert out.received[-1].data == image.data


@pytest.fixture
def run(start):
    with network_of_two() as network:
        yield runner(network, start)


def test_another_host_gets_raw_and_one_warning(run):
    run(ROBOT, "rosmaster", "--core", "-p", "11311")
    words = ["_source:=synthetic", "_image_width:=64", "_image_height:=64", "__name:=camera"]
    camera = run(ROBOT, support.executable("camera_node"), *words)
    camera.wait_for_output("synthetic scene")  # the master is there: rostopic waits for none
    words = ["shm", "in:=/camera/image_raw", "raw", "out:=/read", "__name:=reader"]
    reader = run(DESK, REPUBLISH, *words)
    stamps = run(DESK, "rostopic", "echo", "-n", "50", "/read/header/stamp")
    assert stamps.exit_code(60.0) == 0, reader.output()
    reader.wait_for_output(WARNING)
    assert reader.output().count(WARNING) == 1
