"""The camera of the depths that images get."""

import numpy as np
import pytest
import rospy
from fake_params import use_params
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

from robot_vision.ros import depth_input
from robot_vision.ros.transport import Frame, FrameError

SIZE = (64, 48)


class Node:
    """What a DepthInput uses of an ImageNode."""

    topic = "/camera/image"

    def image_subscriber(self, *_):
        pass

    subscriber = image_subscriber

    def missing(self, only):
        return ""


@pytest.fixture
def input_and_pairs(monkeypatch):
    """A DepthInput, and what it gives on."""
    use_params(monkeypatch, {})
    monkeypatch.setattr(depth_input, "remapped", lambda name: f"/camera/{name}")
    pairs = []
    made = depth_input.DepthInput(Node(), lambda *pair: pairs.append(pair), "nothing is done")
    return made, pairs


@pytest.mark.parametrize("is_rectified", [False, True])
def test_the_camera_of_rectified_depths_is_that_of_rectified_images(input_and_pairs, is_rectified):
    depths, pairs = input_and_pairs
    depths.set_rectified(is_rectified)
    bent = CameraInfo(width=SIZE[0], height=SIZE[1], distortion_model="plumb_bob")
    bent.K, bent.D = [60.0, 0.0, 32.0, 0.0, 60.0, 24.0, 0.0, 0.0, 1.0], [0.1, 0.0, 0.0, 0.0, 0.0]
    bent.P = [50.0, 0.0, 30.0, 0.0, 0.0, 50.0, 20.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    depths._on_info(bent)
    header = Header(stamp=rospy.Time(1.0), frame_id="camera")
    image = Frame(np.zeros((*SIZE[::-1], 3), np.uint8), "bgr8", header)
    depths.offer(image, SIZE)  # which does not wait, as no depth has come yet
    depths._on_depth(Frame(np.ones(SIZE[::-1], np.float32), "32FC1", header))
    depths.offer(image, SIZE)
    depth = pairs[-1][1]
    expected = (50.0, []) if is_rectified else (60.0, [0.1, 0.0, 0.0, 0.0, 0.0])
    assert (depth.camera.K[0, 0], list(depth.camera.D)) == expected


@pytest.mark.parametrize("names", [("/eye", "eye"), ("eye", "/eye"), ("", "eye")])
def test_a_slash_before_the_name_of_a_frame_says_nothing(input_and_pairs, names):
    depths, pairs = input_and_pairs
    of_image, of_depth = (Header(stamp=rospy.Time(1.0), frame_id=name) for name in names)
    image = Frame(np.zeros((*SIZE[::-1], 3), np.uint8), "bgr8", of_image)
    depths.offer(image, SIZE)
    depths._on_depth(Frame(np.ones(SIZE[::-1], np.float32), "32FC1", of_depth))
    depths.offer(image, SIZE)
    assert pairs[-1][1].header is of_depth
    other = Header(stamp=rospy.Time(1.0), frame_id="/other_eye")
    if names[0]:
        with pytest.raises(FrameError, match="its frame is '/other_eye', must be that of the im"):
            depths._on_depth(Frame(np.ones(SIZE[::-1], np.float32), "32FC1", other))
