"""Clouds of points for the page, each on a channel of its session."""

import threading
from typing import Any, Dict, List, Optional

import rospy

from ..common.plain_text import error_text, printable
from ..common.throttle import Throttle
from .channels import POINTS, Channel
from .cloud_points import points_of
from .fields import Number, Text
from .message_topics import RawMessage, RawTopic, SharedTopics
from .operations import Operation
from .sessions import MAX_CHANNEL
from .settings import Settings

CLOUD = "sensor_msgs/PointCloud2"
MAX_POINTS = 200000  # of a frame: 3.2 MB
MAX_MAKING = 4  # frames that are made at a time, so many may be more than a page has room for


class _Cloud:
    """The newest cloud of a topic, for all who look at it."""

    def __init__(self, topic: str):
        self._lock = threading.Lock()  # guards the two below
        self._newest: Optional[RawMessage] = None
        self._viewers: List[_Viewer] = []
        self._topic = RawTopic(topic, self._take)

    def close(self) -> None:
        self._topic.close()

    def add(self, viewer: "_Viewer") -> None:
        with self._lock:
            self._viewers.append(viewer)
            newest = self._newest
        if newest is not None:
            viewer.offer(newest)

    def remove(self, viewer: "_Viewer") -> None:
        with self._lock:
            self._viewers.remove(viewer)

    def _take(self, raw: RawMessage) -> None:
        with self._lock:
            self._newest = raw
            viewers = list(self._viewers)
        for viewer in viewers:
            viewer.offer(raw)


class _Viewer:
    """A channel that clouds go to: a thread of its own chooses and sends points."""

    def __init__(
        self,
        topic: str,
        session: Any,
        channel: Channel,
        max_points: int,
        making: threading.Semaphore,
    ):
        self._topic = topic
        self._session = session
        self._channel = channel
        self._max_points = max_points
        self._making = making
        self._waiting: Optional[RawMessage] = None
        self._wanted = threading.Condition()  # guards what waits
        self._told = ""
        self._throttle = Throttle()
        threading.Thread(target=self._work, name="points", daemon=True).start()

    def offer(self, raw: RawMessage) -> None:
        with self._wanted:
            self._waiting = raw
            self._wanted.notify()

    def wake(self) -> None:
        with self._wanted:
            self._wanted.notify()

    def _work(self) -> None:
        while True:
            with self._wanted:
                self._wanted.wait_for(lambda: self._channel.closed or self._can_send())
                if self._channel.closed:
                    return
            with self._making:
                self._send_newest()

    def _can_send(self) -> bool:
        return self._waiting is not None and self._channel.ready

    def _send_newest(self) -> None:
        with self._wanted:
            if not self._can_send():  # Others have taken the room meanwhile.
                return
            raw, self._waiting = self._waiting, None
        try:
            self._send(raw)
        except Exception as error:  # Whatever it is, the next cloud may be better.
            self._fail(error_text(error))

    def _send(self, raw: Any) -> None:
        if raw.type != CLOUD:
            raise ValueError(f"the topic is of {printable(raw.type)}, must be of {CLOUD}")
        cloud = raw.decoded()
        points = points_of(cloud, self._max_points)
        stamp = cloud.header.stamp.to_sec() or raw.ros_time
        count = len(points.xyz)
        self._channel.send_binary(POINTS, stamp, raw.received, count, 1, points.payload())
        self._told = ""

    def _fail(self, text: str) -> None:
        if self._throttle.due():
            rospy.logwarn("%s: %s", self._topic, printable(text, 300))
        if text != self._told:
            self._told = text
            number = self._channel.number
            told = {"channel": number, "text": f"{self._topic}: {text}"}
            self._session.push("channel_error", told, str(number))


class PointFeature:
    """Shows clouds of points.

    Attributes:
        operations: points.
    """

    def __init__(self, _settings: Settings):
        self._clouds = SharedTopics(_Cloud)
        self._making = threading.Semaphore(MAX_MAKING)
        self.operations = [
            Operation(
                "points",
                self._open,
                "view",
                {
                    "channel": Number(1, MAX_CHANNEL, integer=True),
                    "topic": Text(),
                    "max_points": Number(1, MAX_POINTS, integer=True, default=50000),
                },
            )
        ]

    def close(self) -> None:
        """Nothing: each subscription ends with its channel."""

    def _open(self, session: Any, fields: Dict[str, Any]) -> Dict[str, Any]:
        topic, number = fields["topic"], int(fields["channel"])
        channel = session.channel(number)
        try:
            cloud = self._clouds.take(topic)
        except BaseException:
            session.close_channel(number)
            raise
        viewer = _Viewer(topic, session, channel, int(fields["max_points"]), self._making)

        def end() -> None:
            viewer.wake()
            cloud.remove(viewer)
            self._clouds.give_back(topic)

        cloud.add(viewer)
        channel.on_ready(viewer.wake)
        channel.on_close(end)
        return {}
