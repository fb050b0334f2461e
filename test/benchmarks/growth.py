"""How the cost of a frame grows with the number of something."""

from typing import Any, List, Sequence

from contenders import STEPS, node
from measuring import RATE, Bench, Contender
from results import Growth, Size

SIZES = ((320, 240), (640, 480), (1280, 720), (1920, 1080), (2560, 1440), (3840, 2160))
NUMBERS = (1, 2, 4, 8)
SMALL: Size = (640, 480)
LARGE: Size = (1280, 720)
TAGS = (0, 2, 20, 100)
FACES = (0, 1, 4, 16)
OBJECTS = (0, 1, 4, 16, 64)


def by_size(bench: Bench) -> List[Growth]:
    sizes = ",".join("{}x{}".format(*size) for size in SIZES)
    growths = {}
    for kernel in bench.kernels("--growth", f"--sizes={sizes}"):
        growth = Growth(kernel.work, "megapixels", [], [])
        growth = growths.setdefault(kernel.work, growth)
        growth.numbers.append(kernel.size[0] * kernel.size[1] * 1e-6)
        growth.cpu_ms.append(kernel.ours_ms)
    return list(growths.values())


def by_nodelets(bench: Bench) -> Growth:
    """A manager with a camera, and brightness nodelets one after the other."""

    def contender(number: int) -> Contender:
        kind, name, _ = STEPS[0]
        source = [f"_source:={bench.image(SMALL)}", f"_framerate:={float(RATE)}"]
        load = ["load", "robot_vision/" + kind, "vision", *source]
        commands = [node("nodelet", "nodelet", "vision", "manager")]
        commands.append(node("nodelet", "nodelet", name, *load))
        image = f"/{name}/image_raw"
        for i in range(number):
            name = f"brightness_{i}"
            load = ["load", "robot_vision/brightness", "vision", "image:=" + image]
            commands.append(node("nodelet", "nodelet", name, *load))
            image = f"/{name}/processed_image"
        return Contender(f"{number} nodelets", commands, image, own_camera=True)

    return of_nodes(bench, "brightness in one manager, 640x480", "nodelets", contender)


def by_subscribers(bench: Bench) -> Growth:
    def contender(number: int) -> Contender:
        result = "/brightness/processed_image"
        ours = node("robot_vision", "brightness_node", "brightness", "image:=/camera/image")
        others = [
            bench.program("plain_receiver", "image:=" + result, f"__name:=receiver_{i}")
            for i in range(number - 1)
        ]
        return Contender(f"{number} subscribers", [ours], result, beside=others)

    return of_nodes(bench, "brightness_node, 640x480 bgr8", "subscribers", contender)


def of_nodes(bench: Bench, title: str, of: str, contender: Any) -> Growth:
    comparison = bench.compare(title, SMALL, [contender(number) for number in NUMBERS])
    return Growth(title, of, list(NUMBERS), [figures.cpu_ms for figures in comparison.figures])


def by_tags(bench: Bench) -> Growth:
    costs = [bench.tags(LARGE, number)["measuring"]["cpu"] for number in TAGS]
    return Growth("tags and their corners, 1280x720", "tags", list(TAGS), costs)


def by_findings(bench: Bench, kind: str, numbers: Sequence[int]) -> Growth:
    results = bench.findings(LARGE, kind, numbers)
    found = ", ".join(f"{number}: {count}" for number, _, count in results)
    title = f"{kind}, 1280x720 (found of {found})"
    return Growth(title, kind, list(numbers), [cost for _, cost, _ in results])


def all_growths(bench: Bench) -> List[Growth]:
    return [
        *by_size(bench),
        by_nodelets(bench),
        by_subscribers(bench),
        by_tags(bench),
        by_findings(bench, "faces", FACES),
        by_findings(bench, "objects", OBJECTS),
    ]
