"""The lines that all nodes log, as they come on /rosout."""

import contextlib
from typing import Any, Callable, NamedTuple

from rosgraph_msgs.msg import Log

from ..common.plain_text import printable
from ..ros.graph_master import MasterCalls
from .encoding import to_json
from .message_topics import RawMessage, RawTopic

TOPIC = "/rosout"
AGGREGATED = "/rosout_agg"  # the same from one publisher, the node rosout of roscore
MAX_TEXT = 4096  # characters of a line
MAX_NAME = 255  # characters of other texts
LEVELS = (Log.DEBUG, Log.INFO, Log.WARN, Log.ERROR, Log.FATAL)


class LogLine(NamedTuple):
    """A line of the log, all of it text that can be shown; other lines of the text are spaces."""

    stamp: float  # s
    level: int  # one of LEVELS
    node: str
    text: str
    function: str
    file: str
    line: int

    @property
    def size(self) -> int:
        """How many bytes it has as JSON, where a letter that is not ASCII has 6 to 12."""
        return len(to_json(self._asdict()))


class LogTopic(RawTopic):
    """Calls a function with each LogLine, from now on, in a thread of rospy.

    Raises:
        OSError: The master does not answer.
    """

    def __init__(self, callback: Callable[[LogLine], Any]):
        self._take = callback
        with contextlib.closing(MasterCalls()) as master:
            publishers = master.call("getSystemState")[0]
        gathered = any(topic == AGGREGATED for topic, _ in publishers)
        super().__init__(AGGREGATED if gathered else TOPIC, self._on_line)

    def _on_line(self, raw: RawMessage) -> None:
        message = raw.decoded()
        if isinstance(message, Log):
            self._take(line_of(message))


def line_of(message: Any) -> LogLine:
    """Returns a rosgraph_msgs/Log as a LogLine; an unknown level is the next lower one."""
    known = [level for level in LEVELS if level <= message.level]
    return LogLine(
        message.header.stamp.to_sec(),
        max(known, default=LEVELS[0]),
        printable(message.name, MAX_NAME),
        printable(message.msg.replace("\n", " ").rstrip(), MAX_TEXT),
        printable(message.function, MAX_NAME),
        printable(message.file, MAX_NAME),
        message.line,
    )
