"""The camera of the depths that images get."""

import numpy as np
import pytest
import rospy
from fake_params import use_params
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

from robot_vision.ros import depth_input
from robot_vision.ros.transport import KEPT, Frame, FrameError

SIZE = (64, 48)
HEADER = Header(stamp=rospy.Time(1.0), frame_id="camera")
IMAGE = Frame(np.zeros((*SIZE[::-1], 3), np.uint8), "bgr8", HEADER)
DEPTH = Frame(np.ones(SIZE[::-1], np.float32), "32FC1", HEADER)


class Node:
    """What a DepthInput uses of an ImageNode."""

    topic = "/camera/image"

    def image_subscriber(self, *_):
        pass

    subscriber = image_subscriber
    lack = ""

    def __init__(self):
        self.went_on = []  # the frames that were kept, when the work on them was done

    def missing(self, *_, only):
        assert only == "depth"
        return self.lack

    def go_on(self, frame, work):
        work()
        self.went_on.append(frame)


def input_of(monkeypatch, node, go_on, topic="/camera/depth"):
    use_params(monkeypatch, {})
    monkeypatch.setattr(depth_input, "remapped", lambda _: topic)
    return depth_input.DepthInput(node, go_on, "nothing is done")


@pytest.mark.parametrize("is_rectified", [False, True])
def test_the_camera_of_rectified_depths_is_that_of_rectified_images(monkeypatch, is_rectified):
    pairs = []
    depths = input_of(monkeypatch, Node(), lambda *pair: pairs.append(pair))
    depths.set_rectified(is_rectified)
    bent = CameraInfo(width=SIZE[0], height=SIZE[1], distortion_model="plumb_bob")
    bent.K, bent.D = [60.0, 0.0, 32.0, 0.0, 60.0, 24.0, 0.0, 0.0, 1.0], [0.1, 0.0, 0.0, 0.0, 0.0]
    bent.P = [50.0, 0.0, 30.0, 0.0, 0.0, 50.0, 20.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    depths._on_info(bent)
    depths.offer(IMAGE, IMAGE)  # which does not wait, as no depth has come yet
    depths._on_depth(DEPTH)
    depths.offer(IMAGE, IMAGE)
    depth = pairs[-1][1]
    expected = (50.0, []) if is_rectified else (60.0, [0.1, 0.0, 0.0, 0.0, 0.0])
    assert (depth.camera.K[0, 0], list(depth.camera.D)) == expected


@pytest.mark.parametrize("names", [("/eye", "eye"), ("eye", "/eye"), ("", "eye")])
def test_a_slash_before_the_name_of_a_frame_says_nothing(monkeypatch, names):
    pairs = []
    depths = input_of(monkeypatch, Node(), lambda *pair: pairs.append(pair))
    of_image, of_depth = (Header(stamp=rospy.Time(1.0), frame_id=name) for name in names)
    image = Frame(np.zeros((*SIZE[::-1], 3), np.uint8), "bgr8", of_image)
    depths.offer(image, image)
    depths._on_depth(Frame(np.ones(SIZE[::-1], np.float32), "32FC1", of_depth))
    depths.offer(image, image)
    assert pairs[-1][1].header is of_depth


def test_the_first_depth_is_on_its_way_until_it_can_be_compared(monkeypatch):
    node, begins = Node(), []
    depths = input_of(monkeypatch, node, lambda *_: begins.append(depths.may_begin()))
    assert depths.may_begin()
    depths._on_depth(DEPTH)  # with no image yet
    depths.offer(IMAGE, IMAGE)
    assert depths.may_begin()
    node.lack = "no depth on /camera/depth for 3 s"
    assert not depths.may_begin()
    node.lack = ""
    depths._on_depth(DEPTH)
    depths.offer(IMAGE, IMAGE)
    assert not depths.may_begin() and begins == [True, False]
    depths.clear()
    assert depths.may_begin()
    depths.offer(IMAGE, IMAGE)
    with pytest.raises(FrameError):
        depths._on_depth(IMAGE)
    assert not depths.may_begin()


def test_the_reason_why_images_have_no_depth_is_the_newest(monkeypatch):
    node = Node()
    depths = input_of(monkeypatch, node, lambda *_: None)
    depths.offer(at(1.0), "image")
    assert depths.problem() == ""
    with pytest.raises(FrameError) as refused:
        depths._on_depth(at(1.0))
    assert depths.problem() == f"depth on /camera/depth: {refused.value}"
    depths._on_depth(at(1.0, DEPTH))
    assert depths.problem() == ""
    stranger = Header(stamp=rospy.Time(1.1), frame_id="eye")
    with pytest.raises(FrameError):
        depths._on_depth(Frame(DEPTH.image, "32FC1", stranger))
    assert "its frame is 'eye', must be that of the images on /camera/image" in depths.problem()
    node.lack = "no depth on /camera/depth for 3 s"
    assert depths.problem() == node.lack
    node.lack = ""
    depths.clear()
    assert depths.problem() == ""
    for second in range(2, 40):
        depths.offer(at(second), "image")
        depths._on_depth(at(second + 0.5, DEPTH))
    assert depths.problem().startswith("the stamps on /camera/image and /camera/depth do not meet")


def test_without_a_topic_no_depth_is_on_its_way(monkeypatch):
    assert not input_of(monkeypatch, Node(), None, topic="").may_begin()


def at(seconds, of=IMAGE):
    """A frame of another time."""
    return Frame(of.image, of.encoding, Header(stamp=rospy.Time(seconds), frame_id="camera"))


def test_an_image_is_kept_until_its_depth_has_come(monkeypatch):
    node, pairs = Node(), []
    depths = input_of(monkeypatch, node, lambda *pair: pairs.append(pair))
    first, second = at(1.0), at(2.0)
    assert depths.offer(first, "first") is not KEPT  # as there are no depths yet
    depths._on_depth(at(1.0, DEPTH))
    assert pairs == [("first", None)] and not node.went_on
    assert depths.offer(second, "second") is KEPT
    depths._on_depth(at(2.0, DEPTH))
    assert node.went_on == [second]
    assert [(image, depth and depth.header.stamp) for image, depth in pairs] == [
        ("first", None),
        ("second", rospy.Time(2.0)),
    ]
