"""What running processes hold, before and after something, and whether all was given back."""

import contextlib
import dataclasses
from typing import Dict, List, Optional, Sequence, Tuple

import psutil
from process_costs import LOADERS, memory_of, name_of
from tables import table

MAX_GROWTH = 0.1  # share of the memory, and MAX_MB: what an allocator may keep
MAX_MB = 8.0
# They keep what they were told of each topic and node, however it ends, and connections to it.
OF_ROS = ("rosmaster", "rosout")
WRITTEN = ("Pss_Anon", "Pss_Shmem")  # without files, which other processes may have mapped, too
MIN_FRAMES = 0.3  # share of the results before that must still come: a machine may be busy
MIN_COUNT = 30  # results before: fewer tell nothing


@dataclasses.dataclass
class Holdings:
    """Of one process: what it has open, its threads, and MB that it has written to."""

    descriptors: int
    threads: int
    memory: float


def holdings_of(pid: int, master_port: int = 0) -> Dict[str, Holdings]:
    """Of a process and of all below it, by name; loaders, which are alike, are left out.

    Connections to the master do not count, nor the master's threads for them: a process keeps as
    many as it once had calls at a time.
    """
    root = psutil.Process(pid)
    found = {}
    for process in [root, *root.children(recursive=True)]:
        with contextlib.suppress(psutil.NoSuchProcess, FileNotFoundError):
            name = name_of(process.cmdline())
            if name != LOADERS:
                calling, called = master_connections(process, master_port)
                found[name] = Holdings(
                    process.num_fds() - calling - called,
                    process.num_threads() - called,
                    memory_of(process.pid, WRITTEN),
                )
    return found


def master_connections(process: psutil.Process, port: int) -> Tuple[int, int]:
    """Returns how many connections a process has to the master, and how many it has as it."""
    open_ = [one for one in process.connections("tcp") if one.raddr]
    return (
        sum(one.raddr.port == port for one in open_),
        sum(one.laddr.port == port for one in open_),
    )


def most_of(readings: Sequence[Dict[str, Holdings]]) -> Dict[str, Holdings]:
    """Returns the most that each process held in any of these readings."""
    most: Dict[str, Holdings] = {}
    for reading in readings:
        for name, one in reading.items():
            known = most.get(name, one)
            most[name] = Holdings(
                max(known.descriptors, one.descriptors),
                max(known.threads, one.threads),
                max(known.memory, one.memory),
            )
    return most


def not_given_back(
    before: Dict[str, Holdings], after: Dict[str, Holdings], frames: Dict[str, Tuple[int, int]]
) -> List[str]:
    """Returns a line for each process that has gone or holds more, and each node that gives less.

    What rosmaster and rosout hold is not this package's.

    Args:
        before, after: By names of processes.
        frames: Results of each node in the same time, before and after.
    """
    lines = [f"{name} has gone" for name in before if name not in after]
    for name, now in after.items():
        if name in OF_ROS:
            continue
        then = before.get(name, now)
        if now.descriptors > then.descriptors:
            lines.append(f"{name} has {now.descriptors} descriptors, {then.descriptors} before")
        if now.threads > then.threads:
            lines.append(f"{name} has {now.threads} threads, {then.threads} before")
        if now.memory > then.memory * (1.0 + MAX_GROWTH) + MAX_MB:
            lines.append(f"{name} has {now.memory:.1f} MB, {then.memory:.1f} before")
    for node, (first, last) in frames.items():
        if first >= MIN_COUNT and last < MIN_FRAMES * first:
            lines.append(f"{node} gave {last} results, {first} before in the same time")
    return lines


def holdings_table(
    before: Dict[str, Holdings], after: Dict[str, Holdings], frames: Dict[str, Tuple[int, int]]
) -> str:
    """Returns what each process held, and how many results each node gave, before and after."""
    rows = []
    for name, then in before.items():
        pairs = zip(_cells(then), _cells(after.get(name)))
        rows.append([name, *(cell for pair in pairs for cell in pair)])
    columns = ["process", "descriptors", "after", "threads", "after", "MB", "after"]
    results = [[node, f"{first}", f"{last}"] for node, (first, last) in frames.items()]
    return table(columns, rows) + "\n" + table(["node", "results", "after"], results)


def _cells(one: Optional[Holdings]) -> List[str]:
    if one is None:
        return ["-"] * 3
    return [str(one.descriptors), str(one.threads), f"{one.memory:.1f}"]
