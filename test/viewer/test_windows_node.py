"""What people see on a display: the windows of the launch files, in a virtual X server."""

import itertools
import os
import subprocess

import numpy as np
import pytest
import support
from ros_programs import ROSLAUNCH

from robot_vision.demo.window_tiles import place_of, tile


def test_demo_opens_a_window_for_each_node(start, display):
    start(ROSLAUNCH, "robot_vision", "demo.launch", "view:=true")
    topics = {"/usb_cam/image_raw", "/brightness/processed_image", "/edge_detector/processed_image"}
    support.wait_for(lambda: topics <= set(support.windows()), "the windows")
    subprocess.run(["xdotool", "windowraise", support.windows()["/usb_cam/image_raw"]], check=True)

    def ball_is_seen():
        blue, green, red = np.moveaxis(support.screen(display).astype(int), 2, 0)
        return np.count_nonzero((blue > green + 60) & (blue > red + 60)) > 500

    support.wait_for(ball_is_seen, "the scene's blue ball on the screen")

    def apart():
        """Whether all windows are there, and none lies on another one."""
        areas = [geometry(window) for window in support.windows().values()]
        overlaps = (overlap(one, other) for one, other in itertools.combinations(areas, 2))
        return len(areas) == 13 and not any(overlaps)

    support.wait_for(apart, "thirteen windows side by side")


def geometry(window):
    """x, y, width and height of a window on the screen, px."""
    command = ["xdotool", "getwindowgeometry", "--shell", window]
    lines = subprocess.run(command, stdout=subprocess.PIPE, check=False, text=True).stdout.split()
    values = dict(line.split("=") for line in lines)
    return tuple(int(values.get(name, 0)) for name in ("X", "Y", "WIDTH", "HEIGHT"))


def overlap(one, other):
    return all(
        start < other_start + other_length and other_start < start + length
        for start, other_start, length, other_length in zip(one, other, one[2:], other[2:])
    )


@pytest.mark.parametrize(
    "title, number",
    [("/a", 0), ("/a  30 Hz", 2), ("/a/b", 1), ("/a/b  30 Hz", 1), ("/abc", None), ("", None)],
)
def test_a_window_is_known_by_its_title(title, number):
    assert place_of(title, ["/a", "/a/b", "/a "]) == number


@pytest.mark.parametrize("count", [12, 24])
def test_tiles_fill_the_screen_and_do_not_overlap(count):
    tiles = [tile(number, count, (1283, 1025)) for number in range(count)]
    assert not any(overlap(one, other) for one, other in itertools.combinations(tiles, 2))
    assert max(x + width for x, _, width, _ in tiles) == 1283
    assert max(y + height for _, y, _, height in tiles) == 1025


@pytest.mark.skipif(os.path.exists("/dev/video0"), reason="there is a camera: it would be used")
def test_the_course_s_launch_file_waits_for_its_camera(start, display):
    process = start(ROSLAUNCH, "robot_vision", "usb_cam-test.launch")
    process.wait_for_output("/dev/video0: cannot be opened")
    support.wait_for(lambda: "/usb_cam/image_raw" in support.windows(), "image_view's window")
