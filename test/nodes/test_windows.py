"""What people see on a display: the windows of the launch files, in a virtual X server."""

import os
import shutil
import subprocess

import numpy as np
import pytest
import support


@pytest.fixture
def display(start, tmp_path, monkeypatch):
    """A virtual X server for this process and its children; gives its frame buffer's file."""
    # Without -noreset it turns clients away whenever the last one has gone, as xdotool does.
    options = ["-displayfd", "1", "-noreset", "-fbdir", tmp_path, "-screen", "0", "1400x1100x24"]
    process = start(shutil.which("Xvfb"), *options)
    number = support.wait_for(lambda: process.output().split(), "the X server")[-1]
    monkeypatch.setenv("DISPLAY", ":" + number)
    return tmp_path / "Xvfb_screen0"


def windows():
    """The names of the windows that can be seen, with their numbers."""
    search = ["xdotool", "search", "--onlyvisible", "--name", "."]
    found = subprocess.run(search, stdout=subprocess.PIPE, check=False, text=True).stdout.split()
    names = {}
    for number in found:
        command = ["xdotool", "getwindowname", number]
        name = subprocess.run(
            command, stdout=subprocess.PIPE, check=False, text=True
        ).stdout.strip()
        names[name] = number
    return names


def screen(frame_buffer):
    """The pixels on the screen, (height, width, 3), BGR, from X's window dump (X11/XWDFile.h)."""
    data = frame_buffer.read_bytes()
    head = np.frombuffer(data[:100], ">u4")
    header_size, width, height, row, colors = head[0], head[4], head[5], head[12], head[19]
    pixels = np.frombuffer(data, np.uint8, row * height, header_size + 12 * colors)
    return pixels.reshape(height, row)[:, : 4 * width].reshape(height, width, 4)[:, :, :3]


def test_demo_opens_a_window_for_each_node(start, display):
    start("/usr/bin/roslaunch", "robot_vision", "demo.launch", "view:=true")
    topics = {"/usb_cam/image_raw", "/brightness/processed_image", "/edge_detector/processed_image"}
    support.wait_for(lambda: topics <= set(windows()), "the windows")
    subprocess.run(["xdotool", "windowraise", windows()["/usb_cam/image_raw"]], check=True)

    def ball_is_seen():
        blue, green, red = np.moveaxis(screen(display).astype(int), 2, 0)
        return np.count_nonzero((blue > green + 60) & (blue > red + 60)) > 500

    support.wait_for(ball_is_seen, "the scene's blue ball on the screen")


@pytest.mark.skipif(os.path.exists("/dev/video0"), reason="there is a camera: it would be used")
def test_the_course_s_launch_file_waits_for_its_camera(start, display):
    process = start("/usr/bin/roslaunch", "robot_vision", "usb_cam-test.launch")
    process.wait_for_output("/dev/video0: cannot be opened")
    support.wait_for(lambda: "/usb_cam/image_raw" in windows(), "image_view's window")
