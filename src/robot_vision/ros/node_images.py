"""The images of each node of this process, and the thread that calls their callbacks.

roscpp receives and publishes them, as one node for the whole process, into which C++ nodelets can
be loaded, too. The thread also works through the messages that rospy receives: rospy calls all who
listen to a topic one after the other, so that a node that works there would hold up the others.
"""

import atexit
import functools
import math
import sys
import threading
import time
import traceback
import weakref
from typing import Any, Callable, Dict, List, Optional, Tuple

import rospy

from .. import _transport
from ..common.files import ROS_HOME_NEEDED
from ..common.throttle import Throttle
from .context import current
from .listeners import IMAGES
from .registration import keep_registered

END_TIMEOUT = 1.0  # s that the end of a node waits for a callback that is running
PERIOD = 1.0  # s that the thread waits for images, and until a listener that failed is called again

Deliver = Callable[..., Any]  # is called with what Queue.next() gives behind the inbox


def node_images() -> "NodeImages":
    """Returns the images of the current node, whose thread is started when it is first needed."""
    return current().part(NodeImages)


def process_runtime() -> _transport.Runtime:
    """Returns the roscpp node of this process, which is started when it is first needed."""
    return _process().runtime


class NodeImages:
    """The queue of a node's images, and the thread that works through it."""

    def __init__(self) -> None:
        self.context = current()
        self._stopped = False
        # Each change of these two is a single step that the GIL makes atomic.
        self.subscribers: Dict[_transport.Inbox, Deliver] = {}
        self.listeners: List[Callable[[], Any]] = []
        self._messages_lock = threading.Lock()  # guards the following
        self._messages: Dict[Tuple[Callable[[Any], Any], int], Any] = {}  # by who takes and sends
        self._next_attempt = math.inf  # s of the monotonic clock, after a listener has failed
        self._failure_throttle = Throttle()
        name = self.context.name
        diagnostics = self.context.resolve("/diagnostics")
        self._process = _process()
        self.queue = self._process.runtime.queue(name, diagnostics)
        self._thread = self.context.thread(self._run, f"images of {name}")
        self._thread.start()  # before the hook, which is called at once after a shutdown of rospy
        self._process.nodes.add(self)
        self.context.on_closing(self.stop)
        if self.context.is_ending():
            self.stop()

    def note(self, take: Callable[[Any], Any], message: Any) -> None:
        """Has the thread call `take` with the newest message of each sender. Thread-safe."""
        sender = id(getattr(message, "_connection_header", None))  # one object per connection
        with self._messages_lock:
            self._messages[take, sender] = message
        self.queue.interrupt()

    def stop(self, timeout: float = END_TIMEOUT) -> None:
        """Closes all images of the node; a callback that never returns is left behind."""
        if self._stopped:  # At the end of a process there is another call, which need not wait.
            return
        self._stopped = True
        self.queue.close()
        if threading.current_thread() is not self._thread:
            self._thread.join(timeout)

    def _run(self) -> None:
        try:
            while self.queue.running():
                self._call(self._work)
            if not self._stopped and not self._process.stopped:
                rospy.signal_shutdown("the node of its images was shut down")
        except SystemExit:  # Only in the main thread would it end the process.
            self.context.exit("a callback has called sys.exit()")

    def _work(self) -> None:
        taken = self.queue.next(PERIOD)
        if time.monotonic() >= self._next_attempt or (
            taken is None and self.queue.connections_changed()
        ):
            self._call_listeners()
        self._take_messages()
        if taken is None:
            return
        inbox, *frame = taken
        deliver = self.subscribers.get(inbox)
        if deliver is not None:  # Otherwise it was unregistered a moment ago.
            deliver(*frame)

    def _take_messages(self) -> None:
        with self._messages_lock:
            messages, self._messages = self._messages, {}
        for (take, _), message in messages.items():
            self._call(functools.partial(take, message))

    def _call_listeners(self) -> None:
        """Tells of connections, and once more in a while if a listener cannot subscribe now."""
        self._next_attempt = math.inf
        for listener in list(self.listeners):
            try:
                listener()
            except Exception:
                self._next_attempt = time.monotonic() + PERIOD
                if self._failure_throttle.due():
                    rospy.logerr("a callback failed:\n%s", traceback.format_exc())

    @staticmethod
    def _call(function: Callable[[], Any]) -> None:
        """Calls a function, and logs the exception if it raises one."""
        try:
            function()
        except Exception:
            rospy.logerr("a callback failed:\n%s", traceback.format_exc())


class _Process:
    """The roscpp node inside this process."""

    def __init__(self) -> None:
        options = {
            name: value
            for name, value in rospy.names.load_mappings(sys.argv).items()
            if name.startswith("__") and name not in ("__name", "__ns")
        }
        options["/diagnostics"] = rospy.resolve_name("/diagnostics")
        node, uri = rospy.names.get_name(), rospy.get_node_uri()
        try:
            self.runtime = _transport.Runtime(node + IMAGES, options, node, uri)
        except RuntimeError as error:  # A folder that roscpp needs cannot be made.
            raise ValueError(f"{error}; {ROS_HOME_NEEDED}") from None
        keep_registered()
        self.stopped = False
        self.nodes: weakref.WeakSet[NodeImages] = weakref.WeakSet()
        # This hook runs after those of the node, which may publish a last image.
        rospy.core.add_preshutdown_hook(lambda _reason: self.stop())
        # For a process that never shuts rospy down: atexit calls the newest function first.
        atexit.register(self.stop)

    def stop(self) -> None:
        """Ends the roscpp node, and with it the images of all nodes."""
        self.stopped = True
        self.runtime.stop()
        deadline = time.monotonic() + END_TIMEOUT
        for images in list(self.nodes):
            images.stop(max(0.0, deadline - time.monotonic()))


_the_process: Optional[_Process] = None
_the_process_lock = threading.Lock()


def _process() -> _Process:
    global _the_process
    with _the_process_lock:
        if _the_process is None:
            if not rospy.core.is_initialized():
                raise rospy.ROSInitException("call rospy.init_node() first")
            _the_process = _Process()
        return _the_process
