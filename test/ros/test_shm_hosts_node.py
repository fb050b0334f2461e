"""Readers of another user and on another host, who cannot read the memory, and a small /dev/shm."""

import shutil
import subprocess

import pytest
import support
from frames import Source, message, new_topic, noise
from sensor_msgs.msg import Image
from shared_images import REPUBLISH, Reader, share, uses_raw, uses_shm
from two_hosts import DESK, ROBOT, network_of_two, runner
from unprivileged import BECOME_NOBODY, needs_root, skip_unless_all_may_look

MOUNT = 'mount -t tmpfs -o size=1m tmpfs /dev/shm && exec "$@"'
LITTLE_SHM = ["unshare", "--mount", "sh", "-c", MOUNT, "sh"]
WARNING = "images come over raw, not shm: "


@needs_root
def test_another_user_gets_raw_and_one_warning(start):
    skip_unless_all_may_look()
    source, topic = Source(new_topic()), new_topic()
    share(start, source.topic, topic)
    source.wait_for()
    image = message(noise("bgr8"), "bgr8")
    reader = Reader(start, topic, "shm", shutil.which("env"), *BECOME_NOBODY)
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


def test_a_dev_shm_smaller_than_an_image_does_not_matter(start):
    tried = subprocess.run([*LITTLE_SHM, "true"], check=False, stderr=subprocess.DEVNULL)
    if tried.returncode != 0:
        pytest.skip("no mount namespaces to be had here")
    words = ["_source:=synthetic", "_image_width:=1920", "_image_height:=1080", "_framerate:=5"]
    limited = [shutil.which(LITTLE_SHM[0]), *LITTLE_SHM[1:]]
    start(*limited, support.executable("camera_node"), *words, "__name:=large")
    readers = [Reader(start, "/large/image_raw", "shm", *limited) for _ in range(3)]
    outputs = [support.Messages(reader.target, Image) for reader in readers]
    for reader, out in zip(readers, outputs):
        support.wait_for(lambda one=reader: uses_shm(one.node, "/large/image_raw"), "shm")
        image = out.wait(len(out.received) + 5)[-1]
        assert (image.width, image.height, len(image.data)) == (1920, 1080, 1920 * 1080 * 3)
        assert WARNING not in reader.process.output()


def test_64_descriptors_are_enough(start):
    """With some less roscpp takes no connections: it keeps 32 free."""
    limited = shutil.which("prlimit"), "--nofile=64"
    words = ["_source:=synthetic", "_image_width:=64", "_image_height:=64", "__name:=frugal"]
    start(*limited, support.executable("camera_node"), *words)
    readers = [Reader(start, "/frugal/image_raw", "shm", *limited) for _ in range(3)]
    outputs = [support.Messages(reader.target, Image) for reader in readers]
    for reader, out in zip(readers, outputs):
        support.wait_for(lambda one=reader: uses_shm(one.node, "/frugal/image_raw"), "shm")
        out.wait(len(out.received) + 5)
        assert WARNING not in reader.process.output()
