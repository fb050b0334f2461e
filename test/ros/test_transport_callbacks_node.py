"""robot_vision.transport: which callbacks run when and with which frame; the statistics."""

import io
import itertools
import threading

import numpy as np
import pytest
import rospy
import support
from frames import Frames, Source, message, new_topic
from loaded_contexts import ImageTaker
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from robot_vision.transport import CameraSubscriber, ImagePublisher, ImageSubscriber

IMAGE = np.arange(4 * 6 * 3, dtype=np.uint8).reshape(4, 6, 3)


@pytest.fixture
def source(start):
    return Source(new_topic())


def numbered(number):
    """An image whose frame_id and pixels are a number."""
    image = message(np.full_like(IMAGE, number % 256), "bgr8")
    image.header.frame_id = str(number)
    return image


def number_of(frame):
    number = int(frame.header.frame_id)
    assert (frame.image == number % 256).all()
    return number


def test_after_a_slow_callback_the_newest_frame_is_next(start):
    """Inside a process frames are handed over at once, so the result is deterministic."""
    topic = new_topic()
    publisher = ImagePublisher(topic)
    go_on = threading.Event()
    numbers = []

    def work(frame):
        numbers.append(number_of(frame))
        assert go_on.wait(support.DEADLINE)

    images = ImageSubscriber(topic, work)
    support.wait_for(publisher.get_num_connections, "the subscription")
    for number in range(1, 21):
        publisher.publish(
            np.full_like(IMAGE, number), header=Header(seq=number, frame_id=str(number))
        )
        support.wait_for(lambda: numbers, "the first frame")
    go_on.set()
    support.wait_for(lambda: len(numbers) > 1, "the frame after it")
    assert numbers == [1, 20]
    assert (images.received, images.dropped, images.failed) == (2, 18, 0)
    images.unregister()
    publisher.unregister()


def test_after_a_slow_callback_of_another_topic_the_newest_frame_is_next(start):
    """Two images wait. While the first is processed, a newer one than the second comes."""
    blocking, slow, other = (ImagePublisher(new_topic()) for _ in range(3))
    begun, go_on = threading.Event(), threading.Event()
    numbers = []

    def publish(publisher, number):
        publisher.publish(IMAGE, header=Header(seq=number, frame_id=str(number)))

    def block(_frame):
        begun.set()
        assert go_on.wait(support.DEADLINE)

    subscribers = [  # they are called in this order
        ImageSubscriber(blocking.topic, block),
        ImageSubscriber(slow.topic, lambda _: publish(other, 2)),
        ImageSubscriber(other.topic, lambda frame: numbers.append(frame.header.frame_id)),
    ]
    for publisher in (blocking, slow, other):
        support.wait_for(publisher.get_num_connections, "the subscription")
    publish(blocking, 1)
    assert begun.wait(support.DEADLINE)
    publish(slow, 1)
    publish(other, 1)
    go_on.set()
    support.wait_for(lambda: numbers, "a frame")
    assert numbers == ["2"]
    for one in (*subscribers, blocking, slow, other):
        one.unregister()


def test_a_slow_callback_on_a_fast_topic_gets_the_newest_frames(source):
    """Over TCP, frames arrive while one is processed; the next one must be the newest."""
    burst, bursts = 6, 30
    published = 0
    turns = threading.Semaphore(0)
    numbers, behind = [], []

    def work(frame):
        number = number_of(frame)
        behind.append(published - number)  # before the next burst, which waits for the number
        numbers.append(number)
        assert turns.acquire(timeout=support.DEADLINE)

    images = ImageSubscriber(source.topic, work)
    # Shows that they have arrived: all who take images in a process get them at once.
    arrived = ImageTaker("/arrived", source.topic)
    source.wait_for()
    published += 1
    source.send(numbered(published))
    support.wait_for(
        lambda: numbers and arrived.received, "the first frame"
    )  # which has its turn with the first burst
    for _ in range(bursts):
        for _ in range(burst):
            published += 1
            source.send(numbered(published))
        support.wait_for(lambda n=published: number_of(arrived.received[-1]) == n, "the last")
        worked = len(numbers)
        turns.release()
        support.wait_for(lambda n=worked: len(numbers) > n, "the next frame")
    while numbers[-1] < published:
        worked = len(numbers)
        turns.release()
        support.wait_for(lambda n=worked: len(numbers) > n, "the last frame")
    assert numbers == sorted(set(numbers))
    assert images.received + images.dropped == published - numbers[0] + 1
    assert images.dropped > published // 2
    assert set(behind) == {0}
    turns.release()
    images.unregister()


@pytest.mark.parametrize(
    "error, told",
    [
        (
            KeyError("what is wrong"),
            ["/image: the callback failed:", "in work", "KeyError: 'what is wrong'"],
        ),
        (ValueError("\udcff"), []),  # no encoding has its text
    ],
    ids=["text", "no text"],
)
def test_a_callback_that_raises_is_logged_and_counted(source, log, error, told):
    numbers = []

    def work(frame):
        numbers.append(number_of(frame))
        if len(numbers) < 3:
            raise error

    images = ImageSubscriber(source.topic, work)
    source.wait_for()
    for number in range(1, 5):
        source.send(numbered(number))
        support.wait_for(lambda n=number: len(numbers) == n, f"frame {number}")
    support.wait_for(lambda: images.failed == 2, "the count")
    assert (images.received, images.refused, images.failed) == (4, 2, 2)
    support.wait_for(lambda: all(text in log() for text in told), "the error in the log")
    images.unregister()


class Garbled(Image):
    """A message whose frame_id is not UTF-8, as C++ nodes may send it."""

    def serialize(self, buff):
        inner = io.BytesIO()
        super().serialize(inner)
        buff.write(inner.getvalue().replace(b"garbled", b"gar\xffled"))


def test_a_frame_id_that_is_not_utf8(source):
    frames = Frames(source.topic)
    source.wait_for()
    image = message(IMAGE, "bgr8")
    image.header.frame_id = "garbled"
    source.send(Garbled(*(getattr(image, slot) for slot in Image.__slots__)))
    assert frames.wait()[0].header.frame_id == "gar\ufffdled"
    source.send(numbered(7))
    assert number_of(frames.wait(2)[1]) == 7


def test_a_given_transport_is_used(source):
    rospy.set_param("~image_transport", "semaphore")
    try:
        with pytest.raises(ValueError, match="image_transport is 'semaphore'"):
            ImageSubscriber(source.topic, print)
        images = ImageSubscriber(source.topic, print, transport="raw")
        source.wait_for()
        images.unregister()
        rospy.set_param("~image_transport", 3)
        with pytest.raises(ValueError, match="image_transport is 3, must be a string"):
            ImageSubscriber(source.topic, print)
    finally:
        rospy.delete_param("~image_transport")


def test_unregister_inside_the_callback(source):
    numbers = []

    def work(frame):
        numbers.append(number_of(frame))
        images.unregister()

    images = ImageSubscriber(source.topic, work)
    others = Frames(source.topic)
    source.wait_for()
    for number in range(1, 6):
        source.send(numbered(number))
        others.wait(number)
        support.wait_for(lambda: numbers, "the first frame")
    assert numbers == [1]
    assert images.get_num_connections() == 0
    images.start()  # subscribes again
    support.wait_for(images.get_num_connections, "the connection")
    source.send(numbered(6))
    support.wait_for(lambda: len(numbers) == 2, "a frame")
    assert numbers == [1, 6]


def test_subscribing_inside_a_callback(source):
    inner = []

    def work(frame):
        if not inner:
            inner.append(Frames(source.topic))
            inner.append(Frames(source.topic + "_other"))

    outer = ImageSubscriber(source.topic, work)
    source.wait_for()
    other = Source(source.topic + "_other")
    source.send(numbered(1))
    other.wait_for()
    source.send(numbered(2))
    other.send(numbered(3))
    assert number_of(inner[0].wait()[0]) == 2
    assert number_of(inner[1].wait()[0]) == 3
    outer.unregister()


def test_a_subscriber_may_end_another(source):
    ended = Frames(source.topic)
    other = ImageSubscriber(source.topic, lambda _: ended.subscriber.unregister())
    source.wait_for()
    for number in range(1, 5):
        source.send(numbered(number))
    support.wait_for(lambda: ended.subscriber.get_num_connections() == 0, "the end")
    assert len(ended.received) <= 1
    other.unregister()


def test_several_subscribers_of_a_topic_and_a_plain_one_of_rospy(source):
    color, gray = Frames(source.topic, "rgb8"), Frames(source.topic, "mono8")
    plain = support.Messages(source.topic, Image)
    source.wait_for(2)
    for number in range(1, 4):
        source.send(message(IMAGE, "bgr8"))
        assert np.array_equal(color.wait(number)[-1].image, IMAGE[:, :, ::-1])
        assert gray.wait(number)[-1].image.shape == (4, 6)
        assert plain.wait(number)[-1].data == IMAGE.tobytes()
    headers = [m.header for m in (color.received[-1], gray.received[-1], plain.received[-1])]
    assert headers[0] == headers[1] == headers[2]


def test_the_header_is_complete(source):
    frames = Frames(source.topic)
    source.wait_for()
    for number, (stamp, name) in enumerate(
        itertools.product([rospy.Time(), rospy.Time(2**32 - 1, 999999999)], ["", "käme/rä" * 99]), 1
    ):
        image = message(IMAGE, "bgr8")
        image.header = Header(stamp=stamp, frame_id=name)
        source.send(image)
        header = frames.wait(number)[-1].header
        assert (header.seq, header.stamp, header.frame_id) == (number, stamp, name)
        assert isinstance(header.stamp, rospy.Time)


def info_of(number):
    """A camera_info all of whose numbers name the image to which it belongs."""
    info = CameraInfo(width=6, height=4, distortion_model="plumb_bob")
    info.header = Header(stamp=rospy.Time(number), frame_id=str(number))
    info.K = [float(number + i) for i in range(9)]
    info.D = [0.1 * number] * 5
    info.P = [float(number + i) for i in range(12)]
    info.R = np.eye(3).flatten().tolist()
    return info


@pytest.fixture
def camera(source):
    """send_image(n), send_info(n), and the frames of a CameraSubscriber."""

    class Camera:
        frames = Frames(source.topic, kind=CameraSubscriber)
        images = Frames(source.topic)  # gets each image after the CameraSubscriber
        info_topic = source.topic.replace("/image", "/camera_info")
        infos = Source(info_topic, CameraInfo)

        @classmethod
        def send_image(cls, number):
            image = numbered(number)
            image.header.stamp = rospy.Time(number)
            before = len(cls.images.received)
            source.send(image)
            cls.images.wait(before + 1)  # of a burst only the newest would arrive

        @classmethod
        def send_info(cls, number):
            cls.infos.send(info_of(number))

        @classmethod
        def expect(cls, *numbers):
            """Waits for these images, each of which must have its own camera_info."""
            frames = cls.frames.wait(len(numbers))
            assert tuple(map(number_of, cls.frames.received)) == numbers
            for number, frame in zip(numbers, frames):
                assert frame.header.stamp == frame.camera_info.header.stamp == rospy.Time(number)
                expected = info_of(number)
                expected.header.seq = frame.camera_info.header.seq
                assert list(frame.camera_info.K) == expected.K
                assert repr(frame.camera_info) == repr(expected)

    source.wait_for()
    Camera.infos.wait_for()
    return Camera


@pytest.mark.parametrize("ahead", [0, 1, 3, 9])
def test_camera_info_that_comes_first(camera, ahead):
    for number in range(1, ahead + 1):
        camera.send_info(number)
    for number in range(1, 21):
        camera.send_info(number + ahead)
        camera.send_image(number)
        camera.expect(*range(1, number + 1))


@pytest.mark.parametrize("behind", [0, 1, 3, 9])
def test_camera_info_that_comes_later(camera, behind):
    for number in range(1, 21):
        camera.send_image(number)
        if number > behind:
            camera.send_info(number - behind)
            camera.expect(*range(1, number - behind + 1))


def test_images_without_camera_info_of_their_stamp(camera, log):
    numbers = itertools.count(2, 2)

    topics = camera.frames.subscriber.topic, camera.info_topic
    warning = "images of {} without a camera_info of the same stamp on {}".format(*topics)

    def warned():
        number = next(numbers)
        camera.send_image(number)
        camera.send_info(number + 1)
        return warning in log()

    support.wait_for(warned, "the warning")
    camera.send_image(1)
    camera.send_info(1)
    camera.expect(1)


def test_a_stamp_that_comes_again_has_the_newest_camera_info(camera):
    """This happens when a bag is played in a loop."""
    for again in range(1, 4):
        for number in range(1, 4):
            camera.send_info(number)
            camera.send_image(number)
            frames = camera.frames.wait((again - 1) * 3 + number)
            assert frames[-1].camera_info.header.stamp == rospy.Time(number)


def test_connections_are_reported(start):
    topic = new_topic()
    counts = []
    publisher = ImagePublisher(topic, lambda: counts.append(publisher.get_num_connections()))
    messages = support.Messages(topic, Image)
    support.wait_for(lambda: counts and counts[-1] == 1, "the first subscriber")
    messages.close()
    support.wait_for(lambda: counts[-1] == 0, "its end")
    publisher.unregister()


def test_a_connection_callback_that_raises(start, source, log):
    publisher = ImagePublisher(new_topic(), lambda: 1 / 0)
    messages = support.Messages(publisher.topic, Image)
    support.wait_for(lambda: "ZeroDivisionError" in log(), "the traceback in the log")
    frames = Frames(source.topic)
    source.wait_for()
    source.send(numbered(1))
    frames.wait()
    publisher.publish(IMAGE)
    assert messages.wait()[0].data == IMAGE.tobytes()
    publisher.unregister()
