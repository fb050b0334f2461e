"""The images of one topic on their way to all who look at them."""

import functools
import threading
from typing import Any, Callable, Dict, List, Optional, Set

import rospy

from ..common.plain_text import error_text, printable
from ..common.throttle import Throttle
from .pictures import Display, Picture, Wish, encoded


class Viewer:
    """Somebody who looks at a topic; what is called here may come from any thread and is quick.

    Attributes:
        ready: Whether it takes another picture now.
    """

    ready = False

    def show(self, picture: Picture, kind: int, data: bytes) -> None:
        """Takes a picture and its encoding, JPEG or PNG, which others share."""
        raise NotImplementedError

    def fail(self, text: str) -> None:
        """Takes note that pictures cannot be shown, in words."""
        raise NotImplementedError


class _Place:
    """A viewer, and what it has had."""

    def __init__(self, viewer: Viewer, wish: Wish):
        self.viewer = viewer
        self.wish = wish
        self.seen = 0  # the number of the newest picture that it has had
        self.told = ""  # the error that it knows


class ImageStream:
    """Encodes pictures once for all who want the same, and only while one of them is ready.

    A picture that waits is replaced by the newest; who becomes ready gets the newest at once if it
    has not had it.

    Args:
        topic: The name, for the log.
        submit: submit(work) has work done in another thread.
    """

    def __init__(self, topic: str, submit: Callable[[Callable[[], None]], Any]):
        self.encodings = 0  # that were made
        self.newest: Optional[Picture] = None
        self._topic = topic
        self._submit = submit
        self._lock = threading.RLock()  # guards all below; a viewer may call wake() from show()
        self._number = 0  # of the newest picture
        self._places: Dict[Viewer, _Place] = {}
        self._made: Dict[Display, bytes] = {}  # of the newest picture
        self._working: Set[Display] = set()
        self._throttle = Throttle()

    def add(self, viewer: Viewer, wish: Wish) -> None:
        with self._lock:
            self._places[viewer] = _Place(viewer, wish)
        self.wake()

    def remove(self, viewer: Viewer) -> None:
        with self._lock:
            self._places.pop(viewer, None)

    def offer(self, picture: Picture) -> None:
        """Takes the newest picture of the topic; quick."""
        with self._lock:
            self.newest = picture
            self._number += 1
            self._made.clear()
        self.wake()

    def fail(self, text: str) -> None:
        """Tells all viewers, each once, why there are no pictures."""
        with self._lock:
            self._tell(list(self._places.values()), text)

    def wake(self) -> None:
        """Serves those who are ready and have not had the newest picture; quick."""
        with self._lock:
            if self.newest is None:
                return
            picture, number = self.newest, self._number
            for display in self._show_what_is_made(picture):
                self._working.add(display)
                self._submit(functools.partial(self._encode, picture, number, display))

    def _show_what_is_made(self, picture: Picture) -> List[Display]:
        """Returns the encodings that have to be made for the others who are ready."""
        missing = []
        for place in self._places.values():
            if place.seen >= self._number or not place.viewer.ready:
                continue
            display = place.wish.of(picture)
            data = picture.data if picture.frame is None else self._made.get(display)
            if data is not None:
                self._show(place, picture, self._number, display, data)
            elif display not in self._working and display not in missing:
                missing.append(display)
        return missing

    def _encode(self, picture: Picture, number: int, display: Display) -> None:
        try:
            data, reason = encoded(picture, display), ""
        except Exception as error:  # Whatever it is, the next picture is to be encoded again.
            data, reason = b"", error_text(error)
        with self._lock:
            self._working.discard(display)
            self.encodings += 1
            waiting = [
                place
                for place in self._places.values()
                if place.seen < number and place.wish.of(picture) == display
            ]
            if reason:
                for place in waiting:
                    place.seen = number
                self._tell(waiting, reason)
            else:
                if number == self._number:
                    self._made[display] = data
                for place in waiting:
                    if place.viewer.ready:
                        self._show(place, picture, number, display, data)
        self.wake()

    def _show(
        self, place: _Place, picture: Picture, number: int, display: Display, data: bytes
    ) -> None:
        place.seen, place.told = number, ""
        place.viewer.show(picture, display.kind, data)

    def _tell(self, places: List[_Place], text: str) -> None:
        for place in places:
            if place.told != text:
                place.told = text
                place.viewer.fail(f"{self._topic}: {text}")
        if self._throttle.due():
            rospy.logwarn("%s: %s", self._topic, printable(text, 300))
