"""A node of this package that was loaded into the process of a manager."""

import threading
import traceback
from typing import Any, Callable, Dict, Optional

import rospy

from ..common.plain_text import error_text
from ..ros.context import LoadedContext, active
from ..ros.registration import keep_registered
from .node_types import NodeType


class LoadedNode:
    """Holds a node's context, and the object that is the node.

    Args:
        name: The node's name, which begins with a slash.
        remappings: Names by names, both resolved.
        on_exit: A function that is called, in a thread of its own, when the node wants to end.
    """

    def __init__(self, name: str, remappings: Dict[str, str], on_exit: Callable[[], Any]) -> None:
        self.name = name
        self._on_exit = on_exit
        self._context = LoadedContext(name, remappings, self._exit)
        self._lock = threading.Lock()  # held while it starts or ends
        self._finish_lock = threading.Lock()  # held while it finishes, which needs its topics
        self._node: Optional[Any] = None

    def start(self, kind: NodeType) -> None:
        """Makes the node.

        Raises:
            ValueError: It cannot be made; all is closed again, and the reason is in its log, unless
                that is the end of the process.
        """
        with self._lock, active(self._context):
            try:
                self._node = kind.load()()
                if self._context.is_ending():  # What was made last may not have been told yet.
                    self.finish()
            except BaseException as error:
                is_ending = self._context.is_ending()  # then nothing can be made any more
                self.finish()
                self._context.end()
                reason = "it ends" if is_ending else _logged(self.name, error)
                raise ValueError(reason) from None
        keep_registered().check()

    def finish(self) -> None:
        """Has the node, which may be starting, end its work when the process ends.

        All else is closed by then.
        """
        with self._finish_lock:
            self._context.finish()

    def end(self) -> None:
        """Ends the node and closes all that it has made."""
        self.finish()
        with self._lock:
            self._context.end()
            self._node = None

    def _exit(self, reason: str) -> None:
        rospy.logwarn("%s: it ends: %s", self.name, reason)
        threading.Thread(target=self._on_exit, name="unload", daemon=True).start()


def _logged(name: str, error: BaseException) -> str:
    """Logs why a node could not be made as run_node() does, and returns that in one line."""
    if isinstance(error, ValueError):
        rospy.logfatal("%s: %s", name, error)
        return str(error)
    if isinstance(error, SystemExit):
        reason = f"it has called sys.exit({error.code!r})"
        rospy.logfatal("%s: %s", name, reason)
        return reason
    rospy.logfatal("%s: %s", name, traceback.format_exc())
    return error_text(error)
