"""What tornado and the server log goes to the node's log: rarely, and safe to print."""

import logging

import pytest
import rospy

from robot_vision.dashboard.log_bridge import LOGGERS, log_through_ros


@pytest.fixture
def logged(monkeypatch):
    """What the node logs; the loggers are as before at the end."""
    found = []
    for level in ("warn", "err"):
        monkeypatch.setattr(
            rospy,
            "log" + level,
            lambda text, *values, level=level: found.append((level, text % values)),
        )
    loggers = [logging.getLogger(name) for name in LOGGERS]
    before = [(one.handlers, one.propagate, one.level) for one in loggers]
    log_through_ros()
    yield found
    for logger, (handlers, propagate, level) in zip(loggers, before):
        logger.handlers, logger.propagate = handlers, propagate
        logger.setLevel(level)


@pytest.mark.parametrize("name", ["dashboard", "tornado.general", "tornado.application", "asyncio"])
def test_warnings_and_errors_are_logged_by_the_node_once_in_a_while(logged, capfd, name):
    logger = logging.getLogger(name)
    for number in range(100):
        logger.debug("a detail %d", number)
        logger.info("a request %d", number)
        logger.warning("odd %d", number)
        logger.error("wrong %d", number)
    assert logged == [("warn", "dashboard: odd 0"), ("err", "dashboard: wrong 0")]
    assert capfd.readouterr() == ("", "")


def test_a_traceback_keeps_its_lines_and_nothing_controls_a_terminal(logged):
    try:
        raise RuntimeError("\x1b[2J\x07 of a client" + "x" * 10000)
    except RuntimeError:
        logging.getLogger("tornado.application").exception("GET /\x1b]0;\x07")
    ((level, text),) = logged
    lines = text.splitlines()
    assert level == "err" and len(text) < 5000
    assert lines[1] == "Traceback (most recent call last):" and len(lines) > 3
    assert all(line.isprintable() for line in lines)
