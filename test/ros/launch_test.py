#!/usr/bin/env python3
"""The launch files connect camera, brightness and edge detector with the values of config/."""

import pathlib
import sys
import unittest

import rospkg
import rospy
import rostest
import yaml
from sensor_msgs.msg import CameraInfo, Image

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import support

NODES = {"usb_cam": "camera", "brightness": "brightness", "edge_detector": "edge_detector"}
TOPICS = {
    "/usb_cam/image_raw": ("bgr8", Image),
    "/usb_cam/image_mono": ("mono8", Image),
    "/brightness/processed_image": ("bgr8", Image),
    "/edge_detector/processed_image": ("mono8", Image),
}


class LaunchTest(unittest.TestCase):
    def test_frames_go_through_with_their_header(self):
        messages = {topic: support.Messages(topic, kind) for topic, (_, kind) in TOPICS.items()}
        infos = support.Messages("/usb_cam/camera_info", CameraInfo)
        *frames, info = support.same_frame(*messages.values(), infos)
        for image, (encoding, _) in zip(frames, TOPICS.values()):
            self.assertEqual(image.header.frame_id, "head_camera")
            self.assertEqual((image.encoding, image.width, image.height), (encoding, 640, 480))
            self.assertEqual(len(image.data), image.step * image.height)
        self.assertEqual((info.width, info.height), (640, 480))

    def test_the_values_of_config_are_loaded(self):
        config = pathlib.Path(rospkg.RosPack().get_path("robot_vision")) / "config"
        for node, name in NODES.items():
            path = config / (name + ".yaml")
            for key, value in yaml.safe_load(path.read_text()).items():
                self.assertEqual(rospy.get_param(f"/{node}/{key}"), value, key)
            self.assertTrue(rospy.get_param(f"/{node}/config_file").endswith(path.name))


if __name__ == "__main__":
    rospy.init_node("launch_test")
    rostest.rosrun("robot_vision", "launch", LaunchTest)
