"""What people see on a display: the windows of the launch files, in a virtual X server."""

import os
import subprocess

import numpy as np
import pytest
import support


def test_demo_opens_a_window_for_each_node(start, display):
    start("/usr/bin/roslaunch", "robot_vision", "demo.launch", "view:=true")
    topics = {"/usb_cam/image_raw", "/brightness/processed_image", "/edge_detector/processed_image"}
    support.wait_for(lambda: topics <= set(support.windows()), "the windows")
    subprocess.run(["xdotool", "windowraise", support.windows()["/usb_cam/image_raw"]], check=True)

    def ball_is_seen():
        blue, green, red = np.moveaxis(support.screen(display).astype(int), 2, 0)
        return np.count_nonzero((blue > green + 60) & (blue > red + 60)) > 500

    support.wait_for(ball_is_seen, "the scene's blue ball on the screen")


@pytest.mark.skipif(os.path.exists("/dev/video0"), reason="there is a camera: it would be used")
def test_the_course_s_launch_file_waits_for_its_camera(start, display):
    process = start("/usr/bin/roslaunch", "robot_vision", "usb_cam-test.launch")
    process.wait_for_output("/dev/video0: cannot be opened")
    support.wait_for(lambda: "/usb_cam/image_raw" in support.windows(), "image_view's window")
