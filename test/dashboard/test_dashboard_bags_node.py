"""Bags of the dashboard: recorded, listed, downloaded and deleted by pages."""

import contextlib
import http.client
import os
import re
import signal
import subprocess
import threading

import numpy as np
import pytest
import rosbag
import rospy
import support
from frames import message
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import String
from tool_pages import VIEW_TOKEN, ToolServer

from robot_vision.dashboard import bag_download, bag_recorder, bag_recording
from robot_vision.dashboard.bag_feature import BagFeature
from robot_vision.dashboard.settings import Settings

TOPIC = "/texts"


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "bags"


@pytest.fixture
def server(folder):
    made = ToolServer(BagFeature(Settings(bag_folder=str(folder), max_bag_size=100)))
    yield made
    made.close()


@pytest.fixture
def page(server):
    return server.page()


@pytest.fixture
def texts():
    """Publishes numbered texts, one after the other, until the end of the test."""
    ended = threading.Event()
    publisher = rospy.Publisher(TOPIC, String, queue_size=100)

    def publish():
        number = 0
        # rosbag's queue has room for ten seconds of them, should it have to wait.
        while not ended.wait(0.1):
            if publisher.get_num_connections():
                publisher.publish(f"{number} " + "x" * 20000)
                number += 1

    thread = threading.Thread(target=publish)
    thread.start()
    yield
    ended.set()
    thread.join()
    publisher.unregister()


def record(page, **fields):
    """Records until some messages are there; the status then."""
    page.request("bags")
    page.request("bag_record", **{"topics": [TOPIC], "name": "a", **fields})
    return page.wait("recording", lambda status: (status["messages"] or 0) >= 10, "10 messages")


def get(server, path, token=None, method="GET", **headers):
    """The status, the headers and the content of an answer."""
    url = server.url(path, **({"token": token} if token is not None else {}))
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=support.DEADLINE)
    with contextlib.closing(connection):
        connection.request(method, url.split(str(server.port), 1)[1], headers=headers)
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read()


def test_a_bag_is_recorded_listed_downloaded_and_deleted(server, page, folder, texts):
    status = record(page, name="my first bag")
    assert status["name"] == "my_first_bag.bag" and status["state"] == "recording"
    assert status["topics"] == [{"name": TOPIC, "count": status["messages"]}]
    assert page.request("bags")["recording"]["name"] == "my_first_bag.bag"
    assert page.request("bags")["bags"] == page.request("bags")["unfinished"] == []
    page.request("bag_stop")
    end = page.wait("recording", lambda status: not status["active"], "the end")
    (bag,) = page.request("bags")["bags"]
    assert end["state"] == "stopped" and end["size"] == bag["size"]
    with rosbag.Bag(str(folder / "my_first_bag.bag")) as truth:
        numbers = [int(message.data.split()[0]) for _, message, _ in truth.read_messages(TOPIC)]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    assert bag["topics"] == [{"name": TOPIC, "type": "std_msgs/String", "count": len(numbers)}]
    assert end["messages"] == len(numbers) >= 10

    code, headers, content = get(server, "/bags/my_first_bag.bag")
    assert (code, content) == (200, (folder / "my_first_bag.bag").read_bytes())
    assert headers["Content-Disposition"] == 'attachment; filename="my_first_bag.bag"'
    assert headers["Content-Type"] == "application/octet-stream"
    other = server.page()
    other.request("bags")
    page.request("bag_delete", name="my_first_bag.bag")
    assert page.request("bags")["bags"] == [] and os.listdir(folder) == []
    other.wait("bags", lambda data: data == {"deleted": "my_first_bag.bag"}, "the other is told")


def test_a_page_that_comes_later_sees_the_recording(server, page, texts):
    record(page)
    later = server.page(VIEW_TOKEN)
    assert later.request("bags")["recording"]["name"] == "a.bag"
    later.wait("recording", lambda status: status["active"], "its progress")
    with pytest.raises(ValueError, match=r"a\.bag is being recorded: stop that first"):
        server.page().request("bag_record", topics=[TOPIC])
    with pytest.raises(ValueError, match=r"a\.bag is being recorded: stop that first"):
        page.request("bag_delete", name="a.bag", unfinished=True)
    page.request("bag_stop")
    with pytest.raises(ValueError, match="nothing is being recorded"):
        page.request("bag_stop")


def test_a_recording_without_messages_says_so(page, folder):
    page.request("bags")
    page.request("bag_record", topics=["/nobody/publishes/this"], name="a")
    status = page.wait("recording", lambda status: status["size"] > 0, "a bag")
    assert (status["state"], status["messages"]) == ("no message has come yet", 0)
    page.request("bag_stop")
    (bag,) = page.request("bags")["bags"]
    assert (bag["topics"], bag["duration"]) == ([], 0.0)


def test_a_recording_that_loses_messages_says_so(page, folder, monkeypatch):
    says = "[ WARN] [12.5]: rosbag record buffer exceeded.  Dropping oldest queued message."
    script = f"echo '{says}' >&2; : > a.bag; exec sleep {support.DEADLINE}"
    monkeypatch.setattr(bag_recording, "_command", lambda *_: ["sh", "-c", script])
    page.request("bags")
    page.request("bag_record", topics=[TOPIC], name="a")
    lost = "recording, but messages are lost: the disk is too slow"
    page.wait("recording", lambda status: status["state"] == lost, "the loss")
    page.request("bag_stop")
    end = page.wait("recording", lambda status: not status["active"], "the end")
    assert end["state"] == "stopped; messages were lost, as the disk was too slow"


@pytest.fixture
def images():
    """Publishes images by topic; beside each their transports, which send nothing."""
    ended = threading.Event()
    pixels = np.arange(12, dtype=np.uint16).reshape(3, 4) + 1
    sent = {
        "/stereo/disparity_image": ("bgr8", np.full((3, 4, 3), 200, np.uint8)),
        "/segmenter/labels": ("mono16", pixels),
        "/eye/depth/image_raw": ("16UC1", pixels * 100),
    }
    publishers = {name: rospy.Publisher(name, Image, queue_size=5) for name in sent}
    beside = [
        rospy.Publisher(f"{name}/{form}", CompressedImage, queue_size=5)
        for name in sent
        for form in ("compressed", "compressedDepth")
    ]

    def publish():
        while not ended.wait(0.1):
            for name, (encoding, image) in sent.items():
                publishers[name].publish(message(image, encoding))

    thread = threading.Thread(target=publish)
    thread.start()
    yield {name: image for name, (_, image) in sent.items()}
    ended.set()
    thread.join()
    for publisher in (*publishers.values(), *beside):
        publisher.unregister()


def test_images_are_recorded_in_the_form_that_keeps_them(page, folder, images):
    page.request("bags")
    page.request("bag_record", images=[*images, "/nobody/depth"], topics=["/clock"], name="a")
    status = page.wait("recording", lambda status: (status["messages"] or 0) >= 3, "messages")
    recorded = [topic["name"] for topic in status["topics"]]
    assert recorded == [
        "/stereo/disparity_image/compressed",
        "/segmenter/labels",
        "/eye/depth/image_raw/compressedDepth",
        "/nobody/depth",
        "/clock",
    ]
    page.request("bag_stop")
    with rosbag.Bag(str(folder / "a.bag")) as bag:
        kept = next(iter(bag.read_messages("/segmenter/labels"))).message
    assert np.array_equal(
        np.frombuffer(kept.data, "<u2").reshape(3, 4), images["/segmenter/labels"]
    )


def test_topics_of_which_nothing_has_come_are_named_at_the_end(page, folder, texts):
    silent = [f"/silent_{number}" for number in range(7)]
    record(page, topics=[TOPIC, *silent])
    page.request("bag_stop")
    end = page.wait("recording", lambda status: not status["active"], "the end")
    named = ", ".join(silent[: bag_recording.MAX_NAMED])
    assert end["state"] == f"stopped; nothing has come on {named} and 2 more"


def test_it_stops_at_its_size(page, folder, texts):
    page.request("bags")
    page.request("bag_record", topics=[TOPIC], name="a", max_megabytes=1)
    status = page.wait("recording", lambda status: not status["active"], "the end")
    assert status["state"] == "stopped at the limit of 1 MB"
    assert status["size"] >= 10**6 and os.listdir(folder) == ["a.bag"]


def test_it_stops_at_its_time(page, folder, texts):
    page.request("bags")
    page.request("bag_record", topics=[TOPIC], name="a", max_seconds=10)
    status = page.wait("recording", lambda status: not status["active"], "the end")
    assert status["state"] == "stopped after 10 s, as wanted" and status["seconds"] >= 10.0
    assert os.listdir(folder) == ["a.bag"]


def test_it_stops_before_the_disk_is_full(page, folder, texts, monkeypatch):
    free = [bag_recording.MIN_FREE * 3]
    monkeypatch.setattr(bag_recorder.BagFolder, "free_space", lambda self: free[0])
    record(page)
    free[0] = 480 * bag_recording.MB
    status = page.wait("recording", lambda status: not status["active"], "the end")
    assert status["state"] == "stopped, for the disk has only 480 MB left"
    assert os.listdir(folder) == ["a.bag"]
    with pytest.raises(ValueError, match="the disk has only 480 MB left, must have 1000"):
        page.request("bag_record", topics=[TOPIC])


def recorder_process(folder):
    """The process id of the program that records into the folder."""
    found = subprocess.run(
        ["pgrep", "-f", "record.*__name:=test_recorder"], capture_output=True, text=True
    ).stdout.split()
    own = [number for number in found if os.path.realpath(f"/proc/{number}/cwd") == str(folder)]
    assert len(own) == 1
    return int(own[0])


def test_a_killed_recording_is_not_offered_but_named_with_what_to_do(page, folder, texts):
    record(page)
    os.kill(recorder_process(folder), signal.SIGKILL)
    status = page.wait("recording", lambda status: not status["active"], "the end")
    assert status["state"].startswith("failed: ") and "rosbag reindex may help" in status["state"]
    listed = page.request("bags")
    assert (listed["bags"], listed["unfinished"], listed["recording"]) == ([], ["a.bag"], None)
    page.request("bag_delete", name="a.bag", unfinished=True)
    assert os.listdir(folder) == []


def test_a_killed_node_leaves_a_whole_bag(start, tmp_path, folder, texts):
    """The program that records finishes the bag when the node that has started it is gone."""
    script = tmp_path / "recording_node.py"
    script.write_text(
        "import rospy\n"
        "from robot_vision.dashboard.bag_files import BagFolder\n"
        "from robot_vision.dashboard.bag_recorder import BagRecorder\n"
        "rospy.init_node('killed')\n"
        f"recorder = BagRecorder(BagFolder({str(folder)!r}), lambda status: "
        "print('messages', status['messages'], flush=True))\n"
        f"recorder.start([{TOPIC!r}], 'a', 1 << 30, 0.0)\n"
        "rospy.spin()\n"
    )
    process = start("/usr/bin/python3", script)
    support.wait_for(lambda: re.search(r"messages \d\d", process.output()), "10 messages")
    os.kill(process.pid, signal.SIGKILL)
    support.wait_for(lambda: os.listdir(folder) == ["a.bag"], "a whole bag")
    with rosbag.Bag(str(folder / "a.bag")) as bag:
        assert bag.get_message_count() >= 10


def test_an_end_of_the_feature_ends_the_recording(server, page, folder, texts):
    record(page)
    server.close()
    support.wait_for(lambda: os.listdir(folder) == ["a.bag"], "a whole bag")


@pytest.mark.parametrize(
    "fields, reason",
    [
        ({"topics": []}, "0 topics are chosen, must be 1 to 200"),
        ({"topics": ["texts"]}, "'texts' is no name of a node or a topic"),
        ({"topics": ["-a"]}, "'-a' is no name"),
        ({"topics": ["/a __name:=b"]}, "'/a __name:=b' is no name"),
        ({"topics": ["/a\n"]}, "must be a text of at most 256 printable letters"),
        ({"topics": ["/a"] * 201}, "must be a list of at most 200 texts"),
        ({"topics": "/a"}, "must be a list of at most 200 texts"),
        ({"topics": ["/a"], "name": "x\0"}, "must be a text of at most 256 printable letters"),
        ({"topics": ["/a"], "max_megabytes": 101}, "max_megabytes is 101, must be from 1 to 100"),
        ({"topics": ["/a"], "max_megabytes": 0}, "max_megabytes is 0, must be from 1 to 100"),
        ({"topics": ["/a"], "max_seconds": -1}, "max_seconds is -1, must be from 0 to 86400"),
    ],
)
def test_recordings_that_cannot_be_are_refused(page, folder, fields, reason):
    with pytest.raises(ValueError) as error:
        page.request("bag_record", **fields)
    assert reason in str(error.value)
    assert not folder.exists() and page.request("bags")["recording"] is None


def test_the_role_view_sees_bags_and_does_nothing_with_them(server, page, folder, texts):
    record(page)
    page.request("bag_stop")
    viewer = server.page(VIEW_TOKEN)
    assert [bag["name"] for bag in viewer.request("bags")["bags"]] == ["a.bag"]
    for op, fields in [
        ("bag_record", {"topics": [TOPIC]}),
        ("bag_stop", {}),
        ("bag_delete", {"name": "a.bag"}),
    ]:
        with pytest.raises(ValueError, match=f"{op} needs the role control"):
            viewer.request(op, **fields)
    for token in (VIEW_TOKEN, "wrong-token", ""):
        code, _, content = get(server, "/bags/a.bag", token)
        assert code == 403 and b"ROSBAG" not in content
    assert get(server, "/bags/a.bag", **{"Host": "evil.example"})[0] == 403
    assert os.listdir(folder) == ["a.bag"]


@pytest.mark.parametrize(
    "path",
    [
        "/bags/../outside.bag",
        "/bags/..%2foutside.bag",
        "/bags/%2e%2e%2foutside.bag",
        "/bags/..%5coutside.bag",
        "/bags/%2fetc%2fpasswd",
        "/bags//etc/passwd",
        "/bags/link.bag",
        "/bags/missing.bag",
        "/bags/a.bag.active",
        "/bags/a.bag%00",
        "/bags/a.bag%0d%0aX: y",
        "/bags/",
        "/bags",
    ],
)
def test_nothing_outside_of_the_folder_is_given(server, folder, tmp_path, path):
    folder.mkdir()
    (tmp_path / "outside.bag").write_text("secret")
    (folder / "link.bag").symlink_to(tmp_path / "outside.bag")
    (folder / "a.bag.active").write_text("secret")
    code, headers, content = get(server, path.replace(" ", "%20"))
    assert code in (400, 404) and b"secret" not in content and b"root" not in content
    assert "X" not in headers and len(content) < 1000


def test_a_reader_who_waits_costs_no_memory_and_others_are_served(server, page, folder):
    folder.mkdir()
    size = 64 << 20
    with open(folder / "large.bag", "wb") as file:
        file.truncate(size)
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=support.DEADLINE)
    with contextlib.closing(connection):
        connection.request("GET", server.url("/bags/large.bag").split(str(server.port), 1)[1])
        answer = connection.getresponse()
        assert answer.read(1000) == bytes(1000)
        before = resident()
        assert page.request("bags")["bags"][0]["size"] == size
        assert resident() - before < 16 << 20
        assert len(answer.read()) == size - 1000


def resident():
    """Bytes of memory of this process, in which the server runs."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")


def test_downloads_have_a_limit(server, folder, monkeypatch):
    monkeypatch.setattr(bag_download, "MAX_DOWNLOADS", 0)
    folder.mkdir()
    (folder / "a.bag").write_bytes(b"x")
    code, _, content = get(server, "/bags/a.bag")
    assert code == 503 and b"0 bags are being downloaded" in content
