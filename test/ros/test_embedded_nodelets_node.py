"""Nodelets in C++ inside a process of Python nodes: their frames, names, ends and errors."""

import re

import numpy as np
import pytest
import rospy
import support
from loaded_contexts import ImageTaker
from sensor_msgs.msg import Image

from robot_vision.ros.node_images import process_runtime

SCENE = {"source": "synthetic", "image_width": 160, "image_height": 120}


@pytest.fixture
def load(start):
    """load(name, type, remappings, arguments, **parameters) loads a nodelet into this process."""
    runtime, loaded = process_runtime(), set()

    def load_nodelet(name, kind="robot_vision/camera", remappings=None, arguments=(), **parameters):
        rospy.set_param(name, parameters or SCENE)
        loaded.add(name)
        runtime.load_nodelet(name, kind, remappings or {}, list(arguments))

    yield load_nodelet
    for name in loaded:
        runtime.unload_nodelet(name)
        rospy.delete_param(name)


def test_frames_of_a_nodelet_come_to_all_nodes_and_to_other_processes(load):
    load("/camera")
    takers = [ImageTaker(f"/n{i}", "/camera/image_raw") for i in range(3)]
    outside = support.Messages("/camera/image_raw", Image)

    def common():
        """The frames of a stamp that all takers have."""
        received = [{one.header.stamp: one for one in list(taker.received)} for taker in takers]
        stamps = set.intersection(*map(set, received))
        return len(stamps) >= 5 and [[of[stamp] for of in received] for stamp in stamps]

    for frames in support.wait_for(common, "frames that all takers have"):
        assert len({frame.image.ctypes.data for frame in frames}) == 1

    def both():
        """The pixels of frames that both have; header.seq is another for each way of an image."""
        inside = {frame.header.stamp: frame.image for frame in list(takers[0].received)}
        return [
            (np.frombuffer(message.data, np.uint8), inside[message.header.stamp].ravel())
            for message in list(outside.received)
            if message.header.stamp in inside
        ]

    for theirs, ours in support.wait_for(both, "a frame that both have"):
        assert np.array_equal(theirs, ours)
    assert support.publishers_of("/camera/image_raw") == ["/test_images"]


def test_names_are_absolute_and_remapped(load):
    load("/deep/camera", remappings={"/deep/camera/image_raw": "/elsewhere/image"})
    assert len(ImageTaker("/n", "/elsewhere/image").wait(2)) == 2
    assert support.publishers_of("/deep/camera/image_raw") == []
    assert support.publishers_of("/deep/camera/parameter_updates") == ["/test_images"]


def test_a_chain_of_nodelets_and_python(load):
    load("/camera")
    load(
        "/brighter",
        "robot_vision/brightness",
        {"/image": "/camera/image_raw"},
        offset=255.0,
    )
    frame = ImageTaker("/n", "/brighter/processed_image").wait(2)[1]
    assert (frame.image == 255).all()
    assert process_runtime().nodelets() == ["/brighter", "/camera"]


def test_an_unloaded_nodelet_is_gone_and_its_frames_stay(load):
    load("/camera")
    load("/other")
    taker, other = ImageTaker("/n", "/camera/image_raw"), ImageTaker("/m", "/other/image_raw")
    frames = taker.wait(5)
    before = [frame.image.copy() for frame in frames]
    runtime = process_runtime()
    assert runtime.unload_nodelet("/camera")
    assert not runtime.unload_nodelet("/camera")
    assert runtime.nodelets() == ["/other"]
    support.wait_for(
        lambda: support.publishers_of("/camera/image_raw") == [], "the end of the topic"
    )
    count = len(other.received)
    other.wait(count + 3)
    assert all(np.array_equal(frame.image, kept) for frame, kept in zip(frames, before))
    runtime.load_nodelet("/camera", "robot_vision/camera", {}, [])
    count = len(taker.received)
    taker.wait(count + 2)


def test_what_cannot_be_loaded_says_why(load):
    runtime = process_runtime()
    with pytest.raises(RuntimeError, match=r"robot_vision/semaphore .* does not exist"):
        load("/semaphore", "robot_vision/semaphore")
    with pytest.raises(RuntimeError, match="image_width is 'wide', must be an integer"):
        load("/wide", image_width="wide")
    load("/camera")
    with pytest.raises(RuntimeError, match="a nodelet of the name /camera is loaded already"):
        load("/camera")
    assert runtime.nodelets() == ["/camera"]
    assert support.publishers_of("/wide/image_raw") == []
    ImageTaker("/n", "/camera/image_raw").wait()
    rospy.set_param("/wide", SCENE)
    load("/wide")
    ImageTaker("/m", "/wide/image_raw").wait()


def test_types_are_those_of_all_packages():
    types = process_runtime().nodelet_types()
    assert {"robot_vision/camera", "image_proc/rectify"} <= set(types)
    assert all(re.fullmatch(r"\w+/\w+", name) for name in types)
