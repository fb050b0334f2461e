"""Topics as JSON on channels, and their rates."""

import pytest
import rospy
import support
from feature_page import FeaturePage, Publishers, RefusedError, subscribes
from std_msgs.msg import Float32, String

from robot_vision.dashboard import message_feature
from robot_vision.dashboard.message_feature import MessageFeature
from robot_vision.dashboard.settings import Settings
from robot_vision.msg import Detection, DetectionArray


@pytest.fixture
def feature(master):
    return MessageFeature(Settings())


@pytest.fixture
def page(feature):
    made = FeaturePage(feature, role="view")
    yield made
    made.close()


@pytest.fixture
def publish():
    with Publishers() as publishers:
        yield publishers


def test_messages_come_as_json_with_their_time(page, publish):
    message = DetectionArray(width=64, detections=[Detection(label="<b>", score=float("nan"))])
    message.header.stamp = rospy.Time(12, 500000000)
    publish("/found", message)
    page.request("messages", channel=3, topic="/found", rate=0)
    got = page.wait_for_message(3)
    assert got["stamp"] == 12.5 and got["received"] > 1e9
    assert got["data"]["width"] == 64 and got["data"]["_type"] == "robot_vision/DetectionArray"
    assert got["data"]["detections"][0]["label"] == "<b>"
    assert got["data"]["detections"][0]["score"] is None


def test_what_has_no_stamp_has_the_time_of_ros_when_it_came(page, publish, monkeypatch):
    monkeypatch.setattr(rospy, "get_time", lambda: 12.25)  # which may be simulated
    publish("/text", String("x"))
    page.request("messages", channel=1, topic="/text")
    got = page.wait_for_message(1)
    assert got["stamp"] == 12.25 and got["received"] > 1e9


def test_large_arrays_are_cut(page, publish):
    found = [Detection(label=str(index)) for index in range(10000)]
    publish("/many", DetectionArray(detections=found))
    page.request("messages", channel=1, topic="/many")
    data = page.wait_for_message(1)["data"]
    assert data["_cut"] == {"detections": 10000} and len(data["detections"]) < 10000


def test_a_topic_may_change_its_type(page, publish):
    publisher = publish("/changing", String("text"))
    page.request("messages", channel=1, topic="/changing")
    page.wait_for_message(1, lambda data: data.get("data") == "text")
    publisher.unregister()
    me = rospy.get_name()  # rospy makes no second connection to a node while it has the first
    support.wait_for(lambda: not support.receives_over(me, "/changing"), "the end of the first")
    publish("/changing", Float32(0.5))
    assert page.wait_for_message(1, lambda data: data.get("data") == 0.5)


def test_a_type_that_is_not_installed_is_told(page, publish):
    class Strange(String):
        _type = "no_such_package/Thing"

    publish("/strange", Strange("x"))
    page.request("messages", channel=1, topic="/strange")
    data = page.wait_for_message(1)["data"]
    assert data["_error"] == "the type no_such_package/Thing is not installed here"


def test_another_version_of_a_type_is_told(page, publish):
    class Other(Float32):
        _type = "std_msgs/String"

    publish("/other", Other(1.0))
    page.request("messages", channel=1, topic="/other")
    data = page.wait_for_message(1)["data"]
    assert data["_error"] == "std_msgs/String is installed here in another version"


def test_one_subscription_for_all_that_ends_with_the_last(page, feature, publish):
    publish("/shared", String("x"))
    other = FeaturePage(feature)
    page.request("messages", channel=1, topic="/shared")
    other.request("messages", channel=1, topic="/shared")
    page.wait_for_message(1)
    other.wait_for_message(1)
    page._call(page.session.close_channel, 1)
    other.close()
    support.wait_for(lambda: not subscribes("/shared"), "the end of the subscription")


class Reader(support.Messages):
    """The texts that another subscriber of this process gets, as bytes like all in it."""

    def __init__(self, topic):
        super().__init__(topic, rospy.AnyMsg)

    def _on_message(self, message):
        super()._on_message(message._buff[4:].decode())


def test_the_newest_replaces_what_a_page_does_not_take(page, publish):
    page.draws = False
    reader = Reader("/fast")
    page.request("messages", channel=1, topic="/fast")
    publish("/fast", String("0"))
    page.wait_for_message(1)
    publish("/fast", String("1"))
    support.wait_for(lambda: len(page.messages(1)) == 2, "two messages in flight")
    for number in range(2, 50):
        publish("/fast", String(str(number)))
    support.wait_for(lambda: reader.received[-1:] == ["49"], "the last message")
    assert len(page.messages(1)) == 2
    page.draws = True
    for message in page.messages(1):
        page._call(page.session.acknowledge, 1, message["seq"])
    assert page.wait_for_message(1, lambda data: data["data"] == "49")
    assert len(page.messages(1)) <= 4


def test_one_who_hardly_wants_any_does_not_end_it_for_others(page, publish):
    publisher = publish("/seldom", String("first"))
    page.request("messages", channel=1, topic="/seldom", rate=1e-320)
    page.wait_for_message(1)
    publisher.publish("second")  # for which the first has to wait
    page.request("messages", channel=2, topic="/seldom")
    page.wait_for_message(2, lambda data: data.get("data") == "second")
    publisher.publish("third")
    page.wait_for_message(2, lambda data: data.get("data") == "third")


def test_a_channel_that_is_open_is_refused(page):
    page.request("messages", channel=1, topic="/a")
    with pytest.raises(RefusedError, match="channel 1 is open already"):
        page.request("messages", channel=1, topic="/b")
    assert not subscribes("/b")


@pytest.mark.parametrize("topic", ["", "a", "/a b", "/<script>", "/a/../b", "/" + "a" * 255])
def test_names_that_are_no_topics_are_refused(page, topic):
    with pytest.raises(RefusedError, match="is no name"):
        page.request("messages", channel=1, topic=topic)
    page.request("messages", channel=1, topic="/good")  # The channel is free again.


def test_the_rate_of_a_topic_is_measured(page, publish, monkeypatch):
    monkeypatch.setattr(message_feature, "RATE_TIME", support.DEADLINE)  # until it has enough
    number = page.start("rate", topic="/ticking")
    support.wait_for(lambda: subscribes("/ticking"), "the subscription")
    while not page.has_answer_to(number):
        publish("/ticking", String("x" * 96))
        support.arrived.wait(0.01)
    told = page.answer_to(number)
    assert told["count"] > 1 and told["rate"] > 0.0
    assert told["bandwidth"] == pytest.approx(100 * told["rate"])
    assert not subscribes("/ticking")


def test_a_rate_that_is_measured_holds_up_no_other_request(page, publish, monkeypatch):
    counters = []

    class Counter(message_feature._Counter):
        def __init__(self):
            super().__init__()
            counters.append(self)

    monkeypatch.setattr(message_feature, "_Counter", Counter)
    monkeypatch.setattr(message_feature, "RATE_TIME", support.DEADLINE)
    publish("/beside", String("x"))
    number = page.start("rate", topic="/silent")
    page.request("messages", channel=1, topic="/beside")
    page.wait_for_message(1)
    assert not page.has_answer_to(number)
    support.wait_for(lambda: counters, "the measurement to begin")
    counters[0].enough.set()
    assert page.answer_to(number)["count"] == 0


def test_what_cannot_be_converted_is_told_and_the_next_message_sent(page, publish, monkeypatch):
    monkeypatch.setattr(message_feature, "to_plain", lambda _: 1 / 0)
    publish("/odd", String("x"))
    page.request("messages", channel=1, topic="/odd")
    assert page.wait_for_message(1)["data"]["_error"] == "division by zero"
    monkeypatch.undo()
    publish("/odd", String("y"))
    assert page.wait_for_message(1, lambda data: data.get("data") == "y")


def test_a_topic_without_messages_has_no_rate(page):
    assert page.request("rate", topic="/silent") == {"rate": None, "bandwidth": None, "count": 0}
