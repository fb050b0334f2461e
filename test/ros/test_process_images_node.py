"""Several nodes of a process: each frame is received and converted once; none waits for another."""

import threading
import time

import cv2
import numpy as np
import pytest
import rospy
import support
from diagnostic_msgs.msg import DiagnosticArray
from frames import Source, message, new_topic, noise
from loaded_contexts import ImageTaker
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header, String

from robot_vision.ros.context import LoadedContext, active, current
from robot_vision.ros.image_node import ImageNode
from robot_vision.ros.node_images import node_images
from robot_vision.ros.transport import KEPT, node_diagnostics
from robot_vision.transport import FrameError, ImagePublisher

IMAGE = noise("bgr8", 48, 64)


@pytest.fixture
def source():
    return Source(new_topic())


def addresses(takers, number):
    """The addresses of the pixels that the takers have of their frame of this number."""
    return {taker.received[number].image.ctypes.data for taker in takers}


def test_a_frame_is_received_and_converted_once_for_all_nodes(source):
    """All frames are kept, so that no memory is used twice."""
    kinds = ["mono8", "mono8", "rgb8", "rgb8", "bgr8", None]
    takers = [ImageTaker(f"/n{i}", source.topic, kind) for i, kind in enumerate(kinds)]
    source.wait_for(1)  # not one for each
    frames = 20
    for number in range(frames):
        source.send(message(np.roll(IMAGE, number), "bgr8", padding=8))
        for taker in takers:
            taker.wait(number + 1)
    expected = [np.roll(IMAGE, number) for number in range(frames)]
    gray, rgb, same = takers[:2], takers[2:4], takers[4:]
    for group in (gray, rgb, same):
        distinct = {address for number in range(frames) for address in addresses(group, number)}
        assert len(distinct) == frames
        assert all(len(addresses(group, number)) == 1 for number in range(frames))
    for number in range(frames):
        assert np.array_equal(rgb[0].received[number].image, expected[number][:, :, ::-1])
        assert np.array_equal(same[0].received[number].image, expected[number])
        converted = cv2.cvtColor(expected[number], cv2.COLOR_BGR2GRAY)
        assert np.array_equal(gray[0].received[number].image, converted)
    for taker in takers:
        image = taker.received[0].image
        with pytest.raises(ValueError):
            image[:] = 0
        with pytest.raises(ValueError):
            image.flags.writeable = True
    assert source._publisher.get_num_connections() == 1


def test_a_compressed_frame_is_decoded_once(start):
    topic = new_topic()
    sender = Source(topic + "/compressed", CompressedImage)
    takers = [ImageTaker(f"/n{i}", topic, transport="compressed") for i in range(3)]
    sender.wait_for(1)
    png = cv2.imencode(".png", IMAGE)[1].tobytes()
    for number in range(5):
        sender.send(CompressedImage(format="bgr8; png compressed bgr8", data=png))
        for taker in takers:
            taker.wait(number + 1)
        assert len(addresses(takers, number)) == 1
        assert np.array_equal(takers[0].received[number].image, IMAGE)


def test_each_node_has_a_thread_which_works_in_its_context(source):
    takers = [ImageTaker(f"/n{i}", source.topic) for i in range(3)]
    source.wait_for()
    for number in range(1, 4):
        source.send(message(IMAGE, "bgr8"))
        for taker in takers:
            taker.wait(number)
    assert [set(taker.names) for taker in takers] == [{"/n0"}, {"/n1"}, {"/n2"}]
    assert all(len(set(taker.threads)) == 1 for taker in takers)
    assert len({taker.threads[0] for taker in takers}) == 3


def test_a_slow_node_holds_up_no_other_and_drops_are_its_own(source):
    go_on = threading.Event()
    slow = ImageTaker("/slow", source.topic, "mono8", work=lambda _: go_on.wait(support.DEADLINE))
    quick = ImageTaker("/quick", source.topic, "mono8")
    source.wait_for()
    for number in range(1, 21):
        source.send(message(np.full_like(IMAGE, number), "bgr8"))
        quick.wait(number)
        support.wait_for(lambda: slow.threads, "the slow one's work on the first frame")
    assert not slow.received
    go_on.set()
    slow.wait(2)
    assert [frame.image[0, 0] for frame in slow.received] == [1, 20]
    assert (slow.images.received, slow.images.dropped) == (2, 18)
    assert (quick.images.received, quick.images.dropped) == (20, 0)


def working(name, topic, callback):
    """A node that works, and gets the messages of a topic; its context."""
    context = LoadedContext(name, {"/image": new_topic()}, print)
    with active(context):
        node = ImageNode(lambda _: None)
        node.subscriber(topic, String, callback)
        node.keep_working(True)
        node.start()
    return context


def test_a_node_that_works_on_a_message_holds_up_no_other():
    """rospy calls those that listen to a topic one after the other."""
    publisher = rospy.Publisher(new_topic(), String, queue_size=10, latch=True)
    publisher.publish("1")
    begun, go_on, slow, quick = [], threading.Event(), [], []

    def work(words):
        begun.append(current().name)
        assert go_on.wait(support.DEADLINE)
        slow.append(words.data)

    contexts = [working("/slow", publisher.resolved_name, work)]
    support.wait_for(lambda: begun, "the slow one's work on the first message")
    contexts.append(working("/quick", publisher.resolved_name, quick.append))
    support.wait_for(lambda: quick, "the first message")
    for number in range(2, 5):
        publisher.publish(str(number))
        support.wait_for(lambda count=number: len(quick) == count, "the next message")
    go_on.set()
    support.wait_for(lambda: len(slow) == 2, "the newest message")
    assert [words.data for words in quick] == ["1", "2", "3", "4"]
    assert (slow, begun) == (["1", "4"], ["/slow"] * 2)
    for context in contexts:
        context.end()
    publisher.unregister()


def test_the_newest_message_of_each_sender_is_taken():
    context = LoadedContext("/taker", {}, print)
    with active(context):
        images = node_images()
    taken, go_on, connections = [], threading.Event(), [{}, {}]

    def take(words):
        taken.append(words.data)
        assert go_on.wait(support.DEADLINE)

    def say(text, sender):
        words = String(text)
        words._connection_header = connections[sender]
        images.note(take, words)

    say("the first", 0)
    support.wait_for(lambda: taken, "the work on the first")
    for text, sender in (("an old one", 0), ("another's", 1), ("the newest", 0)):
        say(text, sender)
    go_on.set()
    support.wait_for(lambda: len(taken) == 3, "both")
    assert taken == ["the first", "the newest", "another's"]
    context.end()


def test_a_node_that_works_on_a_frame_is_not_silent(source, diagnostics):
    rospy.set_param("/busy", {"diagnostic_period": 0.05, "always_subscribe": True})
    context = LoadedContext("/busy", {"/image": source.topic}, print)
    begun, go_on = threading.Event(), threading.Event()
    with active(context):
        ImageNode(lambda _: (begun.set(), go_on.wait(support.DEADLINE))).start()
    source.wait_for()
    source.send(message(IMAGE, "bgr8"))
    assert begun.wait(support.DEADLINE)
    running, silent = f"running on {source.topic}", f"no frames on {source.topic}"
    support.wait_for(lambda: diagnostics.next("busy").message == running, "the frame")
    assert [diagnostics.next("busy").message for _ in range(3)] == [running] * 3
    go_on.set()
    support.wait_for(lambda: diagnostics.next("busy").message == silent, "silence")
    context.end()
    rospy.delete_param("/busy")


def test_images_are_numbered_on_their_topic():
    """So gaps in the numbers of those that they were made from are no gaps of theirs."""
    taker = ImageTaker("/taker", new_topic())
    publisher = ImagePublisher(taker.images.topic)
    support.wait_for(publisher.get_num_connections, "the subscription")
    for count, seq in enumerate((1, 4, 7), 1):
        publisher.publish(IMAGE, "bgr8", Header(seq=seq))
        taker.wait(count)
    assert [frame.header.seq for frame in taker.received] == [1, 2, 3]
    assert taker.images.dropped == 0
    publisher.unregister()


def test_a_callback_that_fails_is_the_error_of_its_node_alone(source, log):
    bad = ImageTaker("/bad", source.topic, work=lambda _: 1 / 0)
    good = ImageTaker("/good", source.topic)
    source.wait_for()
    for number in range(1, 4):
        source.send(message(IMAGE, "bgr8"))
        good.wait(number)
        support.wait_for(lambda n=number: bad.images.failed == n, "the failure")
    assert (good.images.failed, good.images.refused, bad.images.refused) == (0, 0, 3)
    assert "ZeroDivisionError" in log()


def test_a_node_that_cannot_subscribe_says_so_and_tries_again(diagnostics):
    topic = new_topic()
    other = ImageTaker("/other", topic, transport="compressed")
    settings = {"diagnostic_period": 0.1, "always_subscribe": True, "image_transport": "raw"}
    rospy.set_param("/refused", settings)
    context = LoadedContext("/refused", {"/image": topic + "/compressed"}, print)
    taken = []
    with active(context):
        ImageNode(taken.append).start()

    def refused():
        status = diagnostics.next("refused")
        return status.message.startswith("cannot subscribe: ") and status.level == status.ERROR

    support.wait_for(refused, "the error")
    other.close()
    source = Source(topic + "/compressed")
    source.wait_for()
    source.send(message(IMAGE, "bgr8"))
    support.wait_for(lambda: taken, "the frame")
    on_topic = f" on {source.topic}"  # running, or without frames
    support.wait_for(lambda: diagnostics.next("refused").message.endswith(on_topic), on_topic)
    context.end()
    rospy.delete_param("/refused")


def test_a_node_that_cannot_subscribe_to_other_images_says_so_and_tries_again(diagnostics):
    first, second = Source(new_topic()), new_topic() + "/compressed"
    other = ImageTaker("/other", second[: -len("/compressed")], transport="compressed")
    rospy.set_param("/refused", {"diagnostic_period": 0.1, "always_subscribe": True})
    context = LoadedContext("/refused", {"/image": first.topic, "/depth": second}, print)
    taken, words = [], []
    with active(context):
        node = ImageNode(lambda _: None)
        node.subscriber("/words", String, words.append)
        node.image_subscriber("depth", taken.append, "raw")
        node.start()

    def refused():
        status = diagnostics.next("refused")
        return status.message.startswith(f"cannot subscribe: {second}: ") and status.level == 2

    support.wait_for(refused, "the error")
    speaker = rospy.Publisher("/words", String, queue_size=1, latch=True)
    speaker.publish("all else is there")
    support.wait_for(lambda: words, "another input")
    speaker.unregister()
    other.close()
    source = Source(second)
    source.wait_for()
    source.send(message(IMAGE, "bgr8"))
    support.wait_for(lambda: taken, "the frame")
    on_topic = f" on {first.topic}"  # without frames
    support.wait_for(lambda: diagnostics.next("refused").message.endswith(on_topic), on_topic)
    context.end()
    rospy.delete_param("/refused")


def test_a_frame_that_is_kept_counts_when_the_work_on_it_is_done(diagnostics):
    """Its result may need what comes later, from another topic."""
    source = Source(new_topic())
    rospy.set_param("/keeps", {"diagnostic_period": 0.1, "always_subscribe": True})
    context = LoadedContext("/keeps", {"/image": source.topic}, print)
    frames = []
    with active(context):
        node = ImageNode(lambda frame: frames.append(frame) or KEPT)
        node.start()
    source.wait_for()

    def counts():
        status = diagnostics.next("keeps")
        return {one.key: one.value for one in status.values}

    def fail():
        raise FrameError("too dark")

    for number in range(2):
        image = message(IMAGE, "bgr8")
        image.header.stamp = rospy.Time.now()
        source.send(image)
        support.wait_for(lambda count=number + 1: len(frames) == count, "the frame")
    support.wait_for(lambda: counts()["frames received"] == "2", "the count of frames")
    assert counts()["frames published"] == "0"
    every = support.subscribed("/diagnostics", DiagnosticArray)
    node.go_on(frames[0], lambda: time.sleep(0.05))

    def with_a_rate():
        """The values of the one status that has a rate: that of the period of the result."""
        statuses = (one for array in list(every.received) for one in array.status)
        own = (one for one in statuses if one.name == "keeps: frames" and one.values)
        values = ({pair.key: pair.value for pair in one.values} for one in own)
        return next((one for one in values if float(one["output rate (Hz)"]) > 0.0), None)

    result = support.wait_for(with_a_rate, "the result")
    every.close()
    assert result["frames published"] == "1"
    assert float(result["processing time (ms)"]) >= 50.0
    assert float(result["output age (ms)"]) >= 50.0
    node.go_on(frames[1], fail)
    support.wait_for(lambda: counts()["frames refused"] == "1", "the refusal")
    assert "too dark" in counts()["last error"]
    assert counts()["frames published"] == "1"
    context.end()
    rospy.delete_param("/keeps")


def leave(_frame):
    raise SystemExit(3)


def test_a_callback_that_exits_ends_its_node_alone(source):
    leaver, stayer = ImageTaker("/leaver", source.topic, work=leave), ImageTaker("/s", source.topic)
    source.wait_for()
    source.send(message(IMAGE, "bgr8"))
    support.wait_for(lambda: leaver.exits, "the wish to end")
    stayer.wait()
    leaver.close()
    source.send(message(IMAGE, "bgr8"))
    stayer.wait(2)
    assert not rospy.is_shutdown() and not stayer.exits


def test_a_node_that_comes_late_gets_what_is_latched_and_no_frame_twice():
    latched = rospy.Publisher(new_topic(), Image, queue_size=5, latch=True)
    latched.publish(message(IMAGE, "bgr8"))
    first = ImageTaker("/first", latched.resolved_name)
    first.wait()
    late = ImageTaker("/late", latched.resolved_name)
    assert np.array_equal(late.wait()[0].image, IMAGE)
    for number in range(1, 6):
        latched.publish(message(np.full_like(IMAGE, number), "bgr8"))
        first.wait(number + 1)
        late.wait(number + 1)
    assert [len(one.received) for one in (first, late)] == [6, 6]
    assert len(addresses([first, late], 5)) == 1  # from then on they share frames
    latched.unregister()


def test_a_node_that_comes_late_gets_no_old_frame_that_is_not_latched(source):
    first = ImageTaker("/first", source.topic)
    source.wait_for()
    source.send(message(np.full_like(IMAGE, 1), "bgr8"))
    first.wait()
    late = ImageTaker("/late", source.topic)
    source.send(message(np.full_like(IMAGE, 2), "bgr8"))
    assert late.wait()[0].image[0, 0, 0] == 2


@pytest.mark.parametrize("kind", ["mono8", None])
def test_a_node_that_ends_in_its_callback_ends_alone(source, kind):
    begun, go_on = threading.Event(), threading.Event()

    def hang(_frame):
        begun.set()
        assert go_on.wait(support.DEADLINE)

    hanging = ImageTaker("/hanging", source.topic, kind, work=hang)
    others = [ImageTaker(f"/other{i}", source.topic, kind) for i in range(2)]
    source.wait_for()
    source.send(message(IMAGE, "bgr8"))
    assert begun.wait(support.DEADLINE)
    for other in others:
        other.wait()
    hanging.close()  # waits a moment for the callback, and leaves it behind
    for number in range(2, 6):
        source.send(message(IMAGE, "bgr8"))
        for other in others:
            other.wait(number)
    go_on.set()
    assert np.array_equal(hanging.wait()[0].image, others[0].received[0].image)
    others[0].close()
    source.send(message(IMAGE, "bgr8"))
    others[1].wait(6)
    assert len(hanging.received) == 1
    others[1].close()
    source.wait_for(0)


def test_publishers_and_statistics_end_with_their_node(diagnostics):
    topic = new_topic()
    rospy.set_param("/sender/diagnostic_period", 0.1)
    sender, receiver = LoadedContext("/sender", {}, print), ImageTaker("/receiver", topic)
    with active(sender):
        publisher = ImagePublisher(topic)
        statistics = node_diagnostics()
    support.wait_for(publisher.get_num_connections, "the subscription")
    publisher.publish(IMAGE)
    receiver.wait()
    support.wait_for(lambda: diagnostics.value("sender", "frames received") == "0", "statistics")
    sender.end()
    support.wait_for(lambda: receiver.images.get_num_connections() == 0, "the end of the topic")
    publisher.publish(IMAGE)  # does nothing
    assert publisher.get_num_connections() == 0 and statistics is not None
    with active(sender), pytest.raises(RuntimeError, match="has been shut down"):
        ImagePublisher(topic)
    rospy.delete_param("/sender")
