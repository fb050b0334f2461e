"""web_video_server's URLs of a running dashboard, as programs and browsers read them."""

import asyncio
import contextlib
import itertools
import json
import re
import shutil
import socket
import subprocess
import threading

import cv2
import numpy as np
import pytest
import rospy
import support
from browser import missing, running
from frames import message, new_topic
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header
from streamed import TOKEN, Dashboard, decoded, publisher, subscribers
from tornado.ioloop import IOLoop
from tornado.iostream import IOStream

from robot_vision.dashboard import web_video_viewer
from robot_vision.dashboard.channels import JPEG
from robot_vision.dashboard.pictures import Picture
from robot_vision.dashboard.web_video_viewer import HttpViewer, MultipartStream, keep_alive

BOUNDARY = b"--boundarydonotcross\r\n"


def pattern(height=48, width=64, level=200):
    """An image whose upper left quarter is bright."""
    image = np.full((height, width, 3), 20, np.uint8)
    image[: height // 2, : width // 2] = level
    return image


@pytest.fixture(scope="module")
def dashboard(start_once):
    return Dashboard(start_once)


class Camera:
    """Publishes a still image; who subscribes gets it at once."""

    def __init__(self, image=None, encoding="bgr8", name=""):
        self.topic = name or new_topic()
        self._publisher = publisher(self.topic, Image, latch=True)
        self.send(pattern() if image is None else image, encoding)

    def send(self, image, encoding="bgr8", secs=77):
        sent = message(image, encoding)
        sent.header = Header(stamp=rospy.Time(secs, 500000000))
        self._publisher.publish(sent)

    def close(self):
        self._publisher.unregister()


@pytest.fixture
def camera():
    made = Camera()
    yield made
    made.close()


class Reader:
    """Reads a stream from a socket, as slowly as a test wants."""

    def __init__(self, dashboard, http="HTTP/1.1", said="", token=TOKEN, **arguments):
        host, port = dashboard.host.split(":")
        self._socket = socket.create_connection((host, int(port)), support.DEADLINE)
        path = dashboard.url("/stream", token=token, **arguments).partition(dashboard.host)[2]
        request = f"GET {path} {http}\r\nHost: {dashboard.host}\r\n\r\n{said}"
        self._socket.sendall(request.encode())
        self._rest, self._last = b"", ""
        self.head = self._until(b"\r\n\r\n").decode()
        if self.head.startswith("HTTP/1.1 200"):
            assert self._until(b"\r\n") + b"\r\n" == BOUNDARY

    def part(self):
        """Headers and bytes of the next image; one may be sent twice, for Chromium."""
        headers, data = self._next_part()
        while headers["X-Timestamp"] == self._last:
            headers, data = self._next_part()
        self._last = headers["X-Timestamp"]
        return headers, data

    def _next_part(self):
        """A part has to end with a boundary at once."""
        lines = self._until(b"\r\n\r\n").decode().split("\r\n")
        headers = dict(line.split(": ") for line in lines)
        size = int(headers["Content-Length"])
        while len(self._rest) < size + 2 + len(BOUNDARY):
            self._receive()
        data, self._rest = self._rest[:size], self._rest[size:]
        assert self._rest.startswith(b"\r\n" + BOUNDARY)
        self._rest = self._rest[2 + len(BOUNDARY) :]
        return headers, data

    def close(self):
        self._socket.close()

    def _until(self, end):
        while end not in self._rest:
            self._receive()
        found, _, self._rest = self._rest.partition(end)
        return found

    def _receive(self):
        data = self._socket.recv(65536)
        assert data, "the stream has ended"
        self._rest += data


def test_a_stream_is_a_multipart_with_a_length_and_a_time_for_each_image(dashboard, camera):
    reader = Reader(dashboard, topic=camera.topic)
    assert "multipart/x-mixed-replace;boundary=boundarydonotcross" in reader.head
    assert "Transfer-Encoding" not in reader.head and "Connection: close" in reader.head
    assert "Content-Security-Policy" in reader.head and "nosniff" in reader.head
    for secs, level in ((77, 200), (78, 120), (79, 60)):
        if secs > 77:
            camera.send(pattern(level=level), secs=secs)
        headers, data = reader.part()
        assert headers["Content-Type"] == "image/jpeg"
        assert headers["X-Timestamp"] == f"{secs}.500000"
        assert abs(int(decoded(data)[5, 5, 0]) - level) < 6
    reader.close()
    support.wait_for(lambda: not subscribers(camera.topic), "the end of the subscription")


def test_a_still_image_is_sent_twice_as_browsers_show_one_when_the_next_begins(dashboard, camera):
    reader = Reader(dashboard, topic=camera.topic)
    (first, data), (second, again) = reader._next_part(), reader._next_part()
    assert first == second and data == again
    reader.close()


def test_a_client_of_http_1_0_gets_the_stream_too(dashboard, camera):
    reader = Reader(dashboard, "HTTP/1.0", topic=camera.topic)
    assert decoded(reader.part()[1]).shape == (48, 64, 3)
    reader.close()


def test_the_topic_may_be_named_without_its_slash(dashboard, camera):
    answer = dashboard.get("/snapshot", topic=camera.topic[1:])
    assert answer.code == 200 and decoded(answer.body).shape == (48, 64, 3)


@pytest.mark.parametrize(
    "arguments, shape",
    [
        ({"width": 32}, (24, 32, 3)),
        ({"height": 12}, (12, 16, 3)),
        ({"width": 30, "height": 40}, (40, 30, 3)),
        ({"width": -1, "height": -1}, (48, 64, 3)),
        ({"quality": 10, "qos_profile": "default", "default_transport": "raw"}, (48, 64, 3)),
    ],
)
def test_a_snapshot_has_the_size_that_is_asked_for(dashboard, camera, arguments, shape):
    answer = dashboard.get("/snapshot", topic=camera.topic, **arguments)
    assert (answer.code, answer.headers["Content-Type"]) == (200, "image/jpeg")
    assert answer.headers["X-Timestamp"] == "77.500000"
    assert decoded(answer.body).shape == shape


def test_invert_turns_the_image_by_half_a_turn(dashboard, camera):
    image = decoded(dashboard.get("/snapshot", topic=camera.topic, invert="").body)
    assert image[-5, -5, 0] > 180 and image[5, 5, 0] < 40


def test_png_loses_nothing(dashboard, camera):
    answer = dashboard.get("/snapshot", topic=camera.topic, type="png")
    assert answer.headers["Content-Type"] == "image/png"
    assert np.array_equal(decoded(answer.body), pattern())
    reader = Reader(dashboard, topic=camera.topic, type="png")
    headers, data = reader.part()
    assert headers["Content-Type"] == "image/png" and np.array_equal(decoded(data), pattern())
    reader.close()


def test_ros_compressed_passes_on_what_is_published_beside_the_topic(dashboard, camera):
    data = cv2.imencode(".jpg", pattern(30, 40))[1].tobytes()
    beside = publisher(camera.topic + "/compressed", CompressedImage, latch=True)
    beside.publish(CompressedImage(Header(stamp=rospy.Time(5)), "jpeg", data))
    answer = dashboard.get("/snapshot", topic=camera.topic, type="ros_compressed", width=10)
    assert answer.body == data and answer.headers["X-Timestamp"] == "5.000000"
    beside.unregister()


def test_ros_compressed_falls_back_to_mjpeg(dashboard, camera):
    answer = dashboard.get("/snapshot", topic=camera.topic, type="ros_compressed")
    assert decoded(answer.body).shape == (48, 64, 3)


@pytest.mark.parametrize(
    "arguments, words",
    [
        ({}, "topic is missing"),
        ({"topic": ""}, "topic is missing"),
        ({"topic": "/a%20b"}, "is no name"),
        ({"topic": "/../../etc/passwd"}, "is no name"),
        ({"topic": "/%3Cscript%3E"}, "is no name"),
        ({"topic": "/rosout"}, "is of rosgraph_msgs/Log, must be of sensor_msgs/Image"),
        ({"topic": "/a", "type": "vp8"}, "type is vp8, which would be encoded for each viewer"),
        ({"topic": "/a", "type": "h264"}, "type is h264"),
        ({"topic": "/a", "type": "%1b[31m"}, "must be one of mjpeg, png, ros_compressed"),
        ({"topic": "/a", "width": 0}, "width is '0', must be from 1 to 8192"),
        ({"topic": "/a", "width": 99999999999999}, "width is"),
        ({"topic": "/a", "height": "-2"}, "height is '-2'"),
        ({"topic": "/a", "height": "%D9%A3"}, "height is"),
        ({"topic": "/a", "quality": 101}, "quality is '101', must be from 1 to 100"),
        ({"topic": "/a", "quality": "nan"}, "quality is 'nan'"),
    ],
)
@pytest.mark.parametrize("path", ["/stream", "/snapshot"])
def test_what_cannot_be_shown_is_refused_in_words(dashboard, path, arguments, words):
    answer = dashboard.get(path, **arguments)
    assert answer.code == 400 and words in answer.body.decode()
    assert "\x1b" not in answer.body.decode()


def test_a_snapshot_of_what_cannot_be_encoded_says_so(dashboard):
    camera = Camera(np.zeros((4, 4, 2), np.float32), "32FC2")
    answer = dashboard.get("/snapshot", topic=camera.topic)
    assert answer.code == 400 and "'32FC2' cannot be shown" in answer.body.decode()
    camera.close()


@pytest.mark.parametrize("path", ["/stream", "/snapshot", "/stream_viewer", "/streams"])
def test_a_token_is_needed(dashboard, path):
    for token in ("", "wrong"):
        answer = dashboard.get(path, token=token, topic="/a")
        assert answer.code == 403


def test_open_streams_need_no_token_and_open_nothing_else(start, camera):
    dashboard = Dashboard(start, "__name:=open", "_open_streams:=true")
    assert dashboard.get("/snapshot", token="", topic=camera.topic).code == 200
    assert dashboard.get("/stream_viewer", token="", topic=camera.topic).code == 200
    assert dashboard.get("/", token="").code == 403


def test_the_viewers_page_has_the_stream_and_no_script(dashboard, camera):
    answer = dashboard.get("/stream_viewer", topic=camera.topic, width=32)
    text = answer.body.decode()
    source = re.search(r'<img src="([^"]+)"', text)[1].replace("&amp;", "&")
    assert source.startswith("/stream?") and "width=32" in source and f"token={TOKEN}" in source
    assert "<script" not in text and "style=" not in text
    assert "default-src 'self'" in answer.headers["Content-Security-Policy"]


def test_names_in_the_viewers_page_are_text(dashboard):
    arguments = {"topic": "/a", "x%22%3E%3Cscript%3E": "%22%3E%3Cscript%3Ealert(1)"}
    text = dashboard.get("/stream_viewer", **arguments).body.decode()
    assert "<script" not in text and text.count("<img") == 1 and text.count('"') == 8


def test_the_list_has_all_topics_with_images(dashboard, camera):
    text = dashboard.get("/streams").body.decode()
    assert f">{camera.topic}</a>" in text and "/rosout" not in text


def test_a_slow_reader_gets_newer_images_instead_of_all(dashboard):
    camera = Camera(np.zeros((4, 4, 3), np.uint8))
    slow, quick = (Reader(dashboard, topic=camera.topic, type="png") for _ in range(2))
    noise = np.random.default_rng(5).integers(0, 256, (720, 1280, 3), np.uint8)  # 2.8 MB as PNG
    quick.part()
    for secs in range(100, 112):
        camera.send(noise, secs=secs)
        assert quick.part()[0]["X-Timestamp"] == f"{secs}.500000"
    times = [slow.part()[0]["X-Timestamp"]]
    while times[-1] != "111.500000":
        times.append(slow.part()[0]["X-Timestamp"])
    assert len(times) < 9 and times == sorted(times, key=float)
    for one in (slow, quick, camera):
        one.close()


def test_more_streams_than_allowed_are_refused_and_room_comes_back(start, camera):
    dashboard = Dashboard(start, "__name:=small", "_max_clients:=2")
    readers = [Reader(dashboard, topic=camera.topic) for _ in range(2)]
    for one in readers:
        one.part()
    answer = dashboard.get("/snapshot", topic=camera.topic)
    assert answer.code == 503 and "~max_clients" in answer.body.decode()
    for one in readers:
        one.close()
    support.wait_for(
        lambda: dashboard.get("/snapshot", topic=camera.topic).code == 200, "room for a stream"
    )


def test_who_has_no_token_takes_no_stream_from_those_who_have(start, camera):
    dashboard = Dashboard(start, "__name:=open", "_max_clients:=2", "_open_streams:=true")
    strangers = [Reader(dashboard, token="", topic=new_topic()) for _ in range(2)]  # without images
    assert Reader(dashboard, token="", topic=camera.topic).head.startswith("HTTP/1.1 503")
    known = [Reader(dashboard, topic=camera.topic) for _ in range(2)]
    for one in known:
        one.part()
    assert dashboard.get("/snapshot", topic=camera.topic).code == 503
    for one in strangers + known:
        one.close()


def test_who_vanishes_while_no_image_comes_leaves_room(start):
    """What was said behind the request is not read yet when the connection ends."""
    dashboard = Dashboard(start, "__name:=silent", "_max_clients:=2")
    silent = publisher(new_topic(), Image)
    for _ in range(2):
        reader = Reader(dashboard, said="X", topic=silent.name)
        assert "200 OK" in reader.head
        reader.close()

    def has_room():
        reader = Reader(dashboard, topic=silent.name)
        reader.close()
        return "200 OK" in reader.head

    support.wait_for(has_room, "room for a stream")
    silent.unregister()


class Endless(HttpViewer):
    """Has the next picture as soon as it can be sent."""

    def go_on(self):
        self.show(Picture(1.0, 1.0, 4, 4), JPEG, bytes(1 << 20))


def test_a_reader_who_takes_nothing_any_more_is_gone(monkeypatch):
    monkeypatch.setattr(web_video_viewer, "UNREAD_TIMEOUT", 0.05)
    with socket.create_server(("127.0.0.1", 0)) as server:
        theirs = socket.create_connection(server.getsockname())
        ours = server.accept()[0]

    async def stream():
        viewer = Endless(IOLoop.current())
        viewer.go_on()
        made = MultipartStream(IOStream(ours), b"", viewer)
        await asyncio.wait_for(made.run(), support.DEADLINE)

    asyncio.run(stream())
    assert theirs.recv(len(BOUNDARY)) == BOUNDARY
    theirs.close()


def test_a_reader_whose_machine_is_gone_is_noticed():
    with socket.socket() as connection:
        keep_alive(connection)
        assert connection.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE) == 1
        idle, period, count = (
            connection.getsockopt(socket.IPPROTO_TCP, getattr(socket, name))
            for name in ("TCP_KEEPIDLE", "TCP_KEEPINTVL", "TCP_KEEPCNT")
        )
        assert idle + period * count <= 60


def test_the_node_ends_at_once_while_streams_are_open(start, camera):
    dashboard = Dashboard(start, "__name:=ending")
    reader = Reader(dashboard, topic=camera.topic)
    reader.part()
    dashboard.process.interrupt()
    assert dashboard.process.prompt_exit_code() == 0
    reader.close()


def test_curl_reads_a_snapshot(dashboard, camera, tmp_path):
    curl = shutil.which("curl")
    if not curl:
        pytest.skip("curl is not installed")
    path = tmp_path / "image.jpg"
    url = dashboard.url("/snapshot", topic=camera.topic, token=TOKEN)
    subprocess.run([curl, "-sf", "-o", path, url], check=True, timeout=support.DEADLINE)
    assert cv2.imread(str(path)).shape == (48, 64, 3)


@contextlib.contextmanager
def filming(camera):
    """Sends an image ten times a second: ffmpeg looks at some before it shows the first."""
    ended, numbers = threading.Event(), itertools.count(100)

    def send():
        while not ended.wait(0.1):
            camera.send(pattern(level=240), secs=next(numbers))

    sender = threading.Thread(target=send)
    sender.start()
    try:
        yield
    finally:
        ended.set()
        sender.join()


def test_opencv_reads_a_stream(dashboard, camera):
    with filming(camera):
        url = dashboard.url("/stream", topic=camera.topic, token=TOKEN)
        capture = cv2.VideoCapture(url, cv2.CAP_FFMPEG)
        good, image = capture.read()
        while good and image[5, 5, 0] < 230:  # that of before
            good, image = capture.read()
        capture.release()
    assert good and image.shape == (48, 64, 3)


def test_a_browser_shows_a_stream(dashboard, camera, tmp_path):
    if missing():
        pytest.skip(missing())
    script = """
        const image = document.querySelector("img");
        if (!image || !image.naturalWidth) return null;
        const canvas = document.createElement("canvas");
        canvas.width = image.naturalWidth; canvas.height = image.naturalHeight;
        const context = canvas.getContext("2d");
        context.drawImage(image, 0, 0);
        const data = context.getImageData(5, 5, 1, 1).data;
        return JSON.stringify([image.naturalWidth, image.naturalHeight, data[0]]);
    """

    with running(tmp_path, loads="none") as browser:  # the page of a stream never ends loading

        def shown():
            return json.loads(browser.driver.execute_script(script) or "[0, 0, 0]")

        browser.driver.get(dashboard.url("/stream_viewer", topic=camera.topic, token=TOKEN))
        support.wait_for(lambda: shown()[:2] == [64, 48], "the image")
        assert abs(shown()[2] - 200) < 6
        camera.send(pattern(level=90), secs=78)
        support.wait_for(lambda: abs(shown()[2] - 90) < 6, "the next image")
