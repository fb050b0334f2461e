"""The node dense_flow: what it publishes of frames that move in a known way."""

import cv2
import numpy as np
import pytest
import rospy
import support
from frames import Camera, pixels
from geometry_msgs.msg import Vector3Stamped
from sensor_msgs.msg import Image

import robot_vision as rv

RATE = 10.0  # Hz
SHIFT = np.array([4, -2])  # px per frame
NOISE = np.random.default_rng(1).integers(0, 256, (60, 80, 3), np.uint8)
TEXTURE = cv2.resize(NOISE, (320, 240), interpolation=cv2.INTER_CUBIC)


def frame(number):
    """The texture, moved on with each frame."""
    return np.ascontiguousarray(np.roll(TEXTURE, tuple(number * SHIFT[::-1]), (0, 1))[:120, :160])


def flow_of(number, **values):
    """The flow to a frame as the core finds it."""
    params = rv.DenseFlowParams()
    for name, value in values.items():
        setattr(params, name, value)
    finder = rv.DenseFlow(params)
    finder.update(0.0, frame(number - 1))
    return finder.update(0.1, frame(number))


class Watched:
    """A camera, the node behind it, and its topics."""

    def __init__(self, start, *arguments, topics=None):
        self._diagnostics = support.Diagnostics()
        self._shown = 0
        self.camera = Camera(RATE)
        words = f"image:={self.camera.topic}", "_diagnostic_period:=0.02", *arguments
        self.process = start("dense_flow_node", "__name:=flow", *words)
        kinds = {name: Vector3Stamped for name in ("mean", "median")}
        self.topics = {
            name: support.subscribed(f"/flow/{name}", kinds.get(name, Image))
            for name in topics or ("flow", "mean", "median", "processed_image")
        }
        self.camera.wait_for()

    def begin(self, number):
        """Shows a frame of which the node says nothing; the next one would take its place."""
        header = self.camera.show(frame(number))
        self._shown += 1
        support.wait_for(
            lambda: self._diagnostics.value("flow", "frames received") == str(self._shown),
            "the frame's way through the node",
        )
        return header

    def answers(self, number):
        """What the node says of a frame, by topics; all of it has the frame's header."""
        header = self.camera.show(frame(number))
        self._shown += 1
        found = {name: topic.of(header.stamp) for name, topic in self.topics.items()}
        assert all(message.header.frame_id == "eye" for message in found.values())
        return found


def test_flow_speeds_and_colors_are_those_of_the_core(start):
    watched = Watched(start)
    first = watched.begin(0)
    found = watched.answers(1)
    flow = flow_of(1)
    assert np.array_equal(pixels(found["flow"]), flow)
    for name, speed in (("mean", rv.mean_flow(flow)), ("median", rv.median_flow(flow))):
        vector = found[name].vector
        assert (vector.x, vector.y) == pytest.approx(np.multiply(speed, RATE), rel=1e-5)
        assert vector.z == 0.0
    median = found["median"].vector
    assert (median.x, median.y) == pytest.approx(SHIFT * RATE, abs=1.0)
    assert np.array_equal(pixels(found["processed_image"]), rv.flow_to_colors(flow))
    for topic in watched.topics.values():  # nothing is said of the first frame
        assert first.stamp not in map(support.stamp_of, topic.received)


def test_drawing_is_changed_live_without_a_gap_and_the_method_with_one(start):
    watched = Watched(start, "_scale:=1.0", topics=("flow", "processed_image"))
    watched.begin(0)
    watched.answers(1)
    config = support.reconfigured("/flow", draw="arrows", arrow_spacing=20, arrow_scale=2.0)
    assert config["draw"] == "arrows"
    found = watched.answers(2)
    expected, flow = frame(2), flow_of(2, scale=1.0)
    rv.draw_flow_arrows(expected, flow, 20, 2.0)
    assert np.array_equal(pixels(found["processed_image"]), expected)
    assert np.array_equal(pixels(found["flow"]), flow)
    support.reconfigured("/flow", method="farneback", draw="wheel", max_speed=9.0)
    before = watched.begin(3)  # begins anew
    found = watched.answers(4)
    assert before.stamp not in map(support.stamp_of, watched.topics["flow"].received)
    flow = flow_of(4, scale=1.0, method="farneback")
    assert np.array_equal(pixels(found["flow"]), flow)
    assert np.array_equal(pixels(found["processed_image"]), rv.flow_to_colors(flow, 9.0))
    config = support.reconfigured("/flow", method="magic", window=9)
    assert (config["method"], config["window"]) == ("farneback", 15)
    watched.process.wait_for_output("stay as they are: method is magic, must be farneback or dis")
    support.reconfigured("/flow", draw="circles")
    watched.process.wait_for_output("stay as they are: draw is circles, must be wheel or arrows")


def test_speeds_need_no_other_topic(start):
    watched = Watched(start, topics=("median",))
    watched.begin(0)
    assert watched.answers(1)["median"].vector.x == pytest.approx(SHIFT[0] * RATE, abs=1.0)


def test_after_a_time_without_subscribers_the_first_frame_has_no_flow(start):
    watched = Watched(start, topics=("median",))
    watched.begin(0)
    watched.answers(1)
    watched.topics["median"].close()
    watched.camera.wait_for(0)
    watched.topics["median"] = support.subscribed("/flow/median", Vector3Stamped)
    watched.camera.wait_for()
    first = watched.begin(7)
    median = watched.answers(8)["median"].vector
    assert (median.x, median.y) == pytest.approx(SHIFT * RATE, abs=1.0)
    assert first.stamp not in map(support.stamp_of, watched.topics["median"].received)


def test_it_is_a_nodelet_behind_the_camera(start):
    manager = support.NodeletManager(start)
    rospy.set_param("/camera/source", "synthetic")
    assert manager.load("/camera", "camera")
    assert manager.load("/flow", "dense_flow", {"/image": "/camera/image_raw"})
    (message,) = support.Messages("/flow/flow", Image).wait()
    assert (message.header.frame_id, *pixels(message).shape) == ("head_camera", 480, 640, 2)


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("method", "magic", "method is magic, must be farneback or dis"),
        ("max_speed", -1.0, "max_speed is -1, must be from 0 to 1000"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "dense_flow_node", name, value, text)
