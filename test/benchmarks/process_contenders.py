"""A camera and those who receive its frames: in one process, in a nodelet manager, over TCP."""

from typing import List

from measuring import HERE, RATE, Bench, Command, Contender
from node_commands import node
from results import Size, Target

TITLE = "A camera and who receives its frames"
OURS = "one process, {} in Python"
DRAWN = "A camera that draws its frames where they are sent from, and a Python node in its process"
COUNTS = (1, 4, 12)  # nodes of a process
RECEIVER = str(HERE / "process_receiver")
CAMERA = "image:=/camera/image_raw"
MAX_LATENCY = 0.5  # ms, from the camera to the callback


def contender(name: str, *commands: Command) -> Contender:
    return Contender(name, list(commands), own_camera=True, warm_up=3)


def drawn(_bench: Bench, size: Size) -> List[Contender]:
    return [contender(counted(1), [RECEIVER, "{}x{}".format(*size), str(RATE), "1"])]


def counted(nodes: int) -> str:
    return OURS.format(f"{nodes} node" + ("s" if nodes > 1 else ""))


def nodes(bench: Bench, size: Size) -> List[Contender]:
    source = [f"_source:={bench.image(size)}", f"_framerate:={float(RATE)}"]
    camera = node("robot_vision", "camera_node", "camera", *source)
    python = [str(HERE / "python_receiver"), CAMERA]
    plain = bench.program("plain_receiver", CAMERA)
    own = [RECEIVER, str(bench.image(size)), str(RATE)]

    return [
        *(contender(counted(count), [*own, str(count)]) for count in COUNTS),
        contender("one process, both C++", [*plain, f"_nodelet_source:={bench.image(size)}"]),
        contender("TCP: roscpp, does nothing", plain, camera),
        contender(
            "another process: robot_vision.transport, a view", [*python, "transport"], camera
        ),
        contender("TCP: rospy + cv_bridge", [*python, "rospy"], camera),
    ]


def targets() -> List[Target]:
    return [
        *(Target(title, (1920, 1080), "", "median", MAX_LATENCY) for title in (TITLE, DRAWN)),
        Target(TITLE, (1920, 1080), "another process: robot_vision.transport", "cpu_ms", 1.0),
    ]
