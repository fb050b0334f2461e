"""The transport shm between processes: the images are those of raw, field by field."""

import copy
import functools
import itertools

import numpy as np
import pytest
import rospy
import support
from frames import ENCODINGS, Frames, Source, damaged, message, new_topic, noise
from sensor_msgs.msg import Image
from shared_images import Reader, share, shared_files, uses_raw, uses_shm
from std_msgs.msg import Header

from robot_vision.msg import ShmImage
from robot_vision.transport import ImageSubscriber

STEPS = (0, 1, 2, 7)  # bytes behind each row, as far as pixels of several bytes allow it


def everything(width=7):
    """Images of every encoding, with rows of odd lengths, in both byte orders."""
    for encoding, (dtype, _) in ENCODINGS.items():
        size = np.dtype(dtype).itemsize
        for padding in {step * size for step in STEPS}:
            for order in "<>" if size > 1 else "<":
                yield message(noise(encoding, 6, width), encoding, padding, order)


def fields(image):
    """All of an Image but its header's sequence number, which rospy gives."""
    own = [name for name in image.__slots__ if name != "header"]
    return {name: getattr(image, name) for name in own}, image.header.stamp, image.header.frame_id


@pytest.fixture
def shared(start):
    """A source of images, the topic on which another process shares them, and that process."""
    source, topic = Source(new_topic()), new_topic()
    process = share(start, source.topic, topic)
    source.wait_for()
    return source, topic, process


def send_until(source, image, condition, what):
    """Sends an image again and again: a change of transports needs one."""

    def sent():
        source.send(image)
        return condition()

    support.wait_for(sent, what)


def stamped(image, number):
    image.header = Header(stamp=rospy.Time(number, 5), frame_id=f"eye {number}")
    return image


def test_images_are_those_of_raw(start, shared):
    source, topic, _ = shared
    reader = Reader(start, topic)
    out, raw = support.Messages(reader.target, Image), support.Messages(topic, Image)
    support.wait_for(out.connected, "the reader")
    first = stamped(message(noise("bgr8"), "bgr8"), 1)
    send_until(source, first, lambda: uses_shm(reader.node, topic), "frames over shm")
    images = [image for _, image in damaged(message(noise("mono16"), "mono16"))]
    for number, image in enumerate([*everything(), *images], 2):
        source.send(stamped(image, number))
        assert fields(out.of(image.header.stamp)) == fields(image)
        assert fields(raw.of(image.header.stamp)) == fields(image)
    last = stamped(images[-1], number + 1)
    send_until(source, last, lambda: uses_shm(reader.node, topic), "frames over shm at last")


def test_python_s_frames_are_those_of_raw(shared):
    source, topic, _ = shared
    frames = {
        name: Frames(topic, kind=functools.partial(ImageSubscriber, transport=name))
        for name in ("raw", "shm", "auto")
    }
    first = stamped(message(noise("bgr8"), "bgr8"), 1)
    send_until(
        source, first, lambda: all(one.received for one in frames.values()), "the first frames"
    )
    node = rospy.get_name() + "_images"
    offsets = set()
    for number, image in enumerate(everything(width=8), 2):  # of odd width is no yuv422
        source.send(stamped(image, number))

        def of(name, stamp=image.header.stamp):
            return [frame for frame in frames[name].received if frame.header.stamp == stamp]

        support.wait_for(lambda got=of: all(map(got, frames)), "the frame over each transport")
        # Publishers count the frames of each way, but a gap would stand for a frame that was lost.
        offsets.add(tuple(of(name)[0].header.seq - number for name in frames))
        raw = of("raw")[0]
        for name in ("shm", "auto"):
            (frame,) = of(name)  # once
            assert np.array_equal(frame.image, raw.image, equal_nan="C" not in frame.encoding)
            assert frame.image.dtype == raw.image.dtype
            assert (frame.encoding, frame.header.frame_id) == (raw.encoding, raw.header.frame_id)
            assert not frame.image.flags.writeable
    assert len(offsets) == 1, offsets
    assert support.receives_over(node, topic + "/shm")


def test_the_default_takes_shm_and_stays_with_raw_where_there_is_none(start, shared):
    source, topic, _ = shared
    for name, image in (("shared", topic), ("alone", source.topic)):
        start("edge_detector_node", f"__name:={name}", f"image:={image}", "_always_subscribe:=true")
    support.wait_for(lambda: uses_raw("/alone", source.topic), "the raw images alone")
    image = stamped(message(noise("bgr8"), "bgr8"), 1)
    send_until(source, image, lambda: uses_shm("/shared", topic), "frames over shm")
    assert uses_raw("/alone", source.topic)


def test_python_nodes_take_shm(start, shared):
    source, topic, _ = shared
    start("motion_detector.py", "__name:=python", f"image:={topic}", "_always_subscribe:=true")
    image = stamped(message(noise("bgr8"), "bgr8"), 1)
    send_until(source, image, lambda: uses_shm("/python_images", topic), "frames over shm")


def test_nothing_is_shared_while_nobody_reads_over_shm(start, shared):
    source, topic, process = shared
    raw = support.subscribed(topic, Image)
    source.send(stamped(message(noise("bgr8"), "bgr8"), 1))
    raw.wait()
    assert shared_files(process) == 0
    reader = Reader(start, topic)
    image = stamped(message(noise("bgr8"), "bgr8"), 1)
    send_until(source, image, lambda: shared_files(process) > 0, "shared memory")
    reader.process.kill()
    support.wait_for(lambda: shared_files(process) == 0, "the end of shared memory")


HUGE = 2**64 - 1
STAMP_OF_LIES = 6  # ns
HOSTILE = [
    {"bytes": HUGE},
    {"bytes": 2**40, "height": 2**20, "step": 2**20},
    {"bytes": 0},
    {"height": 2**32 - 1},
    {"width": 2**32 - 1},
    {"step": 0},
    {"slot": 2**32 - 1},
    {"generation": HUGE},
    {"generation": 0},
    {"memory": HUGE},
    {"publisher": 1},
    {"socket": ""},
    {"socket": "robot_vision_of_nobody"},
    {"socket": 300 * "x"},
    {"socket": "a\0b"},
    {"boot_id": "elsewhere"},
    {"boot_id": 5000 * "y"},
    {"encoding": "\x1b[31mred"},
    {"encoding": ""},
]


def test_a_hostile_publisher_harms_no_reader(start, shared):
    """Messages that lie about the memory: none gives other pixels, and the true ones go on."""
    source, topic, _ = shared
    told = support.subscribed(topic + "/shm", ShmImage)
    raw = Source(new_topic())  # who offers shm offers raw, too
    hostile = Source(raw.topic + "/shm", ShmImage)
    reader = Reader(start, raw.topic)
    out = support.subscribed(reader.target, Image)
    hostile.wait_for()
    numbers = itertools.count(1)
    sent = {}

    def pixels_of(number):
        return (noise("bgr8", 48, 64).astype(int) + number).astype(np.uint8)

    def shared_image():
        """What is told of the memory of a new image, which is among those sent."""
        number = next(numbers)
        image = stamped(message(pixels_of(number), "bgr8"), number)
        sent[image.header.stamp] = image
        source.send(image)
        return told.of(image.header.stamp)

    def shown():
        """Whether a true message has arrived, of which another one is sent."""
        hostile.send(shared_image())
        return any(support.stamp_of(one) in sent for one in list(out.received))

    support.wait_for(shown, "an image over shm")
    for lies in HOSTILE:
        sent.clear()
        lie = copy.deepcopy(shared_image())
        lie.header.stamp.nsecs += 1
        for name, value in lies.items():
            setattr(lie, name, value)
        # Once: each lie at which the memory cannot be read doubles the pause before the next look.
        hostile.send(lie)
        support.wait_for(shown, f"an image behind {lies}")
        for one in list(out.received):
            stamp = support.stamp_of(one)
            if stamp in sent:
                assert fields(one) == fields(sent[stamp]), lies
            elif stamp.nsecs == STAMP_OF_LIES:  # what it said of itself, and no pixels of others
                own = message(pixels_of(stamp.secs), "bgr8").data
                assert one.data in (b"", own), lies
        del out.received[:]
    assert reader.process.running()
