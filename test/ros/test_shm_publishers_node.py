"""Publishers of shm that come, go, are killed and start again: the images go on."""

import time

import numpy as np
import pytest
import rosgraph
import rospy
import support
from frames import Frames, Source, message, new_topic, noise
from sensor_msgs.msg import Image
from shared_images import REPUBLISH, Reader, uses_raw, uses_shm

from robot_vision.msg import ShmImage

ROUNDS = 5
DROPPED = "frames not shared"  # on /diagnostics
RATE = 30.0  # Hz, at which images are sent at most, each when a plain subscriber has the one before


class CameraNode:
    """A camera of the synthetic scene, which can be killed and started again."""

    def __init__(self, start, name, *arguments):
        self._start, self._words = start, [f"__name:={name}", "_source:=synthetic", *arguments]
        self.topic = f"/{name}/image_raw"
        self.process = None

    def begin(self, width, height, encoding="bgr8", *arguments):
        self.process = self._start(
            "camera_node",
            *self._words,
            f"_image_width:={width}",
            f"_image_height:={height}",
            f"_output_encoding:={encoding}",
            *arguments,
        )

    def kill(self):
        self.process.kill()
        self.process.exit_code()


class FarCamera(rospy.SubscribeListener):
    """A camera of another host: what it shares cannot be read here."""

    def __init__(self, topic):
        self.connections = 0
        self._raw = rospy.Publisher(topic, Image, queue_size=1)
        self._shared = rospy.Publisher(
            topic + "/shm", ShmImage, subscriber_listener=self, queue_size=1
        )

    def peer_subscribe(self, *_):
        self.connections += 1
        support.arrived.set()

    def send(self):
        self._shared.publish(ShmImage(encoding="mono8", height=1, width=1, step=1, bytes=1))

    def close(self):
        self._shared.unregister()
        self._raw.unregister()


@pytest.fixture
def camera(start):
    return CameraNode(start, "shm_camera", "_framerate:=30")


def shape(frame):
    return frame.image.shape[1::-1], frame.encoding


def wait_for_shape(frames, size, encoding):
    support.wait_for(
        lambda: frames.received and shape(frames.received[-1]) == (size, encoding),
        f"a frame of {size}, {encoding}",
    )


def my_images():
    return rospy.get_name() + "_images"


def test_a_killed_camera_comes_back_with_another_size_and_encoding(camera):
    frames = Frames(camera.topic)
    for size, encoding in [((80, 64), "bgr8"), ((320, 240), "mono8"), ((96, 72), "rgb8")] * 2:
        camera.begin(*size, encoding)
        wait_for_shape(frames, size, encoding)
        support.wait_for(lambda: uses_shm(my_images(), camera.topic), "frames over shm")
        kept = frames.received[-1].image
        before = kept.copy()
        camera.kill()
        assert np.array_equal(kept, before)  # what was held stays
    stamps = [frame.header.stamp for frame in list(frames.received)]
    assert len(set(stamps)) == len(stamps)  # none came twice


def test_a_publisher_that_was_killed_and_started_again_is_read_within_a_second(start):
    source, topic = Source(new_topic()), new_topic()
    plain, frames = support.Messages(topic, Image), Frames(topic)
    image = message(noise("bgr8"), "bgr8")

    def images_until(condition):
        """Starts the publisher, and kills it when its frames fulfil a condition.

        Returns how many images the plain subscriber has then. None is sent before it has the last.
        """
        process = start(REPUBLISH, "raw", f"in:={source.topic}", f"out:={topic}", "__name:=again")
        source.wait_for()
        before, first = len(plain.received), len(frames.received)

        def sent():
            count = len(plain.received)
            rosgraph.Master("/test").getPid()  # which the reader asks, too
            source.send(image)
            time.sleep(1.0 / RATE)
            if count > before:  # It is connected, so that nothing can be lost.
                plain.wait(count + 1)
            return condition(frames.received[first:])

        support.wait_for(sent, "frames of the publisher")
        process.kill()
        process.exit_code()
        return len(plain.received) - before

    for _ in range(ROUNDS):
        images_until(lambda frames: frames and uses_shm(my_images(), topic))
        assert images_until(bool) <= RATE


def test_killed_readers_cost_the_others_nothing(start, camera):
    camera.begin(320, 240)
    frames = Frames(camera.topic)
    frames.wait()
    for _ in range(ROUNDS):
        reader = Reader(start, camera.topic)
        out = support.Messages(reader.target, Image)
        out.wait(3)
        support.wait_for(lambda one=reader: uses_shm(one.node, camera.topic), "frames over shm")
        reader.process.kill()
        reader.process.exit_code()
        count = len(frames.received)
        frames.wait(count + 10)
    assert support.Diagnostics().value("shm_camera", DROPPED) == "0"


def test_a_publisher_without_shm_takes_the_place_of_one_that_was_killed(camera):
    frames = Frames(camera.topic)
    camera.begin(80, 64)
    support.wait_for(lambda: frames.received and uses_shm(my_images(), camera.topic), "shm")
    camera.kill()  # and the master still knows it
    source = Source(camera.topic)
    image = message(noise("mono8", 10, 20), "mono8")

    def came():
        source.send(image)
        return shape(frames.received[-1]) == ((20, 10), "mono8")

    support.wait_for(came, "frames of the other publisher")


def test_two_publishers_of_which_one_has_no_shm(camera):
    frames = Frames(camera.topic)
    camera.begin(80, 64)
    support.wait_for(lambda: frames.received and uses_shm(my_images(), camera.topic), "shm")
    source = Source(camera.topic)
    image = message(noise("mono8", 10, 20), "mono8")

    def both():
        source.send(image)
        newest = [shape(frame) for frame in frames.received[-20:]]
        return len(set(newest)) == 2 and uses_raw(my_images(), camera.topic)

    support.wait_for(both, "frames of both publishers, over raw")
    source.close()
    support.wait_for(lambda: uses_shm(my_images(), camera.topic), "shm again")


def test_what_one_of_two_cameras_shares_is_tried_again_less_and_less_often(start, camera):
    camera.begin(80, 64)
    reader = Reader(start, camera.topic)
    out = support.Messages(reader.target, Image)
    far = FarCamera(camera.topic)

    def pause():
        """Has the reader, which has read the near camera's frames, find a frame that it cannot."""
        support.wait_for(lambda: uses_shm(reader.node, camera.topic), "frames over shm")
        out.wait(len(out.received) + 3)
        begin, before = time.monotonic(), far.connections
        far.send()
        support.wait_for(lambda: far.connections > before, "the reader again")
        return time.monotonic() - begin

    support.wait_for(lambda: pause() >= 2.0, "a longer pause than the first one of 1 s")
    far.close()


def test_two_cameras_on_one_topic_share_both(start):
    topic = new_topic()
    frames = Frames(topic)
    for name, size in (("one", (80, 64)), ("two", (96, 72))):
        CameraNode(start, name, f"/{name}/image_raw:={topic}", "_framerate:=10").begin(*size)
    support.wait_for(lambda: uses_shm(my_images(), topic), "frames over shm")
    begin = len(frames.received)
    support.wait_for(
        lambda: {shape(frame)[0] for frame in frames.received[begin:]} == {(80, 64), (96, 72)},
        "frames of both cameras",
    )


def test_readers_that_come_and_go(camera):
    camera.begin(80, 64)
    for _ in range(ROUNDS):
        frames = Frames(camera.topic)
        support.wait_for(lambda: uses_shm(my_images(), camera.topic), "frames over shm")
        count = len(frames.received)
        frames.wait(count + 3)
        frames.close()
    support.wait_for(
        lambda: not support.receives(my_images(), camera.topic), "the end of the subscription"
    )
    name = rospy.get_name() + "_images"
    support.wait_for(lambda: name not in subscribers(camera.topic), "the master to be told")


def subscribers(topic):
    """The nodes that the master knows as subscribers of a topic."""
    return dict(rosgraph.Master(rospy.get_name()).getSystemState()[1]).get(topic, [])
