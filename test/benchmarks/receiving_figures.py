"""What receiving in another process costs, over shm and over raw, by size and by subscribers."""

import contextlib
import json
import os
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Tuple

import support
from measuring import RATE, Bench, say
from results import Accuracy
from tables import accuracies_table, size_name, table

SIZES = ((640, 480), (1920, 1080), (3840, 2160))
MANY = 8
RUNS = (("raw", 1), ("shm", 1), ("raw", MANY), ("shm", MANY))
WARM_UP = 4.0  # s, in which subscriptions come to rest
RECEIVE, LATENCY = 0.1, 1.0  # ms of CPU for a frame, and from the stamp: the goals at 1920x1080
SIZES_ALIKE, MANY_ALIKE = 1.1, 1.2  # times, the goals
TITLE = "Receiving in another process, over raw and over shm"
TEXT = f"""One publisher sends the same image at {RATE} Hz, each time a copy; its subscribers do
nothing with it. CPU is that of a process less what it costs while no frames come, in ms for a
frame; latency is from the stamp, before the copy, to the callback, p50 in ms. All of a size are
measured in turns.

"""


class Costs(NamedTuple):
    publisher: float  # CPU, s per s
    subscriber: float  # of each
    latency: float  # ms, the median
    rate: float  # Hz, of frames that each subscriber got


class Receiving(NamedTuple):
    """ms of CPU for a frame, ms from the stamp, and Hz."""

    publisher: float
    subscriber: float
    latency: float
    rate: float


Figures = Dict[Tuple[int, int], Dict[Tuple[str, int], Receiving]]  # by size, transport, subscribers


def all_figures(bench: Bench) -> str:
    figures = {size: of_size(bench, size) for size in SIZES}
    return f"{TEXT}{costs_table(figures)}\n{accuracies_table(goals(figures))}"


def of_size(bench: Bench, size: Tuple[int, int]) -> Dict[Tuple[str, int], Receiving]:
    costs: Dict[Tuple[str, int], List[Costs]] = {}
    idle: Dict[int, List[Costs]] = {}
    for turn in range(bench.rounds):
        for way, count in RUNS:
            say(f"receiving, {size_name(size)}, round {turn + 1}: {way}, {count}")
            costs.setdefault((way, count), []).append(measure(bench, size, way, count, RATE))
        for count in (1, MANY):
            idle.setdefault(count, []).append(measure(bench, size, "raw", count, 0.0))
    return {
        (way, count): above(median(rounds), median(idle[count]))
        for (way, count), rounds in costs.items()
    }


def measure(bench: Bench, size: Tuple[int, int], way: str, count: int, rate: float) -> Costs:
    with contextlib.ExitStack() as stack, tempfile.TemporaryDirectory() as folder:

        def start(name: str, *words: Any) -> support.Process:
            command = bench.program(name, "image:=/camera/image", *words)
            process = support.Process(command, Path(folder, f"{len(os.listdir(folder))}.log"))
            stack.callback(process.end)
            return process

        subscribers = [
            start("transport_receiver", f"_image_transport:={way}", f"__name:=receiver_{number}")
            for number in range(count)
        ]
        width, height = size
        source = start("image_source", f"_width:={width}", f"_height:={height}", f"_rate:={rate}")
        time.sleep(WARM_UP)
        begin, before = time.time(), [run_time_of(one) for one in (source, *subscribers)]
        time.sleep(2.0 * bench.seconds)
        end, after = time.time(), [run_time_of(one) for one in (source, *subscribers)]
        used = [(b - a) / (end - begin) for a, b in zip(before, after)]
        arrivals = []
        for process in subscribers:
            process.interrupt()
            process.exit_code()
            arrivals += json.loads(process.output().splitlines()[-1])
    latencies = [latency for stamp, latency in arrivals if begin < stamp < end]
    if rate > 0.0 and not latencies:
        raise RuntimeError(f"{way}: no frames have arrived")
    got = len(latencies) / count / (end - begin)
    latency = statistics.median(latencies) if latencies else 0.0
    return Costs(used[0], statistics.mean(used[1:]), latency, got)


def run_time_of(process: support.Process) -> float:
    """Seconds that the threads of a process have run, to the nanosecond: clock ticks are 10 ms."""
    threads = Path(f"/proc/{process.pid}/task").iterdir()
    return sum(int((thread / "schedstat").read_text().split()[0]) for thread in threads) * 1e-9


def median(rounds: List[Costs]) -> Costs:
    return Costs(*map(statistics.median, zip(*rounds)))


def above(taken: Costs, idle: Costs) -> Receiving:
    """What frames cost beyond what the processes take while none come."""
    publisher, subscriber = (
        (with_frames - without) / RATE * 1e3 for with_frames, without in zip(taken[:2], idle[:2])
    )
    return Receiving(publisher, subscriber, taken.latency, taken.rate)


def costs_table(figures: Figures) -> str:
    columns = ["image, subscribers", "CPU of the publisher: raw", "shm"]
    columns += ["of each subscriber: raw", "shm", "latency: raw", "shm", "Hz: raw", "shm"]
    rows = []
    for size, found in figures.items():
        for count in (1, MANY):
            raw, shm = found["raw", count], found["shm", count]
            row = [f"{size_name(size)}, {count}"]
            for which, digits in zip(Receiving._fields, (2, 3, 2, 1)):
                row += [f"{getattr(one, which):.{digits}f}" for one in (raw, shm)]
            rows.append(row)
    return table(columns, rows)


def goals(figures: Figures) -> List[Accuracy]:
    one = {size: found["shm", 1] for size, found in figures.items()}
    many = figures[SIZES[1]]["shm", MANY]
    middle, name = one[SIZES[1]], f"shm, {size_name(SIZES[1])}"
    received = [of_size.subscriber for of_size in one.values()]
    return [
        Accuracy("receiving", name, "CPU ms/frame", middle.subscriber, most=RECEIVE),
        Accuracy("receiving", name, "p50 ms", middle.latency, most=LATENCY),
        Accuracy(
            "receiving",
            "shm, the largest of all sizes to the smallest",
            "CPU, times",
            max(received) / min(received),
            most=SIZES_ALIKE,
        ),
        Accuracy(
            "publishing",
            f"{name}, {MANY} subscribers to one",
            "CPU, times",
            many.publisher / middle.publisher,
            most=MANY_ALIKE,
        ),
        Accuracy(
            "receiving",
            f"{name}, {MANY} subscribers to one",
            "CPU of each, times",
            many.subscriber / middle.subscriber,
            most=MANY_ALIKE,
        ),
    ]
