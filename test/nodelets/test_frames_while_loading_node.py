"""A nodelet that subscribes when it is loaded gets frames, although frames come meanwhile."""

import pytest
import rospy
import support
from python_manager import PythonManager
from sensor_msgs.msg import Image

LOADS = 25  # each has a chance that a frame comes before the nodelet has started


@pytest.fixture
def manager(start):
    made = PythonManager(start)
    # Fast and small: a frame comes in nearly each moment of the start of another nodelet.
    for name, value in {"source": "synthetic", "image_width": 64, "image_height": 64}.items():
        rospy.set_param(f"/eye/{name}", value)
    rospy.set_param("/eye/framerate", 500.0)
    made.load("/eye", "robot_vision/camera")
    return made


def test_a_nodelet_gets_frames_whenever_it_is_loaded(manager):
    rospy.set_param("/light/always_subscribe", True)
    images = support.Messages("/eye/image_raw", Image)
    images.wait()
    for _ in range(LOADS):
        manager.load("/light", "robot_vision/brightness", {"/image": "/eye/image_raw"})
        light = support.Messages("/light/processed_image", Image)
        light.wait(2)
        light.close()
        assert manager.unload("/light")
