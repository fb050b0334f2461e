"""What the dashboard costs beside encoding: encodings of a frame, memory, and CPU for nobody."""

import asyncio
import json
import statistics
import threading
import time
from types import SimpleNamespace
from typing import Any, Callable, Iterator, List, Tuple

import numpy as np
import psutil
import rospy
import support
from measuring import WARM_UP, Bench, say
from results import Accuracy
from sensor_msgs.msg import Image
from stream_contenders import TOKEN, counted, dashboard
from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect

from robot_vision.dashboard.image_hub import ImageHub
from robot_vision.dashboard.image_source import RosSubscriptions
from robot_vision.dashboard.image_stream import Viewer
from robot_vision.dashboard.image_topics import IMAGE, ImageTopics
from robot_vision.dashboard.pictures import Wish

SIZE = (1920, 1080)
STALLED = 8
FRAMES = 30
IDLE_CORE = 0.5  # % of a core without a viewer
TITLE = "Streams: encodings, memory, and without a viewer"
TEXT = f"""### {TITLE}

A stalled viewer takes what it is sent, but never says that it has drawn it; its memory is what the
process needs more with {STALLED} of them, for each, and the goal two frames. 1920x1080.

"""


class _Topics(ImageTopics):
    def refresh(self) -> None:
        self._types = {"/camera": IMAGE}


class _Taker(Viewer):
    """A viewer that is always ready."""

    ready = True

    def __init__(self) -> None:
        self.count = 0
        self.size = 0

    def show(self, _picture: Any, _kind: int, data: bytes) -> None:
        self.count += 1
        self.size = len(data)

    def fail(self, text: str) -> None:
        raise RuntimeError(text)


def encodings(viewers: int) -> float:
    """Returns how many encodings a frame takes that so many viewers see."""
    callbacks: List[Callable[[Any], Any]] = []

    def subscribe(_topic: str, callback: Callable[[Any], Any], **_: Any) -> Any:
        callbacks.append(callback)
        return SimpleNamespace(unregister=lambda: None)

    hub = ImageHub(_Topics(), RosSubscriptions(subscribe))
    takers = [_Taker() for _ in range(viewers)]
    for taker in takers:
        hub.view("/camera", Wish(needed=640), taker)
    image = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    for number in range(FRAMES):
        callbacks[0](SimpleNamespace(image=image, encoding="bgr8", time=float(number)))
        while min(taker.count for taker in takers) <= number:
            time.sleep(1e-3)
    made = hub.encodings()
    hub.close()
    return made / FRAMES


class _Camera:
    """Publishes noise, whose JPEG is large, in a thread."""

    def __init__(self) -> None:
        noise = np.random.default_rng(1).integers(0, 256, (SIZE[1], SIZE[0], 3), np.uint8)
        self._image = Image(
            height=SIZE[1], width=SIZE[0], step=SIZE[0] * 3, encoding="bgr8", data=noise.tobytes()
        )
        self._publisher = rospy.Publisher("/noise", Image, queue_size=1)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def close(self) -> None:
        self._ended.set()
        self._thread.join()
        self._publisher.unregister()

    def _run(self) -> None:
        while not self._ended.wait(0.1):
            self._image.header.stamp = rospy.Time.now()
            self._publisher.publish(self._image)


async def _stall(port: int, sizes: List[int]) -> Any:
    """Opens a page that reads, but acknowledges nothing."""
    request = HTTPRequest(f"ws://127.0.0.1:{port}/ws?token={TOKEN}")
    page = await websocket_connect(request, max_message_size=1 << 26)
    wanted = {"op": "image", "id": 1, "channel": 1, "topic": "/noise"}
    await page.write_message(json.dumps(wanted))
    frames = 0
    while frames < 2:
        message = await page.read_message()
        if isinstance(message, bytes):
            frames += 1
            sizes.append(len(message))
    return page


async def stalled_memory(port: int, process: psutil.Process, seconds: float) -> Tuple[float, float]:
    """Returns MB that a stalled viewer takes, and those of two frames."""
    sizes: List[int] = []
    pages = [await _stall(port, sizes)]
    await asyncio.sleep(seconds)
    before = process.memory_info().rss
    pages += [await _stall(port, sizes) for _ in range(STALLED)]
    await asyncio.sleep(seconds)
    grown = process.memory_info().rss - before
    for page in pages:
        page.close()
    return grown / STALLED / 1e6, 2 * statistics.median(sizes) / 1e6


def all_figures(bench: Bench) -> List[Accuracy]:
    found = []
    for viewers in (1, 8):
        say(f"encodings of a frame, {counted(viewers)}")
        value = encodings(viewers)
        found.append(Accuracy("encodings", counted(viewers), "a frame", value, most=1.0))
    port = support.free_port()
    process = support.Process(dashboard(port), bench.folder / "dashboard.log")
    try:
        process.wait_for_output("dashboard: http://")
        found += _of_process(psutil.Process(process.pid), port, bench.seconds)
    finally:
        process.end()
    return found


def _of_process(process: psutil.Process, port: int, seconds: float) -> Iterator[Accuracy]:
    say("dashboard without a viewer")
    if not rospy.core.is_initialized():
        rospy.init_node("dashboard_figures", disable_signals=True)
    camera = _Camera()
    try:
        time.sleep(WARM_UP)
        begin, before = time.monotonic(), sum(process.cpu_times()[:2])
        time.sleep(max(4.0 * seconds, 10.0))  # in which there are some ticks of its clock
        cpu = sum(process.cpu_times()[:2]) - before
        core = cpu / (time.monotonic() - begin) * 1e2
        yield Accuracy("CPU", "no viewer", "% of a core", core, most=IDLE_CORE)
        say("memory of stalled viewers")
        memory, frames = asyncio.run(stalled_memory(port, process, max(seconds, 2.0)))
        yield Accuracy("memory", "a stalled viewer", "MB", memory, most=frames)
    finally:
        camera.close()
