"""Subscriptions to images, whatever becomes of their topic."""

import contextlib
import threading
import time
from typing import Any, Callable, List, Optional, Tuple

import rospy

from ..common.plain_text import error_text
from ..ros.transport import Frame, FrameError, ImageSubscriber
from .compressed_message import picture_of
from .image_topics import ImageTopics, Route
from .message_topics import RawMessage, RawTopic, SharedTopics
from .pictures import Picture

OnFrame = Callable[[Frame, float], Any]  # with the s of the wall clock when it came


class _SharedFrames:
    """A subscription to pixels, and all who want them."""

    def __init__(self, make: Callable[..., Any], topic: str, transport: str):
        self._lock = threading.Lock()  # guards the two below
        self._callbacks: List[OnFrame] = []
        self._newest: Optional[Tuple[Frame, float]] = None
        self._subscriber = make(topic, self._take, transport=transport)

    def close(self) -> None:
        self._subscriber.unregister()

    def add(self, callback: OnFrame) -> None:
        with self._lock:
            self._callbacks.append(callback)
            newest = self._newest
        if newest is not None:
            with contextlib.suppress(FrameError):  # The next one may be better.
                callback(*newest)

    def remove(self, callback: OnFrame) -> None:
        with self._lock:
            self._callbacks.remove(callback)

    def _take(self, frame: Frame) -> None:
        with self._lock:
            self._newest = newest = frame, time.time()
            callbacks = list(self._callbacks)
        for callback in callbacks:
            callback(*newest)


class RosSubscriptions:
    """Subscriptions of this node; those to pixels are shared by all who want the same."""

    def __init__(self, make: Callable[..., Any] = ImageSubscriber):
        self._shared = SharedTopics(lambda key: _SharedFrames(make, *key))

    def raw(self, topic: str, callback: Callable[[RawMessage], Any]) -> Callable[[], None]:
        """Subscribes to messages as they are; returns the function that ends it."""
        return RawTopic(topic, callback).close

    def frames(self, topic: str, transport: str, callback: OnFrame) -> Callable[[], None]:
        """Subscribes to pixels; the newest that others have got comes at once."""
        key = (topic, transport)
        shared = self._shared.take(key)
        shared.add(callback)

        def end() -> None:
            shared.remove(callback)
            self._shared.give_back(key)

        return end


class ImageSource:
    """The pictures of a topic, which may change its type, vanish and come back.

    Args:
        topic: Its whole name.
        passed: Whether what comes compressed is passed on; else it is decoded.
        topics: What is known of topics.
        subscriptions: What makes subscriptions, as RosSubscriptions.
        receive: The function that gets each Picture; it must be quick.
        fail: The function that is told in words why there are none.
    """

    def __init__(
        self,
        topic: str,
        passed: bool,
        topics: ImageTopics,
        subscriptions: Any,
        receive: Callable[[Picture], Any],
        fail: Callable[[str], Any],
    ):
        self._topic = topic
        self._passed = passed
        self._topics = topics
        self._subscriptions = subscriptions
        self._receive = receive
        self._fail = fail
        self._lock = threading.Lock()  # guards the subscription
        self._route: Optional[Route] = None
        self._end: Callable[[], Any] = lambda: None
        self._closed = False

    def follow(self) -> None:
        """Subscribes to what the topic is now."""
        with self._lock:
            if self._closed:
                return
            try:
                route = self._topics.route(self._topic, self._passed)
                if route is None or route == self._route:
                    return
                self._leave()
                self._end = self._subscribe(route)
                self._route = route
            except ValueError as error:
                self._leave()
                self._fail(str(error))
            except (OSError, rospy.ROSException) as error:  # It is tried again.
                self._fail(error_text(error))

    def close(self) -> None:
        with self._lock:
            self._closed = True
            self._leave()

    def _leave(self) -> None:
        self._route = None
        end, self._end = self._end, lambda: None
        end()

    def _subscribe(self, route: Route) -> Callable[[], None]:
        if route.transport:
            return self._subscriptions.frames(route.topic, route.transport, self._take_frame)
        return self._subscriptions.raw(route.topic, self._take_raw)

    def _take_frame(self, frame: Frame, received: float) -> None:
        if frame.image.size == 0:
            raise FrameError("it has no pixels")
        height, width = frame.image.shape[:2]
        self._receive(Picture(frame.time, received, width, height, frame))

    def _take_raw(self, raw: RawMessage) -> None:
        try:
            self._receive(picture_of(raw))
        except ValueError as error:
            self._fail(str(error))
