"""What is said of a network while it runs, and when it fails."""

import pytest
import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from still_clock import StillClock

from robot_vision.dnn import network_report
from robot_vision.dnn.network_report import NetworkReport


class Topic:
    """Takes the place of a StatusTopic, and has what was published last."""

    def __init__(self, _name):
        self.last = None

    def publish(self, made):
        self.last = made()


@pytest.fixture
def report(monkeypatch):
    monkeypatch.setattr(network_report, "StatusTopic", Topic)
    return NetworkReport({"model": "a.onnx"})


@pytest.fixture
def logged(monkeypatch):
    lines = []
    monkeypatch.setattr(rospy, "logerr", lambda text, *values: lines.append(text % values))
    return lines


def status_of(report):
    report.publish()
    return report._status.last


def test_a_failure_is_logged_and_is_an_error_of_the_status(report, logged):
    report.add_run(0.25)
    level, text, values = status_of(report)
    assert (level, text) == (DiagnosticStatus.OK, "250.0 ms for a frame")
    assert (values["model"], values["frames looked at"], values["failures"]) == ("a.onnx", "1", "0")
    report.add_failure(RuntimeError("no\nmemory"))
    report.add_failure(KeyError())
    assert logged == ["the network has failed, the next frame is tried: no\\nmemory"]
    level, text, values = status_of(report)
    assert (level, text) == (DiagnosticStatus.ERROR, "the network has failed: KeyError")
    assert values["failures"] == "2"


def test_a_failure_counts_until_a_run_succeeds_and_a_while_longer(report, logged, monkeypatch):
    monkeypatch.setattr(network_report, "RECENT", 0.0)
    assert status_of(report)[:2] == (
        DiagnosticStatus.OK,
        "the network has not looked at a frame yet",
    )
    report.add_failure(RuntimeError("no memory"))
    failed = DiagnosticStatus.ERROR, "the network has failed: no memory"
    assert status_of(report)[:2] == failed
    report.add_run(0.25)
    assert status_of(report)[0] == DiagnosticStatus.OK
    monkeypatch.setattr(network_report, "RECENT", float("inf"))
    assert status_of(report)[:2] == failed


def test_what_fails_because_the_node_ends_is_not_logged(report, logged, monkeypatch):
    monkeypatch.setattr(rospy.core, "is_shutdown_requested", lambda: True)
    report.add_failure(rospy.ROSException("publish() to a closed topic"))
    assert logged == []


def test_a_run_that_does_not_end_is_told(report, monkeypatch):
    clock = StillClock()
    monkeypatch.setattr(network_report, "time", clock)
    report.add_run(0.2)
    with report.running():
        clock.now += 4.0
        assert status_of(report)[:2] == (DiagnosticStatus.OK, "200.0 ms for a frame")
        clock.now += 2.0
        assert status_of(report)[:2] == (DiagnosticStatus.WARN, "a frame takes 6 s already")
    assert status_of(report)[:2] == (DiagnosticStatus.OK, "200.0 ms for a frame")


def test_a_network_that_is_always_slow_is_not_slower_than_it_is(report, monkeypatch):
    clock = StillClock()
    monkeypatch.setattr(network_report, "time", clock)
    report.add_run(2.0)
    with report.running():
        clock.now += 19.0
        assert status_of(report)[0] == DiagnosticStatus.OK
        clock.now += 2.0
        assert status_of(report)[0] == DiagnosticStatus.WARN


def test_runs_that_are_farther_apart_than_things_are_remembered_are_told(report):
    report.add_run(3.25)
    assert status_of(report)[0] == DiagnosticStatus.OK
    report.max_age = 3.0
    said = "nothing can be followed: runs are 3.2 s apart, and max_age is 3"
    assert status_of(report)[:2] == (DiagnosticStatus.WARN, said)
    report.period, report.max_age = 10.0, 4.0
    said = "nothing can be followed: runs are 10.0 s apart, and max_age is 4"
    assert status_of(report)[:2] == (DiagnosticStatus.WARN, said)
