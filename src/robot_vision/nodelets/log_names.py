"""Has rospy log under the name of the node for which a thread works, not that of its process."""

import logging
import threading
from typing import Any

import rospy
import rospy.core
import rospy.impl.rosout
from rosgraph_msgs.msg import Log

from ..ros.context import current

LEVELS = {
    logging.DEBUG: Log.DEBUG,
    logging.INFO: Log.INFO,
    logging.WARNING: Log.WARN,
    logging.ERROR: Log.ERROR,
    logging.CRITICAL: Log.FATAL,
}


def log_by_node() -> None:
    """Makes it so in this process, for the console, /rosout, and what rospy logs only once."""
    logger = logging.getLogger("rosout")
    for handler in logger.handlers[:]:
        if isinstance(handler, rospy.impl.rosout.RosOutHandler):
            logger.removeHandler(handler)
            logger.addHandler(_RosOutHandler())
    rospy.get_name = lambda: current().name  # The handler of the console asks it for ${node}.
    place = rospy.core._frame_to_caller_id
    rospy.core._frame_to_caller_id = lambda frame: place(frame) + current().name.encode()


class _RosOutHandler(logging.Handler):
    """Publishes what is logged; as publishing may log, not what comes of that."""

    def __init__(self) -> None:
        super().__init__()
        self._publishing = threading.local()

    def emit(self, record: logging.LogRecord) -> None:
        publisher: Any = rospy.impl.rosout._rosout_pub
        if publisher is None or getattr(self._publishing, "now", False):
            return
        self._publishing.now = True
        try:
            message = Log(
                level=LEVELS[record.levelno],
                name=current().name,
                msg=self.format(record),
                file=record.filename,
                line=record.lineno,
                function=record.funcName,
            )
            message.header.stamp = rospy.Time.now()
            publisher.publish(message)
        except rospy.ROSException:  # The process ends.
            pass
        finally:
            self._publishing.now = False
