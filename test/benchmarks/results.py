"""What the benchmarks measure: plain data, which tables.py writes and plot.py draws."""

import dataclasses
from typing import Any, Dict, List, Optional, Tuple

Size = Tuple[int, int]


@dataclasses.dataclass
class Figures:
    """What one contender cost: CPU ms per frame and % of a core, latencies in ms, % of frames."""

    cpu_ms: float
    core: float
    median: float
    p99: float
    arrived: float
    same: float  # % of a result's pixels that are as expected; negative: not compared
    found: float  # % of the frames sent in which all was found; negative: not looked for


@dataclasses.dataclass
class Comparison:
    """What each of the contenders, ours first, cost with images of one size."""

    title: str
    size: Size
    names: List[str]
    figures: List[Figures]


@dataclasses.dataclass
class Target:
    """What a figure of ours (a field of Figures) may be at most, as a ratio to another's.

    Of the frames that arrived and those in which all was found it is the least. Without another the
    ratio is that to all frames, and of a time the limit is in ms. With `titles` the figures of
    these comparisons are added up.
    """

    title: str
    size: Size
    against: str  # what the other's name begins with
    figure: str
    limit: float
    titles: Tuple[str, ...] = ()  # empty: the comparison is that of the title


@dataclasses.dataclass
class Parts:
    """A comparison in whose node this work on pixels is done: where the node's time goes."""

    title: str
    size: Size
    work: str


@dataclasses.dataclass
class Kernel:
    """Work on pixels: medians in ms per frame, and how many times as fast ours is to be."""

    work: str
    against: str
    size: Size
    instructions: str
    threads: int
    theirs_ms: float
    ours_ms: float
    goal: float

    @property
    def times(self) -> float:
        return self.theirs_ms / self.ours_ms


@dataclasses.dataclass
class Accuracy:
    """A figure of ours alone, and between which it is to be; None: there is no such limit."""

    work: str
    of: str  # in which it is one of several: a size, a sensor
    figure: str
    value: float
    least: Optional[float] = None
    most: Optional[float] = None


@dataclasses.dataclass
class Growth:
    """The CPU time of a frame in ms, for numbers of something."""

    title: str
    of: str  # what there are more and more of
    numbers: List[float]
    cpu_ms: List[float]


@dataclasses.dataclass
class Machine:
    """Where and when it was measured: lines of text, and what else the machine had to do."""

    lines: List[str]
    load: float  # average at the start
    others: float  # share of all processors' time that went to other work, 0 to 1


def to_kernels(runs: List[Dict[str, Any]]) -> List[Kernel]:
    """What Google Benchmark tells of bench_kernels as JSON: of its repetitions the least."""
    best: Dict[str, Kernel] = {}
    for run in runs:
        if run["run_type"] != "iteration":
            continue
        if run.get("error_occurred"):
            raise RuntimeError("{}: {}".format(run["name"], run["error_message"]))
        work, size, instructions, threads = run["run_name"].rsplit("/", 4)[:4]
        width, height = map(int, size.split("x"))
        kernel = Kernel(
            work=work,
            against=run["label"],
            size=(width, height),
            instructions=instructions,
            threads=int(threads),
            theirs_ms=run["theirs_ms"],
            ours_ms=run["ours_ms"],
            goal=run["goal"],
        )
        key = f"{run['run_name']} {kernel.against}"
        known = best.setdefault(key, kernel)
        known.theirs_ms = min(known.theirs_ms, kernel.theirs_ms)
        known.ours_ms = min(known.ours_ms, kernel.ours_ms)
    return list(best.values())
