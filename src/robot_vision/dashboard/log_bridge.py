"""Passes what tornado, asyncio and the dashboard log on to the node's log."""

import logging

import rospy

from ..common.plain_text import printable
from ..common.throttle import Throttle

LOGGERS = ("dashboard", "tornado", "asyncio")
MAX_LENGTH = 4000  # letters of a message, with its traceback


class _Bridge(logging.Handler):
    """Logs warnings and errors, one of each logger and level in some seconds."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._throttles = {level: Throttle() for level in (logging.WARNING, logging.ERROR)}

    def emit(self, record: logging.LogRecord) -> None:
        is_error = record.levelno >= logging.ERROR
        if not self._throttles[logging.ERROR if is_error else logging.WARNING].due():
            return
        text = self.format(record)  # with the traceback, whose lines stay lines
        lines = [printable(line, 500) for line in text[:MAX_LENGTH].splitlines()]
        (rospy.logerr if is_error else rospy.logwarn)("dashboard: %s", "\n".join(lines))


def log_through_ros() -> None:
    """Has the loggers log through rospy only."""
    for name in LOGGERS:
        logger = logging.getLogger(name)
        logger.handlers = [_Bridge()]
        logger.propagate = False
        logger.setLevel(logging.WARNING)
