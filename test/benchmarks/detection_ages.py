"""How old what object_detector publishes is, while it follows things at the camera's rate."""

import json
import statistics
from typing import Dict, Iterator, List

from detection_contenders import NAMES, OURS, SIZE, WARM_UP, ours, runtimes
from measuring import HERE, RATE, STAMP_ERROR, Bench, Contender, percentile, say
from results import Accuracy

FRAME = 1e3 / RATE  # ms
TOLD = 98.0  # % of the frames, whose objects are to be told
WORKS = {
    "detections": "age of ~detections",
    "objects": "age of ~objects",
    "known": "age of what ~objects knows",
}
TITLE = "Object detection, how old it is"
TEXT = f"""### {TITLE}, 640x480

While things are followed at 30 Hz, the network on one thread at its own rate. Detections and
objects are as old as their image when they arrive. What objects know is as old as the image of the
newest detections that are in them, which their scores tell. The goal is one inference (the median
age of detections) and a frame.

"""

Ages = Dict[str, List[float]]


def all_ages(bench: Bench) -> List[Accuracy]:
    """For each runtime: the ages of detections, and of what the objects of all frames know."""
    told: Dict[str, List[Ages]] = {runtime: [] for runtime in runtimes()}
    for turn in range(bench.rounds):
        for runtime in told:
            say(f"round {turn + 1}: ages of objects, {NAMES[runtime]}")
            told[runtime].append(ages(bench, runtime))
    return [
        figure
        for runtime, rounds in told.items()
        for figure in figures(OURS + NAMES[runtime], rounds)
    ]


def ages(bench: Bench, runtime: str) -> Ages:
    """In ms: of detections, of objects, and of what the objects know; and of frames told of, %."""
    command = ours(bench, runtime, 1, track=True)
    listener = [str(HERE / "object_ages"), "/object_detector"]
    contender = Contender("ages", [command], listener=listener, still=True, warm_up=WARM_UP)
    result, output = bench.observe(SIZE, contender)
    # The last frame may be told of when the next one comes, which does not.
    begin, end = result["begin"] - STAMP_ERROR, result["end"] - STAMP_ERROR
    found = {
        name: [age for stamp, age in ages if begin < stamp < end]
        for name, ages in json.loads(output.splitlines()[-1]).items()
    }
    if not all(found.values()):
        raise RuntimeError(f"{NAMES[runtime]}: nothing is found, or nothing of it is followed")
    found["told"] = [len(found["objects"]) / (result["sent"] - 1) * 1e2]
    return found


def figures(of: str, rounds: List[Ages]) -> Iterator[Accuracy]:
    """Of all rounds together."""
    every = {name: [age for ages in rounds for age in ages[name]] for name in rounds[0]}
    most = statistics.median(every["detections"]) + FRAME
    yield Accuracy("frames with ~objects", of, "%", statistics.median(every["told"]), least=TOLD)
    for name, work in WORKS.items():
        yield Accuracy(work, of, "p50 ms", statistics.median(every[name]))
        yield Accuracy(work, of, "p99 ms", percentile(every[name], 0.99), most=most)
