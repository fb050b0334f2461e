"""A channel of a session: a stream of images, points or messages that the page has asked for."""

import struct
import threading
from typing import Any, Callable, Dict, List, Optional

from .encoding import to_json
from .outbox import Message, Outbox

MAX_IN_FLIGHT = 2  # frames that the page has not acknowledged
HEADER = struct.Struct("<BBHIddII")  # kind, 0, channel, seq, stamp, received, width, height
JPEG, POINTS, PNG = 1, 2, 3  # kinds


class Channel:
    """Sends frames to a page, at most two more than it has drawn; the newest replaces others.

    While too much waits for the page in all, none is begun.

    Attributes:
        number: The number that the page has chosen.
        closed: Whether it is closed; what is sent then is dropped.
    """

    def __init__(self, number: int, outbox: Outbox):
        self.number = number
        self.closed = False
        self._outbox = outbox
        self._lock = threading.Lock()
        self._seq = 0
        self._in_flight: Dict[int, bool] = {}  # by seq, whether it has been handed over
        self._newest: Optional[Callable[[int], Message]] = None  # what waits for an ack
        self._on_ready: List[Callable[[], Any]] = []
        self._on_close: List[Callable[[], Any]] = []

    @property
    def ready(self) -> bool:
        """Whether what is sent now goes to the page at once. Thread-safe."""
        with self._lock:
            return self._is_ready()

    def send_binary(
        self,
        kind: int,
        stamp: float,
        received: float,
        width: int,
        height: int,
        payload: bytes,
    ) -> None:
        """Sends a frame, or keeps it until the page has drawn another one. Thread-safe.

        Args:
            kind: JPEG, POINTS or PNG.
            stamp: The time of the image in s of ROS' clock.
            received: When the message had come, in s of the wall clock.
            width: That of the image in px, or the number of points.
            height: That of the image in px, or 1.
            payload: The bytes; they are shared, not copied.
        """

        def make(seq: int) -> Message:
            header = HEADER.pack(kind, 0, self.number, seq, stamp, received, width, height)
            return Message((header, payload), True, lambda: self._hand_over(seq), paced=True)

        self._send(make)

    def send_message(self, data: Dict[str, Any], stamp: float, received: float) -> None:
        """Sends a message, or keeps it until the page has taken another one. Thread-safe.

        Args:
            data: The message, as JSON can hold it.
            stamp: Its time in s of ROS' clock.
            received: When it had come, in s of the wall clock.
        """
        tail = to_json({"stamp": stamp, "received": received, "data": data})[1:]

        def make(seq: int) -> Message:
            head = f'{{"push":"message","channel":{self.number},"seq":{seq},'
            return Message((head + tail,), False, lambda: self._hand_over(seq), paced=True)

        self._send(make)

    def on_ready(self, callback: Callable[[], Any]) -> None:
        """Has a function called on the loop, where it must not block, when it is ready again."""
        self._on_ready.append(callback)

    def on_close(self, callback: Callable[[], Any]) -> None:
        """Has a function called in a worker thread when the channel is closed, at once if it is."""
        with self._lock:
            if not self.closed:
                self._on_close.append(callback)
                return
        callback()

    def acknowledge(self, seq: Any) -> bool:
        """Takes the page's word that it has drawn a frame, and returns whether it had; on the loop.

        Frames that have not been handed over yet are not acknowledged, as a page that says so
        without reading would have any number of them wait.
        """
        with self._lock:
            if type(seq) is not int or not self._in_flight.get(seq):
                return False
            del self._in_flight[seq]
        self._go_on()
        return True

    def close(self) -> None:
        """Closes the channel and calls what waits for that; in a worker thread."""
        with self._lock:
            if self.closed:
                return
            self.closed = True
            self._newest = None
            self._outbox.discard(lambda key: isinstance(key, tuple) and key[0] is self)
        for callback in self._on_close:
            callback()

    def _is_ready(self) -> bool:
        can = not self.closed and len(self._in_flight) < MAX_IN_FLIGHT
        return can and not self._outbox.is_full(self._go_on)

    def _go_on(self) -> None:
        """Sends what waits, and has others know if it is ready then; on the loop."""
        with self._lock:
            if self._newest and self._is_ready():
                self._start(self._newest)
            ready = self._is_ready()
        if ready:
            for callback in self._on_ready:
                callback()

    def _send(self, make: Callable[[int], Message]) -> None:
        with self._lock:
            if self._is_ready():
                self._start(make)
            elif not self.closed:
                self._newest = make

    def _start(self, make: Callable[[int], Message]) -> None:
        self._newest = None  # what has waited longer
        self._seq = self._seq % 0xFFFFFFFF + 1
        self._in_flight[self._seq] = False
        self._outbox.put(make(self._seq), (self, self._seq))

    def _hand_over(self, seq: int) -> None:
        with self._lock:
            if seq in self._in_flight:
                self._in_flight[seq] = True
