"""A running dashboard and what its pages, programs and browsers receive of it."""

import re
import struct
from typing import Any, Callable, List, NamedTuple

import cv2
import numpy as np
import rospy
import support
from dashboard_node import PROGRAM
from served import Page
from tornado.httpclient import HTTPClient, HTTPResponse

TOKEN = "token-of-the-streams"
HEADER = struct.Struct("<BBHIddII")


class Frame(NamedTuple):
    """A binary message of a channel."""

    kind: int
    channel: int
    seq: int
    stamp: float
    received: float
    width: int
    height: int
    payload: bytes

    @property
    def image(self) -> np.ndarray:
        return decoded(self.payload)


def decoded(data: bytes) -> np.ndarray:
    """The pixels of a JPEG or a PNG."""
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    assert image is not None
    return image


def frame_of(message: bytes) -> Frame:
    kind, zero, *others = HEADER.unpack_from(message)
    assert zero == 0
    return Frame(kind, *others, message[HEADER.size :])


class Dashboard:
    """A dashboard on a port of its own."""

    def __init__(self, start: Callable[..., support.Process], *arguments: str, **env: str):
        words = ("_port:=0", f"_token:={TOKEN}", *arguments)
        self.process = start(PROGRAM, *words, env={"PYTHONUNBUFFERED": "1", **env})
        self.process.wait_for_output("dashboard: http://")
        self.host = re.search(r"dashboard: http://([^/]+)/", self.process.output())[1]

    def page(self, token: str = TOKEN) -> "StreamPage":
        return StreamPage(f"ws://{self.host}/ws?token={token}", {"Origin": f"http://{self.host}"})

    def url(self, path: str, **arguments: Any) -> str:
        query = "&".join(f"{name}={value}" for name, value in arguments.items())
        return f"http://{self.host}{path}?{query}"

    def get(self, path: str, token: str = TOKEN, **arguments: Any) -> HTTPResponse:
        url = self.url(path, token=token, **arguments)
        timeout = {"request_timeout": support.DEADLINE}
        return HTTPClient().fetch(url, raise_error=False, follow_redirects=False, **timeout)


class StreamPage(Page):
    """A page that acknowledges what it has drawn, unless it is told not to."""

    def frame(self, acknowledged: bool = True) -> Frame:
        """The next frame of any channel."""
        message = self.frames.pop(0) if self.frames else self.read()
        while not isinstance(message, bytes):
            assert message is not None, f"closed: {self.close_code} {self.close_reason}"
            self.pushes.append(message)
            message = self.read()
        frame = frame_of(message)
        if acknowledged:
            self.send({"op": "ack", "channel": frame.channel, "seq": frame.seq})
        return frame

    def push(self, kind: str) -> Any:
        """The next push of a kind."""
        while True:
            for at, message in enumerate(self.pushes):
                if message.get("push") == kind:
                    return self.pushes.pop(at)["data"]
            message = self.read()
            assert message is not None, "closed"
            (self.frames if isinstance(message, bytes) else self.pushes).append(message)


def subscribers(topic: str) -> List[str]:
    """The nodes that subscribe to a topic."""
    import rosgraph

    return dict(rosgraph.Master("/test").getSystemState()[1]).get(topic, [])


def publisher(topic: str, kind: Any, latch: bool = False, queue_size: int = 10) -> rospy.Publisher:
    return rospy.Publisher(topic, kind, queue_size=queue_size, latch=latch, tcp_nodelay=True)
