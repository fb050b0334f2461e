"""The node object_detector, and a network with the usual Python around it."""

import json
import os
from pathlib import Path
from typing import List, Tuple

import cv2
from measuring import HERE, RATE, Bench, Command, Contender, Contenders
from nano_network import SIDE, nano_file
from node_commands import IMAGE, node
from plain_network import PlainDetector
from results import Size, Target

from robot_vision.dnn.onnxruntime_folder import find_onnxruntime

SIZE: Size = (640, 480)
FRAMES, STEP = 8, 4  # of movingImage() in measure.hpp: how many, and px from one to the next
WARM_UP = 3  # s, as what imports and reads more than others
NAMES = {"onnxruntime": "onnxruntime", "opencv": "cv2.dnn"}
OURS = "object_detector.py, "
PLAIN = "rospy + cv_bridge + NumPy + "
LATENCY = 18.0  # ms from the image to the result, on one core

Paths = Tuple[str, str]


def title(cores: int) -> str:
    return "Object detection, " + ("on one core" if cores == 1 else f"on {cores} cores")


def runtimes() -> List[str]:
    """What can run a network here, the fastest first."""
    return ["onnxruntime", "opencv"] if find_onnxruntime()[0] else ["opencv"]


def on_cores(cores: int, command: Command) -> Command:
    """A command that has only so many cores for all its threads."""
    there = sorted(os.sched_getaffinity(0))[-cores:]
    return ["taskset", "--cpu-list", ",".join(map(str, there)), *command]


def ours(bench: Bench, runtime: str, threads: int, track: bool) -> Command:
    words = {"backend": runtime, "threads": threads, "track": str(track).lower()}
    settings = [f"_{name}:={value}" for name, value in words.items()]
    model = f"_model:={nano_file(bench.folder)}"
    command = node("robot_vision", "object_detector.py", "object_detector", IMAGE, model)
    return command + settings


def nodes(cores: int) -> Contenders:
    """From images to messages with boxes; each of them must have the same boxes."""

    def contenders(bench: Bench, size: Size) -> List[Contender]:
        model = [str(nano_file(bench.folder)), str(cores), str(SIDE)]
        expected = str(expected_objects(bench, size))

        def contender(name: str, command: Command, of: str) -> Contender:
            listener = [str(HERE / "object_listener"), of + "/detections", expected]
            return Contender(name, [command], listener=listener, warm_up=WARM_UP, certain=True)

        found = []
        for runtime in runtimes():
            command = on_cores(cores, ours(bench, runtime, cores, track=False))
            found.append(contender(OURS + NAMES[runtime], command, "/object_detector"))
        for runtime in runtimes():
            command = [str(HERE / "course_network"), runtime, *model, IMAGE, "__name:=course"]
            found.append(contender(PLAIN + NAMES[runtime], on_cores(cores, command), "/course"))
        for runtime in runtimes():
            times = str(bench.seconds), str(RATE)
            command = on_cores(cores, [str(HERE / "network_alone"), runtime, *model, *times])
            found.append(Contender(f"{NAMES[runtime]} alone, no ROS", alone=command))
        return found

    return contenders


def expected_objects(bench: Bench, size: Size) -> Path:
    """What is found in each of the frames that latency_probe shows, as object_listener reads it."""
    path = bench.folder / "objects_{}x{}.json".format(*size)
    if not path.exists():
        detector = PlainDetector("opencv", str(nano_file(bench.folder)), 1, SIDE)
        photograph = cv2.imread(str(bench.image(size)))
        width, height = size
        moved = FRAMES * STEP
        large = cv2.resize(
            photograph, (width + moved, height + moved), interpolation=cv2.INTER_CUBIC
        )
        frames = [large[at : at + height, at : at + width] for at in range(0, moved, STEP)]
        objects = [detector.detect(frame) for frame in frames]
        if not all(objects):
            raise RuntimeError("the network finds nothing in a frame")
        path.write_text(json.dumps(objects))
    return path


def targets() -> List[Target]:
    """What ours, by the fastest runtime there is, may take on one core."""
    return [
        Target(title(1), SIZE, "", "median", LATENCY),
        Target(title(1), SIZE, PLAIN + NAMES["onnxruntime"], "cpu_ms", 1.0),
        Target(title(1), SIZE, PLAIN + NAMES["opencv"], "cpu_ms", 1.0),
    ]
