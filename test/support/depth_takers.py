"""Shared by tests of nodes that take depth images: each of them, with what it takes besides."""

import re
import time
from typing import Any, Callable, List, NamedTuple, Tuple

import numpy as np
import support
from frames import Source
from rgbd_cameras import SIZES, RgbdCameras
from sensor_msgs.msg import Image
from std_msgs.msg import Header

import robot_vision as rv
from robot_vision.msg import Detection3DArray, DetectionArray, TableArray, TagDetectionArray
from robot_vision.ros.messages import box_detection

WIDTH, HEIGHT = SIZES["depth"]
METRES = np.full((HEIGHT, WIDTH), 2.0, np.float32)
METRES[10:30, 20:40] = 1.2
MILLIMETRES = (METRES * 1000).astype(np.uint16)
CELL = 6  # px, of the tag


class Others:
    """What a node takes besides depths; here nothing."""

    def __init__(self, cameras: RgbdCameras):
        self.cameras = cameras
        self.sources: List[Source] = []

    def send(self, stamp: Any) -> None:
        """Sends it with the stamp of the depths."""


class OneDetection(Others):
    """A detection where the depths show something near."""

    def __init__(self, cameras: RgbdCameras):
        super().__init__(cameras)
        self.sources = [Source(f"{cameras.namespace}/found", DetectionArray)]

    def send(self, stamp: Any) -> None:
        header = Header(stamp=stamp, frame_id=self.cameras.frames["depth"])
        found = [box_detection((20, 10, 20, 20), "thing", 0)]
        self.sources[0].send(DetectionArray(header, WIDTH, HEIGHT, found))


class TagImage(Others):
    """The image of a tag, which fills it, in the frame of the depths, as registered ones have."""

    def __init__(self, cameras: RgbdCameras):
        super().__init__(cameras)
        cameras.frames["rgb"] = cameras.frames["depth"]
        self.sources = [cameras.images["rgb"]]
        width, height = SIZES["rgb"]
        tag = np.kron(rv.tag_cells("tag36h11", 5), np.ones((CELL, CELL), np.uint8))
        x, y = (width - tag.shape[1]) // 2, (height - tag.shape[0]) // 2
        self._image = np.full((height, width), 255, np.uint8)
        self._image[y : y + tag.shape[0], x : x + tag.shape[1]] = tag

    def send(self, stamp: Any) -> None:
        self.cameras.send("rgb", self._image, "mono8", stamp)


class Node(NamedTuple):
    """A node that takes depths of RgbdCameras."""

    program: str
    arguments: Callable[[RgbdCameras], List[str]]  # that say where the cameras are
    name: Callable[[RgbdCameras], str]
    output: Callable[[RgbdCameras], Tuple[str, Any]]  # a topic that has a message for each frame
    infos: Tuple[str, ...] = ("depth",)  # whose calibration it takes
    others: Callable[[RgbdCameras], Others] = Others
    counts: bool = True  # depths that it refuses, on /diagnostics


def named_taker(*words: str) -> List[str]:
    return ["__name:=taker", *words]


NODES = {
    "depth_registration": Node(
        "depth_registration_node",
        lambda cameras: named_taker(*cameras.arguments()),
        lambda cameras: f"{cameras.namespace}/taker",
        lambda cameras: (cameras.output("image_raw"), Image),
        infos=("depth", "rgb"),
    ),
    "tabletop": Node(
        "tabletop.py",
        lambda cameras: named_taker(f"image:={cameras.topic('depth', 'image_raw')}"),
        lambda cameras: "/taker",
        lambda cameras: ("/taker/tables", TableArray),
    ),
    "detections_3d": Node(
        "detections_3d.py",
        lambda cameras: named_taker(
            f"depth:={cameras.topic('depth', 'image_raw')}",
            f"detections:={cameras.namespace}/found",
        ),
        lambda cameras: "/taker",
        lambda cameras: ("/taker/detections", Detection3DArray),
        others=OneDetection,
    ),
    "apriltag_detector": Node(  # whose images go on without depth, and are what it counts
        "apriltag_detector.py",
        lambda cameras: named_taker(
            f"image:={cameras.topic('rgb', 'image_raw')}",
            f"depth:={cameras.topic('depth', 'image_raw')}",
        ),
        lambda cameras: "/taker",
        lambda cameras: ("/taker/tags", TagDetectionArray),
        infos=("depth", "rgb"),
        others=TagImage,
        counts=False,
    ),
}


class Taker:
    """One of these nodes, its cameras and what it answers."""

    def __init__(self, start: Any, kind: str):
        node = NODES[kind]
        self.begin = time.monotonic()
        self.cameras = RgbdCameras()
        self._others = node.others(self.cameras)
        words = node.arguments(self.cameras)
        self.process = start(node.program, *words, "_diagnostic_period:=0.02")
        self.name = node.name(self.cameras).lstrip("/")
        self.answers = support.subscribed(*node.output(self.cameras))
        self.cameras.place()
        images = self.cameras.images["depth"], *self._others.sources
        for source in (*images, *map(self.cameras.infos.get, node.infos)):
            source.wait_for()
        self.topic = self.cameras.topic("depth", "image_raw")

    def show(self, depth: np.ndarray, encoding: str) -> Any:
        """Sends depths, and what else the node takes; returns their stamp."""
        stamp = self.cameras.next_stamp()
        self.cameras.send_infos()
        self.cameras.send("depth", depth, encoding, stamp)
        self._others.send(stamp)
        return stamp

    def shows_until(self, condition: Callable[[], Any], what: str, *frame: Any) -> Any:
        """Shows a frame until the condition holds; returns its value."""

        def fulfilled() -> Any:
            self.show(*frame)
            return condition()

        return support.wait_for(fulfilled, what)

    def lines(self, said: str) -> List[str]:
        """The lines of its output with a text, or a regular expression."""
        return [line for line in self.process.output().splitlines() if re.search(said, line)]

    def answer(self, depth: np.ndarray = MILLIMETRES, encoding: str = "16UC1") -> Any:
        """What it makes of a frame; the frame is shown again until that comes."""
        first = self.show(depth, encoding)  # answers to what was shown before may still come

        def answers() -> List[Any]:
            return [one for one in self.answers.received if support.stamp_of(one) >= first]

        return self.shows_until(answers, "an answer", depth, encoding)[-1]
