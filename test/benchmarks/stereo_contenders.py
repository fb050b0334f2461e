"""The node stereo_matcher beside stereo_image_proc, on the same topics of the scene's pair."""

from typing import List, Tuple

from measuring import HERE, Bench, Command, Contender
from node_commands import installed, node
from results import Size, Target

RATE = 10  # Hz: two cores have to draw the scene as well
WARM_UP = 5  # s, until the camera has been opened and both its images have come
TITLE = "Stereo: disparities by block matching"
THEIRS = "stereo_image_proc"

# The defaults of stereo_image_proc, which are not ours.
SAME = (
    *("method:=bm", "disp12_max_diff:=-1", "uniqueness_ratio:=15", "speckle_range:=4.0"),
    "full_image:=false",
)


def camera(name: str, size: Size) -> Command:
    words = "_views:=stereo", "_source:=synthetic", f"_framerate:={float(RATE)}"
    sides = (f"_image_{side}:={px}" for side, px in zip(("width", "height"), size))
    return node("robot_vision", "camera_node", name, *words, *sides)


def nodes(_bench: Bench, size: Size) -> List[Contender]:
    topics = [f"{side}/image_raw" for side in ("left", "right")]  # camera_info is beside them
    words = [f"{topic}:=/eyes/{topic}" for topic in topics]
    words += [f"_{setting}" for setting in SAME]
    ours = node("robot_vision", "stereo_matcher_node", "stereo_matcher", *words)

    def contender(name: str, command: Command, topic: str) -> Contender:
        return Contender(
            name,
            [command],
            own_camera=True,
            listener=[str(HERE / "disparity_listener"), topic],
            beside=[camera("eyes", size)],
            rate=RATE,
            warm_up=WARM_UP,
        )

    found = [contender("stereo_matcher_node", ours, "/stereo_matcher/disparity")]
    if installed(THEIRS, THEIRS):
        theirs = node(THEIRS, THEIRS, THEIRS, "__ns:=/eyes")
        found.append(contender(THEIRS, theirs, "/eyes/disparity"))
    return found


def targets(sizes: Tuple[Size, ...]) -> List[Target]:
    """What ours may take beside theirs."""
    return [Target(TITLE, size, THEIRS, "cpu_ms", 1.0) for size in sizes]
