"""The images of all topics that somebody looks at."""

import contextlib
import os
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Dict, List, Optional, Tuple

import rospy

from ..common.plain_text import error_text
from ..common.throttle import Throttle
from ..ros.graph_master import graph_name
from ..ros.transport import Frame
from .image_source import ImageSource, RosSubscriptions
from .image_stream import ImageStream, Viewer
from .image_topics import ImageTopics
from .pictures import Wish
from .watched_topic import Handle, WatchedTopic

MAX_WORKERS = 4  # threads that encode
LOOK_PERIOD = 1.0  # s between two looks at what has become of topics, while somebody watches
LINGER = 1.0  # s that a subscription stays for those who come back at once

_failures = Throttle()


class ImageHub:
    """Subscribes to each topic once while somebody looks, and encodes once for all.

    Args:
        topics: What is known of topics, as ImageTopics.
        subscriptions: What makes subscriptions, as RosSubscriptions.
    """

    def __init__(self, topics: Any = None, subscriptions: Any = None):
        self.topics = topics or ImageTopics()
        self._subscriptions = subscriptions or RosSubscriptions()
        workers = min(MAX_WORKERS, os.cpu_count() or 1)
        self._pool = ThreadPoolExecutor(workers, thread_name_prefix="encoding")
        self._lock = threading.Lock()  # guards all below
        self._look_lock = threading.Lock()  # guards self.topics
        self._open: Dict[Tuple[str, bool], WatchedTopic] = {}
        self._thread: Optional[threading.Thread] = None
        self._closed = threading.Event()

    def view(self, topic: str, wish: Wish, viewer: Viewer, passed: bool = True) -> Handle:
        """Shows a topic to a viewer until the handle is closed.

        Args:
            topic: The whole name.
            wish: How.
            viewer: To whom; call wake() when it is ready again.
            passed: Whether what comes compressed is passed on as it is, whatever the wish.

        Raises:
            ValueError: The topic has no images that can be shown, or is no name.
        """
        entry = self._take(topic, passed)
        entry.stream.add(viewer, wish)

        def end() -> None:
            entry.stream.remove(viewer)
            self._give_back(entry)

        return Handle(end, entry.stream.wake)

    def watch(self, topic: str, callback: Callable[[Frame], Any]) -> Handle:
        """Has a function called with each Frame of a topic, in the images' thread: it is quick.

        Raises:
            ValueError: The topic has no images, or is no name.
        """
        entry = self._take(topic, False)
        entry.callbacks.append(callback)

        def end() -> None:
            entry.callbacks.remove(callback)
            self._give_back(entry)

        return Handle(end)

    def newest(self, topic: str, timeout: float = 5.0) -> Frame:
        """Returns the newest image of a topic, to which it subscribes if nobody looks at it.

        Raises:
            ValueError: The topic has no images, or is no name.
            TimeoutError: None has come in time.
        """
        came = threading.Event()
        entry = self._take(topic, False)

        def note(_: Frame) -> None:
            came.set()

        entry.callbacks.append(note)
        try:
            if entry.stream.newest is None:
                came.wait(timeout)
            if entry.stream.newest is None:
                raise TimeoutError(f"no image has come on {topic} within {timeout:g} s")
            return entry.stream.newest.frame
        finally:
            entry.callbacks.remove(note)
            self._give_back(entry)

    def close(self) -> None:
        """Ends all subscriptions."""
        self._closed.set()
        with self._lock:
            entries = list(self._open.values())
            self._open.clear()
        for entry in entries:
            entry.source.close()
        self._pool.shutdown(wait=False)

    def encodings(self) -> int:
        """Returns how many encodings were made for those who look now."""
        with self._lock:
            return sum(entry.stream.encodings for entry in self._open.values())

    def refresh(self) -> None:
        """Asks the master what topics there are; raises OSError if it does not answer."""
        with self._look_lock:
            self.topics.refresh()

    def _take(self, topic: str, passed: bool) -> WatchedTopic:
        key = (graph_name(topic), passed)
        with self._lock:
            if self._closed.is_set():
                raise ValueError("the dashboard ends")
            fresh = key not in self._open
            if fresh:
                self._open[key] = self._made(key)
            entry = self._open[key]
            entry.users += 1
        try:
            with self._look_lock:
                if fresh:
                    self.topics.refresh()
                self.topics.route(topic, passed)
                entry.source.follow()
        except ValueError:
            self._give_back(entry)
            raise
        except OSError as error:  # There may be another look soon.
            if _failures.due():
                rospy.logwarn("%s", error)
        finally:
            self._look_later()  # which also forgets what nobody wants
        return entry

    def _made(self, key: Tuple[str, bool]) -> WatchedTopic:
        topic, passed = key
        entry = WatchedTopic(key, ImageStream(topic, self._submit))
        entry.source = ImageSource(
            topic, passed, self.topics, self._subscriptions, entry.receive, entry.stream.fail
        )
        return entry

    def _give_back(self, entry: WatchedTopic) -> None:
        with self._lock:
            entry.users -= 1
            entry.idle_since = time.monotonic()

    def _submit(self, work: Callable[[], None]) -> None:
        with contextlib.suppress(RuntimeError):  # The pool has ended, as this hub does.
            self._pool.submit(work)

    def _look_later(self) -> None:
        with self._lock:
            if self._thread is None and not self._closed.is_set():
                self._thread = threading.Thread(target=self._look, name="topics", daemon=True)
                self._thread.start()

    def _look(self) -> None:
        """Follows the topics until nobody looks at any."""
        while not self._closed.wait(LOOK_PERIOD):
            now = time.monotonic()
            with self._lock:
                idle = [
                    key
                    for key, entry in self._open.items()
                    if not entry.users and now - entry.idle_since >= LINGER
                ]
                ended = [self._open.pop(key) for key in idle]
                entries = list(self._open.values())
                if not entries:
                    self._thread = None
            for entry in ended:
                entry.source.close()
            if not entries:
                return
            self._follow(entries)

    def _follow(self, entries: List[WatchedTopic]) -> None:
        try:
            with self._look_lock:
                self.topics.refresh()
                for entry in entries:
                    if entry.users:
                        entry.source.follow()
        except Exception as error:  # Whatever a topic or a master is, others are to be followed.
            if _failures.due():
                rospy.logwarn("topics cannot be followed: %s", error_text(error))
