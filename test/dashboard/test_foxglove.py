"""Foxglove's protocol, field by field, and what waits for a client."""

import json
import struct

import pytest
import rospy
from geometry_msgs.msg import TransformStamped
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

from robot_vision.dashboard import foxglove_protocol as protocol
from robot_vision.dashboard import foxglove_topics
from robot_vision.dashboard.foxglove_queue import MAX_WAITING, FairQueue
from robot_vision.dashboard.foxglove_topics import ForwardedTopic, TopicList
from robot_vision.dashboard.message_topics import RawMessage


def test_server_info_offers_nothing_but_reading():
    assert json.loads(protocol.server_info("/dashboard", "17")) == {
        "op": "serverInfo",
        "name": "/dashboard",
        "capabilities": [],
        "metadata": {},
        "sessionId": "17",
    }


def test_advertise_has_the_whole_definition_of_the_type():
    topics = TopicList()
    topics._known[("/head", "std_msgs/Header")] = topics._made("/head", "std_msgs/Header")
    added, gone = topics.update({("/head", "std_msgs/Header")})
    told = json.loads(protocol.advertise(added))
    assert gone == [] and told == {
        "op": "advertise",
        "channels": [
            {
                "id": 1,
                "topic": "/head",
                "encoding": "ros1",
                "schemaName": "std_msgs/Header",
                "schema": Header._full_text,
                "schemaEncoding": "ros1msg",
            }
        ],
    }


def test_unadvertise_and_status_are_as_the_protocol_has_them():
    assert json.loads(protocol.unadvertise([5, 2])) == {"op": "unadvertise", "channelIds": [2, 5]}
    assert json.loads(protocol.status(protocol.WARNING, "no")) == {
        "op": "status",
        "level": 1,
        "message": "no",
    }


def test_message_data_is_opcode_subscription_and_time_little_endian():
    time = 1700000000 * 10**9 + 5
    assert protocol.message_data(0x01020304, time) == (
        b"\x01" + bytes([4, 3, 2, 1]) + struct.pack("<Q", time)
    )
    assert protocol.message_data(0, -1)[5:] == bytes(8)


def test_requests_of_a_client_are_read():
    text = '{"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":1,"channelId":5}]}'
    assert protocol.parse_client_text(text) == protocol.Subscribe(((0, 3), (1, 5)))
    text = '{"op":"unsubscribe","subscriptionIds":[0,1]}'
    assert protocol.parse_client_text(text) == protocol.Unsubscribe((0, 1))


@pytest.mark.parametrize(
    "text, words",
    [
        ("", "no JSON"),
        ("{", "no JSON"),
        ("[" * 100000, "no JSON"),
        ("[]", "no JSON object"),
        ("{}", "op is None, this server knows only"),
        ('{"op":"advertise","channels":[]}', "op is advertise, this server knows only"),
        ('{"op":"setParameters"}', "op is setParameters"),
        ('{"op":"\\u001b[31m"}', r"op is \\x1b"),
        ('{"op":"subscribe"}', "subscriptions must be a list"),
        ('{"op":"subscribe","subscriptions":[1]}', "no JSON object"),
        ('{"op":"subscribe","subscriptions":[{"id":1}]}', "channelId is None, must be an integer"),
        ('{"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]}', "id is -1"),
        ('{"op":"subscribe","subscriptions":[{"id":true,"channelId":1}]}', "id is True"),
        (
            '{"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]}',
            "id is 4294967296",
        ),
        ('{"op":"unsubscribe","subscriptionIds":["a"]}', "subscriptionIds is a"),
        (json.dumps({"op": "unsubscribe", "subscriptionIds": [1] * 201}), "at most 200"),
    ],
)
def test_what_cannot_be_done_is_refused_in_words(text, words):
    with pytest.raises(ValueError, match=words):
        protocol.parse_client_text(text)


def test_a_topic_that_changes_its_type_is_another_channel_and_may_come_back():
    topics = TopicList()
    first, other = ("/a", "std_msgs/String"), ("/a", "std_msgs/Bool")
    topics._known.update({key: topics._made(*key) for key in (first, other)})
    added, _ = topics.update({first})
    again, gone = topics.update({other})
    assert gone == [added[0].id] and again[0].id != added[0].id
    assert topics.update({first})[0] == added  # with the number that it had
    assert topics.update(set()) == ([], [added[0].id])


@pytest.mark.parametrize(
    "kind", ["nowhere/Nothing", "std_msgs/Nothing", "*", "", "../x/y", "a\n/b"]
)
def test_a_topic_whose_type_is_not_installed_is_no_channel(kind):
    assert TopicList()._made("/a", kind) is None


@pytest.mark.parametrize("package", ["single", "folder"])
def test_no_module_is_imported_because_a_type_has_its_name(package, tmp_path, monkeypatch):
    (tmp_path / "folder").mkdir()
    for file in ("single.py", "folder/__init__.py"):
        (tmp_path / file).write_text("raise SystemExit('imported')")
    monkeypatch.syspath_prepend(tmp_path)
    assert TopicList()._made("/a", f"{package}/Thing") is None


def test_bytes_of_a_message_that_others_have_decoded_are_the_same():
    message = Header(seq=3, frame_id="eye")
    data = b"\3\0\0\0" + bytes(8) + b"\3\0\0\0eye"
    raw = RawMessage("std_msgs/Header", "", data, 0.0, "/node")
    assert raw.serialized() == data
    assert raw._replace(data=b"", message=message).serialized() == data


def queue_of(*subscriptions):
    queue = FairQueue()
    for number in subscriptions:
        queue.add(number)
    return queue


def taken(queue):
    return list(iter(lambda: (queue.take() or (None, None))[1], None))


def test_messages_of_a_subscription_keep_their_order():
    queue = queue_of(1)
    for data in (b"a", b"b", b"c"):
        queue.put(1, b"", data)
    assert taken(queue) == [b"a", b"b", b"c"] and queue.dropped == 0


def test_of_large_messages_only_the_newest_waits():
    queue = queue_of(1)
    images = [bytes([at]) * (MAX_WAITING + 1) for at in range(5)]
    for image in images:
        queue.put(1, b"", image)
    assert queue.size() == MAX_WAITING + 1
    assert taken(queue) == [images[-1]] and queue.dropped == 4


def test_a_small_topic_waits_for_one_large_message_at_most():
    queue = queue_of(1, 2, 3)
    for turn in range(50):
        for image in (1, 2):
            queue.put(image, b"", bytes(300000))
        queue.put(3, b"", b"tf")
        assert b"tf" in (queue.take().data, queue.take().data), turn


def test_large_topics_share_the_connection_and_none_starves():
    queue, counts = queue_of(1, 2, 3), [0, 0, 0]
    for _ in range(300):
        for number in (1, 2, 3):
            queue.put(number, bytes([number]), bytes(100 if number == 3 else 1000))
        counts[queue.take().head[0] - 1] += 1
    assert abs(counts[0] - counts[1]) <= 1 and counts[2] > 5 * counts[0] > 0


def test_who_was_quiet_or_is_new_does_not_hold_up_the_others():
    queue = queue_of(1, 2)
    for _ in range(100):
        queue.put(1, b"", bytes(1000))
        queue.take()
    queue.add(3)
    heads = []
    for _ in range(40):
        for number in (1, 2, 3):
            queue.put(number, bytes([number]), bytes(1000))
        heads.append(queue.take().head[0])
    assert all(heads.count(number) >= 13 for number in (1, 2, 3))


def test_what_comes_for_a_subscription_that_has_ended_is_dropped():
    queue = queue_of(1)
    queue.put(1, b"", b"a")
    queue.remove(1)
    queue.put(1, b"", b"b")
    assert queue.take() is None and queue.size() == 0


def latched(message):
    return RawMessage(
        message._type, message._md5sum, b"", 0.0, "/player", message=message, latched=True
    )


def test_who_comes_later_gets_all_static_transforms_of_a_node(monkeypatch):
    """A node that plays a bag says those of each recorded sender in a message of its own."""
    monkeypatch.setattr(foxglove_topics, "RawTopic", lambda _topic, _take: None)
    monkeypatch.setattr(rospy.Time, "now", rospy.Time)
    topic = ForwardedTopic("/tf_static")
    for child in ("eye", "hand", "eye"):
        topic._take(latched(TFMessage([TransformStamped(child_frame_id=child)])))
    for name in ("an old one", "the newest"):
        topic._take(latched(Header(frame_id=name)))
    transforms, headers = [], []
    for came, kind in (transforms, TFMessage), (headers, Header):
        channel = protocol.TopicChannel(1, "/tf_static", kind._type, "")
        topic.add(
            channel, lambda _, data, came=came, kind=kind: came.append(kind().deserialize(data))
        )
    assert [one.transforms[0].child_frame_id for one in transforms] == ["eye", "hand"]
    assert [one.frame_id for one in headers] == ["the newest"]
