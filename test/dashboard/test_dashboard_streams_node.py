"""Images, points and Foxglove's messages of a running dashboard."""

import asyncio
import contextlib
import json
import struct
import threading
import xmlrpc.client

import cv2
import numpy as np
import pytest
import rospy
import support
from frames import message, new_topic
from sensor_msgs.msg import CompressedImage, Image, PointCloud2
from sensor_msgs.point_cloud2 import create_cloud_xyz32
from std_msgs.msg import Header, String
from streamed import TOKEN, Dashboard, publisher, subscribers
from tornado.httpclient import HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

JPEG, POINTS, PNG = 1, 2, 3


def smooth(height, width, blue=90):
    y, x = np.mgrid[:height, :width].astype(np.float32)
    planes = [np.full_like(x, blue), 200 * x / width, 220 * y / height]
    return np.dstack(planes).astype(np.uint8)


def compressed(ending, image, form):
    data = cv2.imencode(ending, image)[1].tobytes()
    return CompressedImage(Header(stamp=rospy.Time(50, 500000000)), form, data)


class Topic:
    """A topic that this test publishes."""

    def __init__(self, name, kind=Image, queue_size=10):
        self.name = name
        self._publisher = publisher(name, kind, queue_size=queue_size)

    def send(self, sent, subscribed=True):
        if subscribed:
            support.wait_for(self._publisher.get_num_connections, f"a subscriber of {self.name}")
        self._publisher.publish(sent)

    def close(self):
        self._publisher.unregister()


@contextlib.contextmanager
def sent_again_and_again(topic, sent):
    """Sends a message ten times a second: the first ones may meet a subscription that ends."""
    ended = threading.Event()

    def send():
        while not ended.wait(0.1):
            topic.send(sent, subscribed=False)

    sender = threading.Thread(target=send)
    sender.start()
    try:
        yield
    finally:
        ended.set()
        sender.join()


@pytest.fixture(scope="module")
def dashboard(start_once):
    return Dashboard(start_once, "_foxglove:=true")


@pytest.fixture
def page(dashboard):
    made = dashboard.page()
    yield made
    made.end()


@pytest.fixture
def topic():
    made = Topic(new_topic())
    yield made
    made.close()


def stamped(image, encoding, secs):
    sent = message(image, encoding)
    sent.header.stamp = rospy.Time(secs, 250000000)
    return sent


def test_a_page_gets_images_with_time_size_and_pixels(page, topic):
    page.ask("image", channel=7, topic=topic.name, width=160)
    image = smooth(480, 640)
    for secs in (10, 11, 12):
        topic.send(stamped(image, "bgr8", secs))
        frame = page.frame()
        assert (frame.kind, frame.channel, frame.stamp) == (JPEG, 7, secs + 0.25)
        assert (frame.width, frame.height) == (640, 480)
        expected = cv2.resize(image, (160, 120), interpolation=cv2.INTER_AREA)
        assert np.abs(frame.image.astype(int) - expected).mean() < 4


def test_depths_of_a_bag_that_is_played_are_shown(page):
    base = new_topic()
    played = Topic(f"{base}/compressedDepth", CompressedImage)
    sent = compressed(".png", np.full((12, 16), 1500, np.uint16), "16UC1; compressedDepth png")
    sent.data = bytes(12) + sent.data  # the header, which only codes of 32FC1 need
    try:
        page.ask("image", channel=1, topic=played.name)
        played.send(sent)
        frame = page.frame()
        assert (frame.width, frame.height, frame.stamp) == (16, 12, 50.5)
    finally:
        played.close()


def test_without_viewers_nothing_is_subscribed(page, topic, dashboard):
    assert subscribers(topic.name) == []
    page.ask("image", channel=1, topic=topic.name)
    support.wait_for(lambda: subscribers(topic.name), "the subscription")
    other = dashboard.page()
    other.ask("image", channel=1, topic=topic.name)
    page.ask("close_channel", channel=1)
    other.end_now()
    support.wait_for(lambda: not subscribers(topic.name), "the end of the subscription")


def test_a_stalled_page_gets_two_frames_and_then_the_newest(page, topic, dashboard):
    stalled = dashboard.page()
    for one in (page, stalled):
        one.ask("image", channel=1, topic=topic.name)
    for secs in range(1, 11):
        topic.send(stamped(smooth(48, 64), "bgr8", secs))
        assert page.frame().stamp == secs + 0.25
    first, second = stalled.frame(False), stalled.frame(False)
    assert [first.stamp, second.stamp] == [1.25, 2.25]
    stalled.send({"op": "ack", "channel": 1, "seq": first.seq})
    assert stalled.frame().stamp == 10.25
    stalled.end()


def test_a_channel_is_opened_once_and_can_be_opened_again_when_it_was_closed(page, topic):
    page.ask("image", channel=3, topic=topic.name)
    with pytest.raises(ValueError, match="channel 3 is open already"):
        page.ask("image", channel=3, topic=topic.name)
    page.ask("close_channel", channel=3)
    page.ask("image", channel=3, topic=topic.name, width=160)
    topic.send(stamped(smooth(240, 320), "bgr8", 5))
    assert page.frame().image.shape == (120, 160, 3)


@pytest.mark.parametrize(
    "fields, words",
    [
        ({"topic": "no name"}, "is no name"),
        ({"topic": "/rosout"}, "is of rosgraph_msgs/Log, must be of sensor_msgs/Image"),
        ({"topic": "/a", "quality": 0}, "quality"),
        ({"topic": "/a", "width": -5}, "width"),
    ],
)
def test_what_cannot_be_shown_is_refused_and_the_channel_stays_free(page, fields, words):
    for _ in range(2):
        with pytest.raises(ValueError, match=words):
            page.ask("image", channel=9, **fields)


def test_size_and_encoding_change_while_a_page_looks(page, topic):
    page.ask("image", channel=1, topic=topic.name)
    sent = [
        (smooth(480, 640), "bgr8"),
        (np.full((30, 20), 200, np.uint8), "mono8"),
        (np.full((10, 12), 2500, np.uint16), "16UC1"),
        (np.full((10, 12), 2.5, np.float32), "32FC1"),
        (np.full((16, 16), 77, np.uint8), "bayer_rggb8"),
    ]
    for secs, (image, encoding) in enumerate(sent, 1):
        topic.send(stamped(image, encoding, secs))
        frame = page.frame()
        assert frame.image.shape[:2] == image.shape[:2] and frame.stamp == secs + 0.25
    topic.send(stamped(np.zeros((4, 4, 2), np.float32), "32FC2", 9))
    told = page.push("channel_error")
    assert told["channel"] == 1 and "'32FC2' cannot be shown" in told["text"]
    topic.send(stamped(smooth(48, 64), "bgr8", 10))
    assert page.frame().stamp == 10.25


def test_a_topic_vanishes_and_comes_back_with_another_type(page):
    name = new_topic()
    page.ask("image", channel=1, topic=name)
    kinds = [
        (Image, stamped(smooth(48, 64), "bgr8", 1), JPEG),
        (CompressedImage, compressed(".png", smooth(20, 30), "bgr8; png compressed bgr8"), PNG),
        (Image, stamped(smooth(48, 64), "bgr8", 3), JPEG),
    ]
    for type_, sent, kind in kinds:
        topic = Topic(name, type_)
        with sent_again_and_again(topic, sent):
            frame = page.frame()
            while frame.stamp != sent.header.stamp.to_sec():  # one of before was under way
                frame = page.frame()
        assert frame.kind == kind
        topic.close()


def test_a_topic_may_come_later_than_its_viewer(page):
    name = new_topic()
    page.ask("image", channel=1, topic=name)
    late = Topic(name)
    late.send(stamped(smooth(48, 64), "bgr8", 1))
    assert page.frame().stamp == 1.25
    late.close()


def test_jpegs_of_a_camera_go_on_byte_for_byte(page, dashboard):
    # A node that is called as the camera, with its parameter, and its two topics.
    rospy.set_param("/test/pixel_format", "mjpeg")
    raw, jpeg = Topic("/test/image_raw"), Topic("/test/image_raw/compressed", CompressedImage)
    pages = [page, dashboard.page()]
    for at, one in enumerate(pages):
        one.ask("image", channel=1, topic="/test/image_raw", width=160 * (at + 1))
    sent = compressed(".jpg", smooth(480, 640), "bgr8; jpeg compressed bgr8")
    jpeg.send(sent)
    for one in pages:
        frame = one.frame()
        assert frame.payload == sent.data and frame.kind == JPEG
        assert (frame.stamp, frame.width, frame.height) == (50.5, 640, 480)
    assert subscribers("/test/image_raw") == []
    rospy.delete_param("/test/pixel_format")
    pages[1].end()
    raw.close()
    jpeg.close()


@pytest.mark.parametrize("name, sizes", [("image/compressed", (160, 640)), ("photo", (640, 640))])
def test_jpegs_are_made_smaller_only_for_who_wants_a_low_quality(page, dashboard, name, sizes):
    jpeg = Topic(f"{new_topic()}/{name}", CompressedImage)
    pages = [page, dashboard.page()]
    for one, quality in zip(pages, (50, 80)):
        one.ask("image", channel=1, topic=jpeg.name, width=160, quality=quality)
    sent = compressed(".jpg", smooth(480, 640), "bgr8; jpeg compressed bgr8")
    with sent_again_and_again(jpeg, sent):
        frames = [one.frame() for one in pages]
    assert tuple(frame.image.shape[1] for frame in frames) == sizes
    assert all((frame.width, frame.height) == (640, 480) for frame in frames)
    assert frames[1].payload == sent.data
    pages[1].end()
    jpeg.close()


def test_images_go_on_after_the_master_is_another_one(start):
    master = support.Master(start)
    small = ("_image_width:=320", "_image_height:=240")
    camera = ("camera_node", "__name:=usb_cam", "_source:=synthetic", *small)
    first = start(*camera, env=master.env)
    page = Dashboard(start, **master.env).page()
    page.ask("image", channel=1, topic="/usb_cam/image_raw")
    before = page.frame()
    assert (before.width, before.height) == (320, 240)
    master.end()
    assert page.ask("ping")
    master.begin()
    first.interrupt()
    first.exit_code()
    begin = rospy.get_time()  # Only the camera that starts now sends images of a later time.
    start(*camera, env=master.env)
    try:
        while page.frame().stamp < begin:
            pass
    except asyncio.TimeoutError:
        told = [connections(master, name) for name in ("/dashboard_images", "/usb_cam")]
        raise AssertionError(f"no new image; {page.pushes}; connections: {told}") from None
    page.end()


def connections(master, node):
    """What a node tells of its connections, and where the master says that it is."""
    uri = master.api.lookupNode(node)
    return uri, xmlrpc.client.ServerProxy(uri).getBusInfo("/test")


def test_points_come_with_their_colors_and_as_many_as_wanted(page):
    name = new_topic()
    clouds = Topic(name, PointCloud2)
    page.ask("points", channel=2, topic=name, max_points=100)
    xyz = np.arange(3000, dtype=np.float32).reshape(1000, 3)
    clouds.send(create_cloud_xyz32(Header(stamp=rospy.Time(8)), xyz))
    frame = page.frame()
    assert (frame.kind, frame.width, frame.height, frame.stamp) == (POINTS, 100, 1, 8.0)
    assert len(frame.payload) == 100 * 16
    assert np.array_equal(np.frombuffer(frame.payload, "<f4", 300).reshape(100, 3), xyz[::10])
    broken = create_cloud_xyz32(Header(), xyz)
    broken.data = broken.data[:-1]
    clouds.send(broken)
    assert "which is too few" in page.push("channel_error")["text"]
    clouds.send(create_cloud_xyz32(Header(stamp=rospy.Time(9)), xyz[:7]))
    assert page.frame().width == 7
    page.ask("close_channel", channel=2)
    support.wait_for(lambda: not subscribers(name), "the end of the subscription")
    clouds.close()


class Client:
    """A client of Foxglove's protocol."""

    def __init__(self, host, token=TOKEN, subprotocols=("foxglove.websocket.v1",), origin=None):
        self._loop = asyncio.new_event_loop()
        headers = {"Origin": origin} if origin else {}
        request = HTTPRequest(f"ws://{host}/foxglove?token={token}", headers=headers)
        self.socket = self._run(websocket_connect, request, subprotocols=list(subprotocols))

    def send(self, message):
        binary = isinstance(message, bytes)
        self._run(self.socket.write_message, message if binary else json.dumps(message), binary)

    def read(self):
        message = self._run(self.socket.read_message)
        return json.loads(message) if isinstance(message, str) else message

    def wait_for(self, op, wanted=lambda message: True):
        while True:
            message = self.read()
            assert message is not None, (self.socket.close_code, self.socket.close_reason)
            if isinstance(message, dict) and message["op"] == op and wanted(message):
                return message

    def channel(self, topic):
        """The channel of a topic, as it is advertised."""

        def has(message):
            return any(channel["topic"] == topic for channel in message["channels"])

        channels = self.wait_for("advertise", has)["channels"]
        return next(channel for channel in channels if channel["topic"] == topic)

    def data(self):
        """The next message of a topic: subscription, time in ns and bytes."""
        message = self.read()
        while isinstance(message, dict):
            message = self.read()
        opcode, subscription, time = struct.unpack_from("<BIQ", message)
        assert opcode == 1
        return subscription, time, message[13:]

    def close(self):
        self.socket.close()
        self._loop.run_until_complete(asyncio.sleep(0))
        self._loop.close()

    def _run(self, call, *arguments, **options):
        async def work():
            return await asyncio.wait_for(call(*arguments, **options), support.DEADLINE)

        return self._loop.run_until_complete(work())


@pytest.fixture
def client(dashboard):
    made = Client(dashboard.host)
    yield made
    made.close()


def test_a_client_of_foxglove_reads_a_topic(client):
    name = new_topic()
    text = Topic(name, String)
    assert client.socket.selected_subprotocol == "foxglove.websocket.v1"
    info = client.wait_for("serverInfo")
    assert info["capabilities"] == [] and info["name"] == "/dashboard"
    channel = client.channel(name)
    assert (channel["encoding"], channel["schemaName"]) == ("ros1", "std_msgs/String")
    assert (channel["schema"], channel["schemaEncoding"]) == (String._full_text, "ros1msg")
    assert subscribers(name) == []
    client.send({"op": "subscribe", "subscriptions": [{"id": 4, "channelId": channel["id"]}]})
    before = rospy.Time.now().to_nsec()
    text.send(String("hello"))
    subscription, time, data = client.data()
    assert subscription == 4 and before <= time <= rospy.Time.now().to_nsec()
    assert String().deserialize(data).data == "hello"
    client.send({"op": "unsubscribe", "subscriptionIds": [4]})
    support.wait_for(lambda: not subscribers(name), "the end of the subscription")
    text.close()
    gone = client.wait_for("unadvertise", lambda message: channel["id"] in message["channelIds"])
    assert gone["channelIds"]


def test_who_subscribes_later_gets_what_is_latched(client, dashboard):
    name = new_topic()
    latched = publisher(name, String, latch=True)
    latched.publish(String("map"))
    number = client.channel(name)["id"]
    client.send({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": number}]})
    assert String().deserialize(client.data()[2]).data == "map"
    late = Client(dashboard.host)
    late.channel(name)
    late.send({"op": "subscribe", "subscriptions": [{"id": 9, "channelId": number}]})
    subscription, _, data = late.data()
    assert subscription == 9 and String().deserialize(data).data == "map"
    late.close()
    latched.unregister()


def test_what_a_client_does_wrong_is_told_and_the_connection_stays(client, topic):
    number = client.channel(topic.name)["id"]
    one = {"id": 1, "channelId": number}
    for sent, words in [
        ({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 99999}]}, "no channel 99999"),
        ({"op": "unsubscribe", "subscriptionIds": [5]}, "no subscription 5"),
        ({"op": "advertise", "channels": []}, "knows only subscribe"),
        ({"op": "subscribe", "subscriptions": [one, one]}, "a subscription 1 already"),
        ({"op": "subscribe", "subscriptions": [{**one, "id": 2}]}, "is subscribed to already"),
        (b"\x01\x00\x00\x00\x00data", "can only be read"),
    ]:
        client.send(sent)
        told = client.wait_for("status")
        assert told["level"] == 1 and words in told["message"]


def test_a_channel_that_is_gone_leaves_the_others(client, topic):
    good = {"id": 7, "channelId": client.channel(topic.name)["id"]}
    client.send({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 99999}, good]})
    assert "no channel 99999" in client.wait_for("status")["message"]
    topic.send(stamped(smooth(24, 32), "bgr8", 3))
    assert client.data()[0] == 7
    client.send({"op": "unsubscribe", "subscriptionIds": [1, 7]})
    assert "no subscription 1" in client.wait_for("status")["message"]
    client.send({"op": "unsubscribe", "subscriptionIds": [7]})
    assert "no subscription 7" in client.wait_for("status")["message"]


def test_images_do_not_hold_up_small_topics_nor_wait_in_a_queue(client, topic):
    name = new_topic()
    text = Topic(name, String, queue_size=30)  # for all of them
    numbers = {topic.name: 1, name: 2}
    ids = {}
    while len(ids) < 2:
        for channel in client.wait_for("advertise")["channels"]:
            if channel["topic"] in numbers:
                ids[channel["topic"]] = channel["id"]
    for of in numbers:
        client.send(
            {"op": "subscribe", "subscriptions": [{"id": numbers[of], "channelId": ids[of]}]}
        )
    for secs in range(1, 31):  # 186 MB, which no socket holds
        topic.send(stamped(smooth(1080, 1920), "bgr8", secs))
        text.send(String(str(secs)))
    texts, images = [], []
    while not texts or texts[-1] != "30" or not images or images[-1] != 30:
        subscription, _, data = client.data()
        if subscription == 2:
            texts.append(String().deserialize(data).data)
        else:
            images.append(Header().deserialize(data[: 4 + 8 + 4 + 0]).stamp.secs)
    assert texts == [str(secs) for secs in range(1, 31)]
    assert len(images) < 30
    text.close()


@pytest.mark.parametrize(
    "options", [{"token": ""}, {"token": "wrong"}, {"origin": "http://evil.example"}]
)
def test_foxglove_is_for_those_who_may(dashboard, options):
    with pytest.raises(HTTPClientError, match="403"):
        Client(dashboard.host, **options)


def test_programs_whose_page_is_a_file_need_the_token(dashboard, start):
    client = Client(dashboard.host, origin="file://")
    assert client.wait_for("serverInfo")["name"] == "/dashboard"
    client.close()
    open_for_all = Dashboard(start, "__name:=open", "_foxglove:=true", "_token:=none")
    with pytest.raises(HTTPClientError, match="403"):
        Client(open_for_all.host, token="", origin="file://")


def test_another_subprotocol_is_refused(dashboard):
    client = Client(dashboard.host, subprotocols=["foxglove.websocket.v9"])
    assert client.read() is None and client.socket.close_code == 1002
    assert client.socket.close_reason == "the subprotocol must be foxglove.websocket.v1"
    client.close()


def test_foxglove_is_there_only_if_it_is_asked_for_and_origins_can_be_named(start):
    plain = Dashboard(start, "__name:=plain")
    with pytest.raises(HTTPClientError, match="404"):
        Client(plain.host)
    origin = "https://app.foxglove.dev"
    other = Dashboard(start, "__name:=other", "_foxglove:=true", f"_foxglove_origins:=[{origin}]")
    client = Client(other.host, origin=origin)
    assert client.wait_for("serverInfo")["name"] == "/other"
    client.close()


@pytest.mark.parametrize("origins", ["[app.foxglove.dev]", "https://app.foxglove.dev", "[1]"])
def test_origins_that_are_none_end_the_node_in_words(start, origins):
    process = start("dashboard.py", "_port:=0", f"_foxglove_origins:={origins}")
    process.wait_for_output("must be a list of at most 64 origins as https://app.foxglove.dev")
    assert process.exit_code() == 1
