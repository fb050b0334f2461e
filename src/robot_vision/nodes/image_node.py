"""What every node does that works on pictures."""

from typing import Any, Callable, List, Tuple

import rospy

from .. import set_threads, transport
from .params import read_param, warn_of_unknown

MOST_THREADS = 256


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
        kind = transport.CameraSubscriber if camera_info else transport.ImageSubscriber
        self._images = kind(
            "image", process, encoding, diagnostics=transport.node_diagnostics(), start=False
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
        self._inputs.append((name, kind, callback))

    def keep_working(self, wanted: bool) -> None:
        """Whether to work although nobody subscribes. Thread-safe."""
        self._wanted = wanted
        transport.note_connections()

    def start(self) -> None:
        """Begins to work; the node has to be complete by now, all its parameters read."""
        warn_of_unknown()
        transport.add_connection_listener(self._update)
        transport.note_connections()

    def _update(self) -> None:
        """Only the thread of the pictures calls it, so subscribing and ending do not overlap."""
        listened = any(
            counts() and output.get_num_connections() for output, counts in self._outputs
        )
        if self._always or self._wanted or listened:
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
            self._idle()


def read_threads() -> int:
    """~threads: a robot has other work for its cores, and sharing a picture costs more in all.

    Raises:
        ValueError: it is out of range.
    """
    threads = read_param("threads", 1)
    if not 0 <= threads <= MOST_THREADS:
        raise ValueError(f"threads is {threads}, must be from 0 (all cores) to {MOST_THREADS}")
    return threads


class _Listener(rospy.SubscribeListener):
    """Asks nothing itself: rospy calls it with locks held."""

    def peer_subscribe(self, *_: Any) -> None:
        transport.note_connections()

    def peer_unsubscribe(self, *_: Any) -> None:
        transport.note_connections()
