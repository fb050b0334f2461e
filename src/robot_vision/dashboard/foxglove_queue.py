"""What waits for a client of Foxglove's protocol: fair to small topics beside large ones."""

import threading
from collections import deque
from typing import Deque, Dict, NamedTuple, Optional

MAX_WAITING = 256 << 10  # bytes of a subscription that may wait; of larger messages only the newest


class Waiting(NamedTuple):
    """A message that waits: what comes before its bytes, and these, which others share."""

    head: bytes
    data: bytes


class _Line:
    def __init__(self) -> None:
        self.messages: Deque[Waiting] = deque()
        self.size = 0  # bytes
        self.share = 0.0  # bytes that it has had, as far as that counts


class FairQueue:
    """Messages of subscriptions; the one that has had the fewest bytes lately goes first.

    So a message of a small topic waits for no more than the one that is being sent. Of each
    subscription as many wait as MAX_WAITING holds, and at least one; older ones are dropped.
    """

    def __init__(self) -> None:
        self.dropped = 0
        self._lock = threading.Lock()  # guards all below
        self._lines: Dict[int, _Line] = {}
        self._share = 0.0  # of the subscription that was served last, before that

    def add(self, subscription: int) -> None:
        with self._lock:
            self._lines[subscription] = _Line()

    def remove(self, subscription: int) -> None:
        with self._lock:
            self._lines.pop(subscription, None)

    def put(self, subscription: int, head: bytes, data: bytes) -> None:
        """Adds a message of a subscription, if that is still there. Thread-safe."""
        with self._lock:
            line = self._lines.get(subscription)
            if line is None:
                return
            if not line.messages:  # Who had nothing to send has no claim to make up for it.
                line.share = max(line.share, self._share)
            line.messages.append(Waiting(head, data))
            line.size += len(data)
            while line.size > MAX_WAITING and len(line.messages) > 1:
                line.size -= len(line.messages.popleft().data)
                self.dropped += 1

    def take(self) -> Optional[Waiting]:
        """Returns the message that is to be sent now, or None. Thread-safe."""
        with self._lock:
            waiting = [line for line in self._lines.values() if line.messages]
            if not waiting:
                return None
            line = min(waiting, key=lambda one: (one.share, len(one.messages[0].data)))
            message = line.messages.popleft()
            line.size -= len(message.data)
            self._share = line.share
            line.share += len(message.head) + len(message.data)
            return message

    def size(self) -> int:
        """Returns the bytes that wait."""
        with self._lock:
            return sum(line.size for line in self._lines.values())
