"""What all nodes that process images have in common."""

import functools
import time
from typing import Any, Callable, Dict, List, Tuple

import rospy

from . import transport
from .context import MESSAGE_QUEUE, SHARED_QUEUE, current
from .listeners import listeners_elsewhere
from .params import read_param, review_params
from .shared_threads import set_threads

MAX_THREADS = 256
INPUT_TIMEOUT = 5.0  # s without a message until an input counts as missing
TYPICAL = {  # what a topic of images is remapped to
    "image": "/usb_cam/image_raw",
    "depth": "/camera/depth_registered/image_raw",
}


class ImageNode:
    """Processes the images of a topic while the results are wanted.

    They are wanted while somebody subscribes to an output, while keep_working() asks for it, and
    always if ~always_subscribe is true. Frames are counted, and refused if they cannot be used.
    Statistics go to /diagnostics under the node's name. Add the outputs first, then call start().

    Args:
        process: The function that processes a Frame and publishes the results.
        encoding: The encoding to which frames are converted.
        idle: A function that is called when the work ends, to release what was kept for it.
        name: The name of the topic: image, or depth.

    Raises:
        ValueError: A parameter has the wrong type or is out of range.
    """

    def __init__(
        self,
        process: Callable[[transport.Frame], Any],
        encoding: str = "bgr8",
        idle: Callable[[], Any] = lambda: None,
        name: str = "image",
    ):
        self._context = current()
        # Others' threads call it, as that of a subscriber which comes.
        self._note_connections = self._context.bind(transport.note_connections)
        self._idle = [idle]
        self._name = name
        self._always = read_param("always_subscribe", False)
        # A robot needs its other cores for other work, and sharing an image costs more in sum.
        set_threads(read_param("threads", 1, 0, MAX_THREADS, zero="all cores"))
        self._wanted = False
        # How many subscribers each output has, and whether they count.
        self._outputs: List[Tuple[Callable[[], int], Callable[[], bool]]] = []
        self._inputs: List[Tuple[Any, ...]] = []  # names, types, what notes
        self._subscribers: List[rospy.Subscriber] = []  # of the inputs, while the node works
        self._other_images: Dict[str, transport.ImageSubscriber] = {}  # by name
        self._last_message: Dict[str, float] = {}  # s of the monotonic clock, by input
        self._working_since = float("inf")  # s of the monotonic clock
        self._lack = ""  # what the diagnostics say that is missing
        self._diagnostics = transport.node_diagnostics()
        self._images = transport.ImageSubscriber(
            name,
            self._timed(name, process),
            encoding,
            diagnostics=self._diagnostics,
            start=False,
        )
        if self._images.topic == f"/{name}":
            typical = f"{name}:={TYPICAL[name]}"
            rospy.logwarn("topic '%s' is not remapped; typical use is %s", name, typical)

    @property
    def topic(self) -> str:
        """The resolved name of the image topic."""
        return self._images.topic

    def publisher(
        self, name: str, kind: Any, counts: Callable[[], bool] = lambda: True
    ) -> rospy.Publisher:
        """Adds a topic of results; its subscribers make the node work while `counts()` is true."""
        output = self._publisher(name, kind, 1)
        self._outputs.append((output.get_num_connections, counts))
        return output

    def shared_publisher(
        self, name: str, kind: Any, counts: Callable[[], bool], listens: bool
    ) -> rospy.Publisher:
        """Adds a topic of all nodes, as publisher() does.

        If the node `listens` to it, too, subscribers of its own process do not count: it would have
        itself work for ever, and so would two of one process each other. rospy does not tell which
        nodes of a process listen.
        """
        output = self._publisher(name, kind, SHARED_QUEUE)
        elsewhere = functools.partial(listeners_elsewhere, output)
        self._outputs.append((elsewhere if listens else output.get_num_connections, counts))
        return output

    def _publisher(self, name: str, kind: Any, queue_size: int) -> rospy.Publisher:
        listener = _Listener(self._note_connections)
        return self._context.publisher(
            name, kind, queue_size=queue_size, subscriber_listener=listener
        )

    def image_publisher(self, name: str) -> transport.ImagePublisher:
        """Adds an image topic, whose subscribers make the node work; draw only if it has any."""
        output = transport.ImagePublisher(name)
        self._outputs.append((output.get_num_connections, lambda: True))
        return output

    def subscriber(self, name: str, kind: Any, callback: Callable[[Any], Any]) -> None:
        """Adds an input: while the node works, the callback gets the newest message of a topic.

        It is that of each publisher. The thread that processes `image` calls the callback, too.
        """

        def take(message: Any) -> None:
            if self._subscribers:  # Otherwise the work has ended a moment ago.
                callback(message)

        note = functools.partial(transport.node_images().note, take)
        self._inputs.append((name, kind, self._timed(name, note)))

    def image_subscriber(
        self, name: str, callback: transport.Callback, image_transport: str = "auto"
    ) -> transport.ImageSubscriber:
        """Adds another topic of images, which come as they are while the node works.

        The thread that processes `image` calls the callback with the newest Frame, too.

        Raises:
            ValueError: There is no such transport.
        """
        images = transport.ImageSubscriber(
            name, self._timed(name, callback), transport=image_transport, start=False
        )
        self._other_images[name] = images
        return images

    def on_idle(self, release: Callable[[], Any]) -> None:
        """Adds a function that is called as `idle` is, when the work ends."""
        self._idle.append(release)

    def keep_working(self, wanted: bool) -> None:
        """Sets whether to work even if nobody subscribes. Thread-safe."""
        self._wanted = wanted
        self._note_connections()

    def missing(self, seconds: float = INPUT_TIMEOUT, only: str = "") -> str:
        """Returns which inputs had no message for `seconds`, in words. Thread-safe.

        The text is empty if there are none, or if the node is not working.

        Args:
            seconds: How long an input may be silent.
            only: The name of the input that is asked for; by default all are.
        """
        now = time.monotonic()
        inputs = [(self._name, "images", self._images.topic, self._images)]
        for name, images in self._other_images.items():
            inputs.append((name, name, images.topic, images))
        for (name, *_), subscriber in zip(self._inputs, self._subscribers):
            inputs.append((name, name, subscriber.resolved_name, subscriber))
        lacking = []
        for name, plural, topic, subscriber in inputs:
            if only not in ("", name):
                continue
            silent = now - max(self._last_message.get(name, 0.0), self._working_since)
            if silent >= seconds:
                lacking.append(silence_text(name, plural, topic, subscriber, silent))
        return "; ".join(lacking)

    def no_frame(self, seconds: float) -> str:
        """Returns the error message for the case that no frame came within `seconds`."""
        nobody = "" if self._images.get_num_connections() else "; nobody publishes there"
        return f"no frame on {self.topic} within {seconds:g} s{nobody}"

    def go_on(self, frame: transport.Frame, work: Callable[[], Any]) -> None:
        """Goes on with a frame that `process` has kept, as ImageSubscriber.go_on(). Thread-safe."""
        self._images.go_on(frame, work)

    def set_lack(self, lack: str) -> None:
        """Has the diagnostics say what the node lacks besides images, or nothing if it is empty."""
        if lack != self._lack:
            self._lack = lack
            self._set_state()

    def start(self) -> None:
        """Starts the work. All outputs must have been added, and all parameters read."""
        review_params()
        transport.add_connection_listener(self._update)
        transport.note_connections()

    def _update(self) -> None:
        """Starts or ends the work as needed; always called by the same thread, that of images."""
        listened = any(counts() and subscribers() for subscribers, counts in self._outputs)
        if self._always or self._wanted or listened:
            self._working_since = min(self._working_since, time.monotonic())
            self._images.start()
            if not self._subscribers:
                self._subscribers = [
                    self._context.subscriber(
                        name, kind, note, queue_size=MESSAGE_QUEUE, tcp_nodelay=True
                    )
                    for name, kind, note in self._inputs
                ]
            self._start_others()  # Nothing else has to wait for what may be refused.
        else:
            self._images.unregister()
            for images in self._other_images.values():
                images.unregister()
            while self._subscribers:
                self._context.close(self._subscribers.pop().unregister)
            self._working_since = float("inf")
            self._lack = ""
            for release in self._idle:
                release()

    def _start_others(self) -> None:
        """Subscribes to the other images; why it cannot is told in the node's diagnostics, too."""
        for images in self._other_images.values():
            try:
                images.start()
            except RuntimeError as error:
                self._diagnostics.set_unsubscribed(f"{images.topic}: {error}")
                raise
        self._set_state()  # in place of an error

    def _set_state(self) -> None:
        if self._lack:
            self._diagnostics.set_lacking(self._lack, self.topic)
        else:
            self._diagnostics.set_running(self.topic)

    def _timed(self, name: str, callback: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """Returns the callback of an input, extended by noting the time of each message."""

        def timed(message: Any) -> Any:
            self._last_message[name] = time.monotonic()
            return callback(message)

        return timed


def silence_text(name: str, plural: str, topic: str, subscriber: Any, silent: float) -> str:
    """Returns what there is to say of an input that had no message for so long (s)."""
    if not subscriber.get_num_connections():
        return f"nobody publishes {plural} on {topic}"
    return f"no {name} on {topic} for {silent:.0f} s"


class _Listener(rospy.SubscribeListener):
    """Only passes events on, because rospy calls it while it holds locks."""

    def __init__(self, note_connections: Callable[[], Any]):
        self._note_connections = note_connections

    def peer_subscribe(self, *_: Any) -> None:
        self._note_connections()

    peer_unsubscribe = peer_subscribe
