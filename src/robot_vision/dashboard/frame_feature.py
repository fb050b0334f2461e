"""The operation frames: where the frames of tf are, many times in a second."""

import threading
import time
from typing import Any, Dict, List, Optional

from ..common.plain_text import printable
from .channels import Channel
from .fields import Number, Text
from .frame_tree import FrameTree
from .message_topics import RawMessage, RawTopic
from .operations import Operation
from .sessions import Session
from .settings import Settings

TOPICS = ("/tf", "/tf_static")
MAX_RATE = 30.0  # Hz


class _Taker:
    """A channel that the frames go to."""

    def __init__(self, channel: Channel, root: str, rate: float):
        self.channel = channel
        self.root = root  # "": the one with most frames
        self.period = 1.0 / rate  # s
        self.due = 0.0  # s of the monotonic clock
        self.sent = -1  # the number of the change that it has last


class FrameFeature:
    """Sends the poses of all frames in one of them to the channels of sessions, when they change.

    It listens to tf while a session looks, and shows the newest transform of each frame.
    """

    def __init__(self, settings: Settings):
        fields = {
            "channel": Number(1, 65535, integer=True),
            "root": Text(default=""),
            "rate": Number(0.1, MAX_RATE, default=10.0),
        }
        self.operations = [Operation("frames", self._on_frames, "view", fields)]
        self._changed = threading.Condition()  # guards all below
        self._takers: Dict[Channel, _Taker] = {}
        self._tree = FrameTree()
        self._number = 0  # of changes
        self._closed = False
        self._subscribing = threading.Lock()  # held while the topics are made or closed
        self._topics: List[RawTopic] = []
        self._thread: Optional[threading.Thread] = None

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._takers.clear()
            self._changed.notify()
        self._rest()

    def _on_frames(self, session: Session, request: Dict[str, Any]) -> Dict[str, Any]:
        channel = session.channel(request["channel"])
        with self._subscribing:
            try:
                for name in TOPICS[len(self._topics) :]:
                    self._topics.append(RawTopic(name, self._on_transforms))
            except BaseException:
                session.close_channel(channel.number)
                raise
            with self._changed:
                taker = _Taker(channel, request["root"].lstrip("/"), request["rate"])
                self._takers[channel] = taker
                if self._thread is None:
                    self._thread = threading.Thread(target=self._run, name="frames", daemon=True)
                    self._thread.start()
                self._changed.notify()
        channel.on_ready(self._wake)
        channel.on_close(lambda: self._forget(channel))
        return {}

    def _forget(self, channel: Channel) -> None:
        with self._changed:
            self._takers.pop(channel, None)
        self._rest()

    def _rest(self) -> None:
        """Ends listening and forgets all frames if nobody looks."""
        with self._subscribing:
            with self._changed:
                if self._takers:
                    return
                self._tree = FrameTree()
            while self._topics:
                self._topics.pop().close()

    def _wake(self) -> None:
        with self._changed:
            self._changed.notify()

    def _on_transforms(self, raw: RawMessage) -> None:
        message = raw.decoded()
        with self._changed:
            if self._tree.add(getattr(message, "transforms", ())):
                self._number += 1
                self._changed.notify()

    def _run(self) -> None:
        while True:
            with self._changed:
                taker = self._next()
                if taker is None:
                    return
                data = frames_of(self._tree, taker.root)
            now = time.time()
            taker.channel.send_message(data, now, now)

    def _next(self) -> Optional[_Taker]:
        """Waits until something is to be sent; returns whom to, or None at the end."""
        while not self._closed:
            now = time.monotonic()
            behind = [
                taker
                for taker in self._takers.values()
                if taker.sent != self._number and taker.channel.ready
            ]
            first = min(behind, key=lambda taker: taker.due, default=None)
            if first is not None and first.due <= now:
                first.sent, first.due = self._number, now + first.period
                return first
            self._changed.wait(None if first is None else first.due - now)
        return None


def frames_of(tree: FrameTree, root: str) -> Dict[str, Any]:
    """Returns the frames as the page gets them, with the root that was taken for ""."""
    roots = tree.roots()
    root = root or (roots[0] if roots else "")
    frames = [
        {"name": name, "parent": parent, "position": pose.position, "orientation": pose.orientation}
        for name, parent, pose in tree.poses(root)
    ]
    return {"root": printable(root, 255), "frames": frames, "roots": roots}
