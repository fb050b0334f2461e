"""Where the address with its token goes when what the dashboard prints is kept in a log."""

import os
import stat

import pytest

from robot_vision.dashboard.private_address import is_kept, write_address


@pytest.fixture(autouse=True)
def folders(monkeypatch, tmp_path):
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "log"))
    monkeypatch.delenv("JOURNAL_STREAM", raising=False)


@pytest.mark.parametrize("name, kept", [("log/run/a-1-stdout.log", True), ("logs.txt", False)])
def test_log_files_of_roslaunch_are_kept(tmp_path, name, kept):
    path = tmp_path / name
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w") as file:
        assert is_kept(file.fileno()) == kept


def test_the_journal_is_kept_and_another_pipe_is_not(monkeypatch):
    ends = os.pipe()
    others = os.pipe()
    status = os.fstat(ends[1])
    assert not is_kept(ends[1])
    monkeypatch.setenv("JOURNAL_STREAM", f"{status.st_dev}:{status.st_ino}")
    assert is_kept(ends[1]) and not is_kept(others[1])
    for end in (*ends, *others):
        os.close(end)


def test_the_address_is_for_its_user_alone_also_where_a_file_or_a_link_was(tmp_path):
    path, other = tmp_path / "vision_dashboard_address.txt", tmp_path / "other"
    other.write_text("stays")
    path.symlink_to(other)
    for text in ("first\n", "second\n"):
        assert write_address("/vision/dashboard", text) == str(path)
        assert path.read_text() == text and other.read_text() == "stays"
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        path.chmod(0o644)
