"""What every node does that works on pictures."""

import time
from typing import Any, Callable, Dict, List, Tuple

import rospy

from .. import set_threads
from . import transport
from .params import read_param, review_params

MOST_THREADS = 256
SILENCE = 5.0  # s without a message, until an input counts as missing


class ImageNode:
    """Works on the topic `image` while somebody subscribes to an output (or ~always_subscribe), or
    as long as keep_working() wants it.

    Counts and refuses frames, and reports on /diagnostics under the node's name. Give it its
    outputs, then start() it.

    Args:
        process: works on a Frame and publishes.
        encoding: that it wants its frames in.
        camera_info: whether frames shall come with their camera_info.
        idle: is called when the work ends, to let go what was kept for it.

    Raises:
        ValueError: a parameter is of the wrong type or out of range.
    """

    def __init__(
        self,
        process: Callable[[transport.Frame], Any],
        encoding: str = "bgr8",
        camera_info: bool = False,
        idle: Callable[[], Any] = lambda: None,
    ):
        self._idle = idle
        self._always = read_param("always_subscribe", False)
        set_threads(read_threads())
        self._wanted = False
        self._outputs: List[Tuple[Any, Callable[[], bool]]] = []  # and whether it counts
        self._inputs: List[Tuple[Any, ...]] = []  # names, types and callbacks
        self._subscribers: List[rospy.Subscriber] = []  # to them, while the node works
        self._came: Dict[
            str, float
        ] = {}  # s of the monotonic clock, when what they bring came last
        self._working_since = float("inf")  # s of the same
        kind = transport.CameraSubscriber if camera_info else transport.ImageSubscriber
        self._images = kind(
            "image",
            self._noting("image", process),
            encoding,
            diagnostics=transport.node_diagnostics(),
            start=False,
        )
        if self._images.topic == "/image":
            rospy.logwarn("topic 'image' is not remapped; typical use is image:=/usb_cam/image_raw")

    @property
    def topic(self) -> str:
        """The topic of the pictures, resolved."""
        return self._images.topic

    def publisher(
        self, name: str, kind: Any, counts: Callable[[], bool] = lambda: True
    ) -> rospy.Publisher:
        """A topic for results, which makes the node work, while it counts."""
        output = rospy.Publisher(name, kind, queue_size=1, subscriber_listener=_Listener())
        self._outputs.append((output, counts))
        return output

    def image_publisher(self, name: str) -> transport.ImagePublisher:
        """A topic for pictures, which makes the node work; draw only if it has connections."""
        output = transport.ImagePublisher(name)
        self._outputs.append((output, lambda: True))
        return output

    def subscriber(self, name: str, kind: Any, callback: Callable[[Any], Any]) -> None:
        """One more topic that is subscribed to while the node works: its newest message."""
        self._inputs.append((name, kind, self._noting(name, callback)))

    def keep_working(self, wanted: bool) -> None:
        """Whether to work although nobody subscribes. Thread-safe."""
        self._wanted = wanted
        transport.note_connections()

    def missing(self, seconds: float = SILENCE) -> str:
        """What the node works without, in words: inputs that were silent for so long. Thread-safe.

        Empty if there are none, or the node does not work.
        """
        now = time.monotonic()
        inputs = [("image", "images", self._images.topic, self._images)]
        for (name, *_), subscriber in zip(self._inputs, self._subscribers):
            inputs.append((name, name, subscriber.resolved_name, subscriber))
        lacking = []
        for name, plural, topic, subscriber in inputs:
            silent = now - max(self._came.get(name, 0.0), self._working_since)
            if silent >= seconds and not subscriber.get_num_connections():
                lacking.append(f"nobody publishes {plural} on {topic}")
            elif silent >= seconds:
                lacking.append(f"no {name} on {topic} for {silent:.0f} s")
        return "; ".join(lacking)

    def no_frame(self, seconds: float) -> str:
        """What to say when none came within this time."""
        nobody = "" if self._images.get_num_connections() else "; nobody publishes there"
        return f"no frame on {self.topic} within {seconds:g} s{nobody}"

    def start(self) -> None:
        """Begins to work; the node has to be complete by now, all its parameters read."""
        review_params()
        transport.add_connection_listener(self._update)
        transport.note_connections()

    def _update(self) -> None:
        """Only the thread of the pictures calls it, so subscribing and ending do not overlap."""
        listened = any(
            counts() and output.get_num_connections() for output, counts in self._outputs
        )
        if self._always or self._wanted or listened:
            self._working_since = min(self._working_since, time.monotonic())
            self._images.start()
            if not self._subscribers:
                self._subscribers = [
                    rospy.Subscriber(name, kind, callback, queue_size=1, tcp_nodelay=True)
                    for name, kind, callback in self._inputs
                ]
        else:
            self._images.unregister()
            while self._subscribers:
                self._subscribers.pop().unregister()
            self._working_since = float("inf")
            self._idle()

    def _noting(self, name: str, callback: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """The callback of an input, which keeps in mind when it was called."""

        def noting(message: Any) -> None:
            self._came[name] = time.monotonic()
            callback(message)

        return noting


def read_threads() -> int:
    """~threads: a robot has other work for its cores, and sharing a picture costs more in all.

    Raises:
        ValueError: it is out of range.
    """
    return read_param("threads", 1, 0, MOST_THREADS, zero="all cores")


class _Listener(rospy.SubscribeListener):
    """Asks nothing itself: rospy calls it with locks held."""

    def peer_subscribe(self, *_: Any) -> None:
        transport.note_connections()

    def peer_unsubscribe(self, *_: Any) -> None:
        transport.note_connections()
