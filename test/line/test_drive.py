"""Drive stops the robot by the age of the frame, however long its processing takes."""

from unittest.mock import MagicMock

import numpy as np
import pytest
import rospy
from fake_params import use_params
from std_msgs.msg import Header
from std_srvs.srv import SetBoolRequest

from robot_vision.line import drive, line_follower
from robot_vision.ros import live_params, transport


class Robot:
    """A Drive whose clock the test sets, and the commands that it sends."""

    def __init__(self, monkeypatch, params=None):
        self.params = {} if params is None else params
        use_params(monkeypatch, self.params)
        self.now = 100.0  # s
        self.sent = []
        monkeypatch.setattr(drive.time, "monotonic", lambda: self.now)
        monkeypatch.setattr(rospy, "Service", lambda *_: None)
        monkeypatch.setattr(rospy, "on_shutdown", lambda _: None)
        monkeypatch.setattr(drive.threading.Thread, "start", lambda _: None)
        monkeypatch.setattr(drive.time, "sleep", self._sleep)
        self.drive = drive.Drive(self, timeout=10.0)

    def publish(self, twist):
        self.sent.append(twist.linear.x)

    def watch(self, until):
        """The commands that the watchdog sends until then."""
        del self.sent[:]
        self._until = until
        with pytest.raises(StopIteration):
            self.drive._watch()
        return self.sent

    def _sleep(self, seconds):
        self.now += seconds
        if self.now >= self._until:
            raise StopIteration


@pytest.fixture
def robot(monkeypatch):
    return Robot(monkeypatch)


def test_stops_a_timeout_after_the_stamp_of_the_frame(robot):
    assert robot.drive.command(0.2, 0.0, seen=robot.now - 8.9)
    assert robot.sent == [0.2]
    assert robot.watch(until=101.0) == []
    assert set(robot.watch(until=101.3)) == {0.0}


def test_does_not_drive_on_a_frame_that_has_become_too_old(robot):
    assert not robot.drive.command(0.2, 0.0, seen=robot.now - 10.1)
    assert robot.sent == []
    assert set(robot.watch(until=101.0)) == {0.0}


def test_stamp_in_the_future_counts_as_now(robot):
    robot.drive.command(0.2, 0.0, seen=robot.now + 5.0)
    assert robot.watch(until=109.9) == []
    assert set(robot.watch(until=110.2)) == {0.0}


def test_drives_only_while_it_is_enabled(robot):
    robot.drive.enabled = False
    assert robot.drive.command(0.2, 0.0, seen=robot.now)  # which is no fault of the frame
    assert robot.sent == []
    assert set(robot.watch(until=101.0)) == {0.0}


def test_a_robot_that_was_stopped_stays_so_when_the_node_starts_again(robot, monkeypatch):
    robot.drive.command(0.2, 0.0, seen=robot.now)
    assert robot.drive._on_enable(SetBoolRequest(False)).message == "stopped"
    assert robot.sent == [0.2, 0.0]
    warned = MagicMock()
    monkeypatch.setattr(rospy, "logwarn", warned)
    again = Robot(monkeypatch, robot.params)
    warned.assert_called_once_with(
        "stopped by the parameter ~enabled: the service ~enable lets it drive"
    )
    again.drive.command(0.2, 0.0, seen=again.now)
    assert again.sent == []
    assert again.drive._on_enable(SetBoolRequest(True)).message == "driving"
    third = Robot(monkeypatch, robot.params)
    third.drive.command(0.2, 0.0, seen=third.now)
    assert third.sent == [0.2] and warned.call_count == 1


def test_a_robot_stops_although_there_is_no_master(robot, monkeypatch):
    monkeypatch.setattr(rospy, "set_param", MagicMock(side_effect=ConnectionRefusedError))
    assert robot.drive._on_enable(SetBoolRequest(False)).success
    assert robot.sent == [0.0] and not robot.drive.enabled


class Server:
    """Gives the live parameters at start, and changes none."""

    def __init__(self, _config_type, callback, values):
        callback(dict(values), 0)


@pytest.fixture
def follower(monkeypatch):
    """A LineFollower whose Drive only notes commands, 8.9 s after the stamp of frame()."""
    monkeypatch.setattr(line_follower, "Drive", lambda _: MagicMock(enabled=True))
    monkeypatch.setattr(live_params, "_Server", Server)
    monkeypatch.setattr(transport, "node_images", MagicMock())
    for name in ("Publisher", "Service", "get_name"):
        monkeypatch.setattr(rospy, name, MagicMock())
    use_params(monkeypatch, {"~timeout": 10.0})
    monkeypatch.setattr(rospy, "get_time", lambda: 108.9)
    return line_follower.LineFollower()


def frame():
    header = Header(stamp=rospy.Time(100))
    return transport.Frame(np.zeros((48, 64, 3), np.uint8), "bgr8", header, None)


def test_the_follower_saw_a_frame_at_its_stamp_not_when_it_came(follower, monkeypatch):
    monkeypatch.setattr(line_follower.time, "monotonic", lambda: 50.0)
    follower._process(frame())
    ((_, _, seen),) = (call[0] for call in follower._drive.command.call_args_list)
    assert seen == pytest.approx(50.0 - 8.9)


def test_frames_that_become_too_old_while_they_are_processed_are_refused(follower, monkeypatch):
    """So that diagnostics tell why the robot stands."""
    clock = iter(50.0 + 1.2 * np.arange(9.0))
    monkeypatch.setattr(line_follower.time, "monotonic", lambda: next(clock))
    monkeypatch.setattr(rospy, "logwarn_throttle", MagicMock())
    follower._drive.command.return_value = False
    with pytest.raises(transport.ReportedFrameError, match=r"frames are 10\.10 s old: they"):
        follower._process(frame())
    assert follower._lines.publish.call_count == 1
