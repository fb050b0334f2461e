"""A process that uses images ends at once, with the right code, and without messages."""

import time
from typing import NamedTuple

import pytest

HEAD = """
import gc, os, signal, sys, threading, time
import numpy as np
import rospy
from robot_vision.ros.context import LoadedContext, active
from robot_vision.ros.node_images import process_runtime
from robot_vision.ros.startup import run_node
from robot_vision.transport import CameraSubscriber, ImagePublisher, ImageSubscriber

came = threading.Event()
frames = []

def keep(frame):
    frames.append(frame)
    came.set()

def wait():
    assert came.wait(30)
"""
INIT = "rospy.init_node('ends', anonymous=True)\n"
NODELET = f"""{INIT}
runtime, eye = process_runtime(), rospy.resolve_name("~eye")
rospy.set_param(eye, {{"source": "synthetic", "image_width": 160, "image_height": 120}})
runtime.load_nodelet(eye, "robot_vision/camera", {{}}, [])
"""
SUBSCRIBE = INIT + "images = ImageSubscriber('image', keep)\n"
CRIES = [
    "terminate called",
    "LibraryUnloadException",
    "Fatal Python error",
    "Segmentation fault",
    "pure virtual",
    "SEVERE WARNING",
    "Exception ignored",
    "signal_shutdown hook error",
]


class End(NamedTuple):
    """How a script ends."""

    script: str
    code: int = 0
    output: str = ""  # what is in it


ENDS = {
    "end of main": End(SUBSCRIBE + "wait()"),
    "before the first frame": End(SUBSCRIBE),
    "at once": End(INIT + "ImageSubscriber('image', keep)"),
    "nothing but the publisher": End(INIT + "output = ImagePublisher('~out')"),
    "sys.exit in main": End(SUBSCRIBE + "wait(); sys.exit(3)", 3),
    "exception in main": End(SUBSCRIBE + "wait(); 1 / 0", 1, "ZeroDivisionError"),
    "without init_node": End("ImageSubscriber('image', keep)", 1, "rospy.init_node() first"),
    "sys.exit in the callback": End(
        INIT + "ImageSubscriber('image', lambda _: sys.exit(3)); rospy.spin(); print('the end')",
        output="the end",
    ),
    "signal_shutdown in the callback": End(
        INIT + "ImageSubscriber('image', lambda _: rospy.signal_shutdown('')); rospy.spin()\n"
        "print('the end')",
        output="the end",
    ),
    "SIGINT in the callback": End(
        INIT + "ImageSubscriber('image', lambda _: os.kill(os.getpid(), signal.SIGINT))\n"
        "rospy.spin(); print('the end')",
        output="the end",
    ),
    "the callback always raises": End(
        INIT + "ImageSubscriber('image', lambda frame: (keep(frame), 1 / 0))\n"
        "while len(frames) < 2: time.sleep(0.01)",  # the first one's error has been logged
        output="ZeroDivisionError",
    ),
    "the callback sleeps": End(
        INIT + "ImageSubscriber('image', lambda frame: (keep(frame), time.sleep(60))); wait()"
    ),
    "the callback sleeps, SIGINT": End(
        INIT + "ImageSubscriber('image', lambda frame: (keep(frame), time.sleep(60)))\n"
        "wait(); os.kill(os.getpid(), signal.SIGINT); rospy.spin(); print('the end')",
        output="the end",
    ),
    "the callback works without pause": End(
        INIT + "def work(frame):\n"
        "    keep(frame)\n"
        "    while True:\n"
        "        frame.image.astype(float).sum()\n"
        "ImageSubscriber('image', work); wait()"
    ),
    "deleted before the first frame": End(
        SUBSCRIBE + "images.unregister(); del images; gc.collect()"
    ),
    "deleted after frames": End(
        SUBSCRIBE + "wait(); images.unregister(); del images; gc.collect()"
    ),
    "only the name deleted": End(SUBSCRIBE + "del images; wait()"),
    "frames read after the shutdown": End(
        SUBSCRIBE + "wait(); rospy.signal_shutdown('')\n"
        "total = sum(int(frame.image.sum()) for frame in frames)\n"
        "frames.clear(); gc.collect(); print('the end')",
        output="the end",
    ),
    "frames kept where only the interpreter's end frees them": End(
        SUBSCRIBE + "wait(); sys.frames = frames; np.kept = [f.image[::2] for f in frames]"
    ),
    "decoded frames kept where only the interpreter's end frees them": End(
        INIT + "images = ImageSubscriber('image', keep, transport='compressed')\n"
        "wait(); sys.frames = frames"
    ),
    "a nodelet's frames kept where only the interpreter's end frees them": End(
        NODELET + "ImageSubscriber('~eye/image_raw', keep); wait(); sys.frames = frames"
    ),
    "a nodelet unloaded, its frames freed later": End(
        NODELET + "images = ImageSubscriber('~eye/image_raw', keep); wait()\n"
        "assert runtime.unload_nodelet(eye); images.unregister(); frames.clear(); gc.collect()"
    ),
    "a nodelet and a callback that sleeps, SIGINT": End(
        NODELET + "ImageSubscriber('~eye/image_raw', lambda f: (keep(f), time.sleep(60)))\n"
        "wait(); os.kill(os.getpid(), signal.SIGINT); rospy.spin(); print('the end')",
        output="the end",
    ),
    "many nodes, in one of which a callback sleeps": End(
        INIT + "nodes = [LoadedContext(f'/n{i}', {}, print) for i in range(5)]\n"
        "for i, node in enumerate(nodes):\n"
        "    with active(node):\n"
        "        output = ImagePublisher('~out')\n"
        "        def work(frame, sleeps=not i):\n"
        "            keep(frame)\n"
        "            time.sleep(60 * sleeps)\n"
        "        ImageSubscriber('/camera/image_raw', work, 'mono8')\n"
        "wait()"
    ),
    "the end of each node before that of the process": End(
        INIT + "nodes = [LoadedContext(f'/n{i}', {}, print) for i in range(5)]\n"
        "for node in nodes:\n"
        "    with active(node):\n"
        "        ImageSubscriber('/camera/image_raw', keep, 'mono8')\n"
        "wait(); [node.end() for node in nodes]; print(threading.active_count())",
    ),
    "subscribed after the shutdown": End(
        SUBSCRIBE + "rospy.signal_shutdown(''); ImageSubscriber('other', keep)",
        1,
        "the node has been shut down",
    ),
    "first subscribed after the shutdown": End(
        INIT + "rospy.signal_shutdown(''); ImageSubscriber('image', keep)",
        1,
        "the node has been shut down",
    ),
    "publisher and subscriber in one process": End(
        INIT + "output = ImagePublisher('~out')\n"
        "copies = ImageSubscriber('~out', keep)\n"
        "def forward(frame):\n"
        "    output.publish(frame.image, frame.encoding, frame.header)\n"
        "ImageSubscriber('image', forward); wait()"
    ),
    "publishing from threads": End(
        INIT + "output = ImagePublisher('~out')\n"
        "copies = ImageSubscriber('~out', keep)\n"
        "def work():\n"
        "    while True:\n"
        "        output.publish(np.zeros((480, 640, 3), np.uint8))\n"
        "for _ in range(3):\n"
        "    threading.Thread(target=work, daemon=True).start()\n"
        "wait()"
    ),
    "OpenCV works in threads when a node ends": End(
        "import cv2\n"
        "def work():\n"
        "    while True:\n"
        "        cv2.GaussianBlur(np.zeros((500, 500), np.uint8), (31, 31), 0)\n"
        "def begin():\n"
        "    for _ in range(4):\n"
        "        threading.Thread(target=work, daemon=True).start()\n"
        "run_node('ends', begin, lambda _: None)"
    ),
    "images with camera_info": End(
        INIT + "images = CameraSubscriber('image', keep); wait(); assert frames[0].camera_info"
    ),
}
RANDOM_MOMENTS = """
def start():
    print("starting", flush=True)
    output = ImagePublisher("~out")
    images = ImageSubscriber("image", lambda f: output.publish(f.image, f.encoding), "bgr8")
    copies = ImageSubscriber("~out", keep)
    return images, output, copies

run_node("interrupted_{}", start)
"""
TOGETHER = 4  # processes at a time


@pytest.fixture(scope="module")
def camera(start_once):
    size = ["_image_width:=160", "_image_height:=120"]
    return start_once("camera_node", "__name:=camera", "_source:=synthetic", *size)


@pytest.fixture
def run(camera, run_script):
    """run(script) starts a script as a node whose topic `image` is a camera's."""
    return lambda script: run_script(HEAD + script, "image:=/camera/image_raw")


def assert_silent_end(process, name, code):
    assert process.exit_code() == code, (name, process.output())
    for cry in CRIES:
        assert cry not in process.output(), (name, process.output())


@pytest.mark.parametrize("first", range(0, len(ENDS), TOGETHER))
def test_every_way_to_end(run, first):
    ends = list(ENDS.items())[first : first + TOGETHER]
    processes = [run(end.script) for _, end in ends]
    for process, (name, end) in zip(processes, ends):
        assert_silent_end(process, name, end.code)
        assert end.output in process.output(), name


@pytest.mark.parametrize("first", range(0, 12, TOGETHER))
def test_sigint_at_any_moment(run, first):
    moments = [0.03 * (number % 12) ** 2 for number in range(first, first + TOGETHER)]  # s
    processes = []
    for moment in moments:
        process = run(RANDOM_MOMENTS.format(len(processes)))
        process.wait_for_output("starting")
        processes.append(process)
        time.sleep(moment)
        process.interrupt()
    for process, moment in zip(processes, moments):
        assert_silent_end(process, moment, 0)
        assert "did not end within" not in process.output()
