"""Drive stops the robot by the age of what was seen, however long it was worked on."""

import pytest

from robot_vision.line import drive


class Robot:
    """A drive with a watch that the test sets, and what it sends."""

    def __init__(self, monkeypatch):
        self.now = 100.0  # s
        self.sent = []
        monkeypatch.setattr(drive.time, "monotonic", lambda: self.now)
        monkeypatch.setattr(drive.rospy, "Service", lambda *_: None)
        monkeypatch.setattr(drive.rospy, "on_shutdown", lambda _: None)
        monkeypatch.setattr(drive.threading.Thread, "start", lambda _: None)
        monkeypatch.setattr(drive.time, "sleep", self._sleep)
        self.drive = drive.Drive(self, timeout=10.0)

    def publish(self, twist):
        self.sent.append(twist.linear.x)

    def watch(self, until):
        """What the watchdog sends until then."""
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


def test_stops_a_timeout_after_it_was_seen(robot):
    robot.drive.command(0.2, 0.0, seen=robot.now - 8.9)
    assert robot.sent == [0.2]
    assert robot.watch(until=101.0) == []
    assert set(robot.watch(until=101.3)) == {0.0}


def test_what_has_become_too_old_meanwhile_is_not_driven_on(robot):
    robot.drive.command(0.2, 0.0, seen=robot.now - 10.1)
    assert robot.sent == []
    assert set(robot.watch(until=101.0)) == {0.0}


def test_a_time_to_come_counts_as_now(robot):
    robot.drive.command(0.2, 0.0, seen=robot.now + 5.0)
    assert robot.watch(until=109.9) == []
    assert set(robot.watch(until=110.2)) == {0.0}


def test_drives_only_while_it_is_enabled(robot):
    robot.drive.enabled = False
    robot.drive.command(0.2, 0.0, seen=robot.now)
    assert robot.sent == []
    assert set(robot.watch(until=101.0)) == {0.0}
