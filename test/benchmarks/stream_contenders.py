"""Streams to several viewers: the dashboard beside web_video_server's algorithm."""

from typing import List

import support
from measuring import HERE, RATE, Bench, Command, Contender
from node_commands import IMAGE, TOPIC, node
from results import Size, Target

TITLE = "Streams to viewers, JPEG of quality 80"
PASSED = "An MJPEG camera's stream to viewers"
VIEWERS = (8, 4, 2, 1)  # the first are those that the others are compared with
QUALITY = 80
WARM_UP = 12  # s, in which all have started, where nothing else waits for that
TOKEN = "token-of-the-benchmark"
OURS, PLAIN = "dashboard", "one encoding for each"


def counted(viewers: int) -> str:
    return f"{viewers} viewer" + ("s" if viewers > 1 else "")


def dashboard(port: int) -> Command:
    options = (f"_port:={port}", f"_token:={TOKEN}", f"_quality:={QUALITY}")
    return node("robot_vision", "dashboard.py", "dashboard", *options)


def looking(kind: str, port: int, viewers: int, topic: str = TOPIC) -> Command:
    return [str(HERE / "stream_viewers"), kind, str(port), TOKEN, topic, str(viewers)]


def streams(_bench: Bench, _size: Size) -> List[Contender]:
    contenders = []
    for viewers in VIEWERS:
        port = support.free_port()
        listener = looking("dashboard", port, viewers)
        name = f"{OURS}, {counted(viewers)}"
        contenders.append(Contender(name, [dashboard(port)], listener=listener, warm_up=3))
    for viewers in VIEWERS:
        port = support.free_port()
        command = [str(HERE / "plain_streams"), str(port), str(QUALITY), IMAGE]
        listener = looking("plain", port, viewers)
        name = f"{PLAIN}, {counted(viewers)}"
        contenders.append(Contender(name, [command], listener=listener, warm_up=3))
    return contenders


def passed_on(bench: Bench, size: Size) -> List[Contender]:
    contenders = []
    topic = TOPIC + "/compressed"
    source = [str(HERE / "jpeg_source"), str(bench.image(size)), *map(str, size), str(RATE)]
    for viewers in (8, 1):
        port = support.free_port()
        contenders.append(
            Contender(
                f"{OURS}, {counted(viewers)}",
                [dashboard(port)],
                own_camera=True,
                listener=looking("dashboard", port, viewers, topic),
                beside=[[*source, f"image:={topic}"]],
                warm_up=WARM_UP,
            )
        )
    return contenders


def targets() -> List[Target]:
    full = (1920, 1080)
    eight = counted(8)
    return [
        Target(TITLE, full, f"{OURS}, {counted(1)}", "cpu_ms", 1.25),
        Target(TITLE, full, f"{PLAIN}, {eight}", "cpu_ms", 1 / 4),
        Target(PASSED, full, "", "cpu_ms", 1.0),
    ]
