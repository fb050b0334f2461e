"""What frames of a V4L2 camera cost, inside the VM of test/vivid: vivid_cpu.py OUT

Writes OUT/cpu.json: CPU seconds per frame of YUYV at 640x480, from which what a program takes to
start is left out, of camera_node and of what it is compared with.
"""

import json
import os
import pathlib
import resource
import sys
import time
from typing import Callable, Dict

import cv2
import psutil
import rig
import rospy
from sensor_msgs.msg import Image

DEVICE = "/dev/video0"
FRAMES = 100


def children_seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def of_v4l2_ctl() -> float:
    """A bare loop over the driver's buffers, which looks at no pixel."""

    def cost(frames: int) -> float:
        before = children_seconds()
        rig.v4l2(DEVICE, "--stream-mmap", f"--stream-count={frames}", "--stream-poll")
        return children_seconds() - before

    rig.v4l2(DEVICE, "--set-fmt-video=width=640,height=480,pixelformat=YUYV", "--set-parm=25")
    return (cost(10 + FRAMES) - cost(10)) / FRAMES


def of_opencv() -> float:
    """cv2.VideoCapture, which makes BGR of each frame."""
    capture = cv2.VideoCapture(DEVICE, cv2.CAP_V4L2)
    capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter_fourcc(*"YUYV"))
    capture.set(cv2.CAP_PROP_FPS, 25)
    for _ in range(10):
        assert capture.read()[0], "OpenCV gets no frame"
    before = time.process_time()
    for _ in range(FRAMES):
        assert capture.read()[0], "OpenCV gets no frame"
    used = time.process_time() - before
    capture.release()
    return used / FRAMES


def of_camera_node(out: pathlib.Path, name: str, *arguments: str) -> float:
    """camera_node, with a subscriber to its images in this process."""
    camera = rig.Camera(out, name, DEVICE, *arguments)
    try:
        arrivals = rig.Arrivals(f"/{name}/image_raw", Image)
        arrivals.wait_for_more(10)
        process = psutil.Process(camera.pid)
        before = process.cpu_times()
        arrivals.wait_for_more(FRAMES)
        after = process.cpu_times()
        arrivals.close()
    finally:
        camera.end()
    return (after.user + after.system - before.user - before.system) / FRAMES


def main() -> None:
    out = pathlib.Path(sys.argv[1])
    rospy.init_node("vivid_cpu", disable_signals=True)
    contenders: Dict[str, Callable[[], float]] = {
        "camera_node, native": lambda: of_camera_node(out, "native", "_output_encoding:=native"),
        "camera_node, bgr8": lambda: of_camera_node(out, "bgr8"),
        "v4l2-ctl --stream-mmap": of_v4l2_ctl,
        "cv2.VideoCapture": of_opencv,
    }
    figures = {name: cost() for name, cost in contenders.items()}
    (out / "cpu.json").write_text(json.dumps(figures))
    os._exit(0)  # rospy's threads would have it wait


if __name__ == "__main__":
    main()
