"""robot_vision.transport: all encodings, layouts and kinds of damage, as arrays in Python."""

import gc
import weakref

import cv2
import cv_bridge
import numpy as np
import pytest
import rospy
import support
from frames import ENCODINGS, UNKNOWN, Frames, Source, damaged, message, new_topic, noise
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from robot_vision.transport import ImagePublisher, ImageSubscriber


def by_cv_bridge(image, encoding):
    """A message as converted by cv_bridge, or None if it refuses."""
    try:
        return cv_bridge.CvBridge().imgmsg_to_cv2(image, encoding)
    except cv_bridge.CvBridgeError:
        return None


def assert_same(image, expected):
    assert (image.dtype, image.shape) == (expected.dtype, expected.shape)
    assert np.array_equal(image, expected)


@pytest.fixture
def source(start):
    """A publisher on a new topic; `source.frames(...)` subscribes to it."""

    class Topic(Source):
        def frames(self, *args):
            frames = Frames(self.topic, *args)
            self.wait_for()
            return frames

    return Topic(new_topic())


@pytest.mark.parametrize("padding, order", [(0, "<"), (8, "<"), (0, ">"), (24, ">")])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_the_array_has_the_pixels_of_the_message(source, encoding, padding, order):
    frames = source.frames()
    sent = [noise(encoding), noise(encoding, 1, 2 if "yuv" in encoding else 1)]
    for number, pixels in enumerate(sent, 1):
        source.send(message(pixels, encoding, padding, order))
        frame = frames.wait(number)[-1]
        assert frame.encoding == encoding
        assert_same(frame.image, pixels)
        assert not frame.image.flags.writeable


def test_conversions_are_those_of_cv_bridge(source):
    """All encodings to all others; also with padded rows, which cv_bridge takes for pixels."""
    targets = {target: source.frames(target) for target in ENCODINGS}
    not_in_cv_bridge = set()
    for number, encoding in enumerate(ENCODINGS, 1):
        pixels = noise(encoding)
        before = {target: len(frames.received) for target, frames in targets.items()}
        source.send(message(pixels, encoding, padding=8))
        support.wait_for(
            lambda n=number: all(
                len(f.received) + f.subscriber.refused == n for f in targets.values()
            ),
            encoding + " as all others",
        )
        for target, frames in targets.items():
            came = len(frames.received) > before[target]
            expected = by_cv_bridge(message(pixels, encoding), target)
            if came and expected is None:
                not_in_cv_bridge.add((encoding, target))
            else:
                assert came == (expected is not None), (encoding, target)
            if came and expected is not None:
                assert frames.received[-1].encoding == target
                assert_same(frames.received[-1].image, expected)
    # Newer versions of cv_bridge know yuv422_yuy2, too.
    assert not_in_cv_bridge <= {
        ("yuv422_yuy2", to) for to in ("bgr8", "rgb8", "mono8", "yuv422_yuy2")
    }


@pytest.mark.parametrize("height, width, order", [(1, 1, "<"), (2160, 3840, "<"), (5, 7, ">")])
@pytest.mark.parametrize(
    "encoding, target",
    [
        ("bgr8", "mono8"),
        ("rgba8", "bgr8"),
        ("mono16", "mono8"),
        ("bgr16", "rgb16"),
        ("32FC1", "32FC1"),
    ],
)
def test_conversions_of_any_size_and_byte_order(source, encoding, target, height, width, order):
    pixels = noise(encoding, height, width)
    frames = source.frames(target)
    source.send(message(pixels, encoding, padding=16, order=order))
    expected = by_cv_bridge(message(pixels, encoding), target)  # needs the machine's order
    assert_same(frames.wait()[0].image, expected)


@pytest.mark.parametrize("target, code", [("bgr8", "BGR"), ("rgb8", "RGB"), ("mono8", "GRAY")])
def test_conversions_of_yuyv(source, target, code):
    pixels = noise("yuv422_yuy2")
    frames = source.frames(target)
    source.send(message(pixels, "yuv422_yuy2"))
    expected = cv2.cvtColor(pixels, getattr(cv2, f"COLOR_YUV2{code}_YUY2"))
    assert_same(frames.wait()[0].image, expected)


@pytest.mark.parametrize("encoding, target", [("bgr8", None), ("rgb8", "bgr8"), ("16UC1", "16UC1")])
def test_4k(source, encoding, target):
    pixels = noise(encoding, 2160, 3840)
    frames = source.frames(target)
    source.send(message(pixels, encoding))
    image = frames.wait()[0].image
    assert_same(image, pixels[:, :, ::-1] if target == "bgr8" else pixels)


@pytest.mark.parametrize("encoding", UNKNOWN[1:])
def test_an_unknown_encoding_is_refused_at_once(encoding):
    with pytest.raises(ValueError, match=f"encoding '{encoding}'"):
        ImageSubscriber(new_topic(), print, encoding=encoding)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_damaged_frames_are_refused_and_counted(source, encoding, log):
    as_it_is, converted = source.frames(), source.frames("bgr8" if "C" not in encoding else None)
    both = (as_it_is, converted)
    for number, (fields, bad) in enumerate(damaged(message(noise(encoding), encoding)), 1):
        source.send(bad)
        for frames in both:
            subscriber = frames.subscriber
            support.wait_for(lambda s=subscriber, n=number: s.refused == n, f"refusal: {fields}")
    source.send(message(noise(encoding), encoding))
    for frames in both:
        frames.wait()
        assert (len(frames.received), frames.subscriber.refused) == (1, number)
        assert (frames.subscriber.received, frames.subscriber.dropped) == (number + 1, 0)
    what = f"refused a frame on {source.topic} ({encoding}, 6x4): data has 0 bytes, "
    assert f"{what}step * height is {noise(encoding).nbytes}" in log()


def test_a_view_uses_the_memory_of_the_message(source):
    pixels = noise("bgr8")
    first, second = source.frames(), source.frames()
    source.send(message(pixels, "bgr8", padding=6))
    images = [frames.wait()[0].image for frames in (first, second)]
    # roscpp gives both the same message; copies would have other addresses and packed rows.
    assert images[0].ctypes.data == images[1].ctypes.data
    assert images[0].strides == (6 * 3 + 6, 3, 1)
    for image in images:
        assert not image.flags.owndata
        with pytest.raises(ValueError):
            image[0, 0, 0] = 0
        with pytest.raises(ValueError):
            image.flags.writeable = True


def test_frames_outlive_their_subscriber(source):
    # These are more frames than are kept for reuse.
    sent = [np.roll(noise("bgr8", 480, 640), n, axis=1) for n in range(6)]
    views, converted = source.frames(), source.frames("mono8")
    for number, pixels in enumerate(sent, 1):
        source.send(message(pixels, "bgr8"))
        views.wait(number)
        converted.wait(number)
    grays = [cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY) for pixels in sent]
    kept = [frame.image[::2] for frame in views.received]  # slices keep the memory as well
    kept_grays = [frame.image for frame in converted.received]
    subscribers = [weakref.ref(frames.subscriber) for frames in (views, converted)]
    views.close()
    converted.close()
    del views, converted
    gc.collect()
    support.wait_for(lambda: not any(s() for s in subscribers), "the end of the subscribers")
    source.wait_for(0)
    others = source.frames()
    for number in range(1, 101):
        source.send(message(np.full_like(sent[0], number), "bgr8"))
        others.wait(number)
        others.received[-1] = None  # releases the frame for the next one
    assert all(np.array_equal(a, b[::2]) for a, b in zip(kept, sent))
    assert all(np.array_equal(a, b) for a, b in zip(kept_grays, grays))


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_published_images_arrive_unchanged(source, encoding):
    """They arrive over TCP in rospy and inside the process, whatever the array's memory layout."""
    publisher = ImagePublisher(source.topic)
    inside, outside = Frames(source.topic), support.Messages(source.topic, Image)
    support.wait_for(lambda: publisher.get_num_connections() == 2, "the subscriptions")
    pixels = noise(encoding)
    layouts = [
        pixels,
        np.asfortranarray(pixels),
        np.repeat(pixels, 2, axis=1)[:, ::2],
        pixels[::-1].copy()[::-1],
        np.pad(pixels, [(0, 0), (0, 2), (0, 0)][: pixels.ndim])[:, :-2],
        pixels.astype(pixels.dtype.newbyteorder(">")),
    ]
    header = Header(stamp=rospy.Time(12, 34), frame_id="eye")
    for number, layout in enumerate(layouts, 1):
        sent = layout.copy() if layout is pixels else layout
        publisher.publish(sent, encoding, header)
        if sent is not layout:
            sent[:] = 0  # the publisher has copied it
        frame, came = inside.wait(number)[-1], outside.wait(number)[-1]
        assert_same(frame.image, pixels)
        assert came.data == pixels.tobytes()
        assert (came.step, came.encoding) == (pixels.strides[0], encoding)
        for received in (frame.header, came.header):
            assert (received.stamp, received.frame_id) == (header.stamp, "eye")
    publisher.unregister()


def test_an_invalid_stamp_is_passed_on_unchanged(source):
    """A sender may write any stamp; results have the stamp of their frame."""
    publisher = ImagePublisher(source.topic)
    frames = Frames(source.topic)
    support.wait_for(publisher.get_num_connections, "the subscription")
    header = Header(frame_id="eye")
    header.stamp.secs = header.stamp.nsecs = 2**32 - 1
    publisher.publish(noise("mono8"), "mono8", header)
    stamp = frames.wait()[0].header.stamp
    assert (stamp.secs, stamp.nsecs) == (2**32 - 1, 2**32 - 1)
    publisher.unregister()


@pytest.mark.parametrize(
    "array, encoding, error",
    [
        (np.zeros((4, 6, 3), bool), "bgr8", TypeError),
        (np.zeros((4, 6), np.float16), "32FC1", TypeError),
        (np.zeros((4, 6), np.int64), "32SC1", TypeError),
        (np.zeros((4, 6), object), "mono8", TypeError),
        (np.zeros((4, 6), "V0"), "mono8", TypeError),
        (np.zeros(24, np.uint8), "mono8", ValueError),
        (np.zeros((1, 4, 6, 3), np.uint8), "bgr8", ValueError),
        (np.zeros((4, 6), np.uint8), "bgr8", ValueError),
        (np.zeros((4, 6, 3), np.uint16), "bgr8", ValueError),
        (np.zeros((0, 6, 3), np.uint8), "bgr8", ValueError),
        (np.zeros((4, 0), np.uint8), "mono8", ValueError),
        (np.zeros((4, 6, 0), np.uint8), "mono8", ValueError),
        (np.zeros((4, 6, 513), np.uint8), "mono8", ValueError),
        (np.zeros((4, 5, 2), np.uint8), "yuv422", ValueError),
        *((np.zeros((4, 6, 3), np.uint8), name, ValueError) for name in UNKNOWN),
    ],
)
def test_invalid_arrays_are_not_published(array, encoding, error):
    publisher = ImagePublisher(new_topic())
    with pytest.raises(error):
        publisher.publish(array, encoding)
    publisher.unregister()
