"""The log and the frames of tf in the dashboard."""

from unittest.mock import Mock

import pytest
import rospy
import support
from feature_page import FeaturePage, Publishers, subscribes
from geometry_msgs.msg import TransformStamped
from rosgraph_msgs.msg import Log
from tf2_msgs.msg import TFMessage

from robot_vision.dashboard.encoding import to_json
from robot_vision.dashboard.frame_feature import FrameFeature
from robot_vision.dashboard.log_feature import MAX_KEPT, MAX_PUSH, LogFeature, newest
from robot_vision.dashboard.log_lines import LogLine
from robot_vision.dashboard.settings import Settings


@pytest.fixture
def features(master):
    made = [LogFeature(Settings()), FrameFeature(Settings())]
    yield made
    for feature in made:
        feature.close()


@pytest.fixture
def page(features):
    made = FeaturePage(*features, role="view")
    yield made
    made.close()


@pytest.fixture
def publish():
    with Publishers() as publishers:
        yield publishers


def line(text, level=Log.WARN, node="/x"):
    message = Log(level=level, name=node, msg=text, file="f.py", function="g", line=3)
    message.header.stamp = rospy.Time(5, 0)
    return message


def texts(page):
    return [entry["text"] for data in page.pushes("log") for entry in data["entries"]]


def test_lines_of_the_log_are_kept_and_pushed(page, features, publish):
    page.request("log", level=4)
    publish.to_reader("/rosout", line("first\nsecond \x1b[31m<b>"))
    publish.to_reader("/rosout", line("not this", Log.INFO))
    publish.to_reader("/rosout", line("third", Log.ERROR))
    support.wait_for(lambda: "third" in texts(page), "the lines")
    assert texts(page) == ["first second \\x1b[31m<b>", "third"]
    entry = page.pushes("log")[0]["entries"][0]
    assert (entry["stamp"], entry["level"], entry["node"]) == (5.0, 4, "/x")
    assert (entry["function"], entry["file"], entry["line"]) == ("g", "f.py", 3)
    later = FeaturePage(*features)
    later.request("log", level=1)
    support.wait_for(lambda: "third" in texts(later), "what was kept")
    assert "not this" in texts(later)
    later.close()
    assert subscribes("/rosout")
    page.request("close_log")
    support.wait_for(lambda: not subscribes("/rosout"), "the end of the subscription")


def test_who_looks_again_and_again_leaves_nothing_behind(page, features):
    for _ in range(20):
        page.request("log")
        page.request("close_log")
    assert not subscribes("/rosout") and len(page.session._on_close) <= 1
    page.request("log")
    page.close()
    support.wait_for(lambda: not subscribes("/rosout"), "the end of the subscription")
    assert not features[0]._known


class _LockWithGap:
    """A lock; once, as soon as it is free, something else happens."""

    def __init__(self, lock, happens):
        self._lock = lock
        self._happens = [happens]

    def __enter__(self):
        self._lock.acquire()

    def __exit__(self, *_):
        self._lock.release()
        if self._happens:
            self._happens.pop()()


def test_who_comes_while_the_last_one_leaves_gets_lines(page, features, publish, monkeypatch):
    page.request("log")
    log = features[0]
    gap = _LockWithGap(log._subscribing, lambda: log._forget(page.session))
    monkeypatch.setattr(log, "_subscribing", gap)
    later = FeaturePage(*features)
    later.request("log")
    assert subscribes("/rosout")
    publish.to_reader("/rosout", line("for the later one"))
    support.wait_for(lambda: "for the later one" in texts(later), "the line")
    later.close()


def test_long_lines_are_cut(page, publish):
    page.request("log")
    publish.to_reader("/rosout", line("x" * 100000))
    support.wait_for(lambda: texts(page), "the line")
    assert len(texts(page)[0]) == 4096


def test_a_push_holds_the_newest_lines_that_fit():
    lines = [LogLine(0.0, 1, "/x", str(index) + "x" * 4000, "", "", 0) for index in range(1000)]
    kept = newest(lines)
    assert kept == lines[-len(kept) :] and 10 < len(kept) < 60


def test_a_push_has_as_many_bytes_as_are_said_in_any_language():
    lines = [LogLine(0.0, 1, "/x", "\U0001f916" * 4000, "", "", 0) for _ in range(100)]
    kept = newest(lines)
    assert kept and len(to_json([line._asdict() for line in kept])) < 1.01 * MAX_PUSH


def transform(parent, child, x):
    made = TransformStamped()
    made.header.frame_id, made.child_frame_id = parent, child
    made.transform.translation.x, made.transform.rotation.w = x, 1.0
    return made


def test_frames_come_in_the_frame_that_was_asked_for(page, publish):
    publish("/tf_static", TFMessage([transform("base", "camera", 0.5)]))
    page.request("frames", channel=9, root="camera", rate=30)
    publish("/tf", TFMessage([transform("map", "base", 2.0)]))
    got = page.wait_for_message(9, lambda data: len(data["frames"]) == 3)["data"]
    assert got["root"] == "camera" and got["roots"] == ["map"]
    places = {frame["name"]: frame["position"][0] for frame in got["frames"]}
    assert places == pytest.approx({"camera": 0.0, "base": -0.5, "map": -2.5})
    page._call(page.session.close_channel, 9)
    support.wait_for(lambda: not subscribes("/tf"), "the end of the subscription")


@pytest.fixture
def log(features, monkeypatch):
    """The feature whose lines a test gives."""
    monkeypatch.setattr("robot_vision.dashboard.log_feature.LogTopic", Mock())
    return features[0]


def test_each_session_is_told_how_many_of_its_lines_are_missing(log):
    all_lines, later, errors = (FeaturePage(log, role="view") for _ in range(3))
    all_lines.request("log", level=1)
    errors.request("log", level=8)
    with log._changed:  # or it would push some before all are there
        for number in range(MAX_KEPT + 10):
            log._on_line(LogLine(0.0, 4 if number % 2 else 8, "/x", str(number), "", "", 0))
    later.request("log", level=1)
    told = [page.wait_for_push("log")["left_out"] for page in (all_lines, later, errors)]
    assert told == [10, 0, 0]
    for page in (all_lines, later, errors):
        page.close()


def test_a_flood_of_lines_does_not_end_the_session_of_a_page_that_reads_slowly(log):
    page = FeaturePage(log, role="view")
    page.request("log")
    page.reads.clear()
    rounds, lines = 20, 2 * MAX_PUSH // 1000
    for turn in range(rounds):
        for number in range(lines):
            log._on_line(LogLine(0.0, 4, "/x", f"{turn} {number} " + "x" * 1000, "", "", 0))
        support.wait_for(
            lambda: not log._readers[page.session].waits or page.session.has_waiting("log"),
            "a push",
        )
    page.session.push("graph", {})
    assert not page.session.closed and page.ended == ()
    page.reads.set()
    last = f"{rounds - 1} {lines - 1} "
    support.wait_for(lambda: texts(page) and texts(page)[-1].startswith(last), "the last line")
    counts = [data["left_out"] + len(data["entries"]) for data in page.pushes("log")]
    assert sum(counts) == rounds * lines
    assert [kind for kind, _ in page.pushed].index("graph") <= 2  # behind few lines
    page.close()
