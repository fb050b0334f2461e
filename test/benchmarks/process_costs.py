"""CPU time and memory of running processes, by their names."""

import contextlib
import dataclasses
import os
import re
import time
from typing import Dict, List, Sequence

import psutil

MB = 1e6
LOADERS = "loaders of nodelets"


@dataclasses.dataclass
class ProcessCost:
    """What the processes of one name take: % of a core, and MB of memory (PSS)."""

    core: float
    memory: float
    count: int = 1


def name_of(command: List[str]) -> str:
    """The node that a command line is of, or its program."""
    if "load" in command[1:3]:
        return LOADERS
    for word in command:
        if word.startswith("__name:="):
            return word.partition(":=")[2]
    programs = [word for word in command[:2] if not re.match(r"python[0-9.]*$", base(word))]
    return base(programs[0]) if programs else "python"


def base(path: str) -> str:
    return os.path.basename(path)


def memory_of(pid: int, kinds: Sequence[str] = ("Pss",)) -> float:
    """MB of a process, of these kinds; what it shares with others is shared out among them."""
    with open(f"/proc/{pid}/smaps_rollup", encoding="ascii") as rollup:
        lines = (line.split() for line in rollup if " kB" in line)
        return sum(int(line[1]) for line in lines if line[0][:-1] in kinds) * 1024 / MB


def cpu_of(process: psutil.Process) -> float:
    """Seconds that a process has worked, without its children."""
    times = process.cpu_times()
    return times.user + times.system


def costs_of(pid: int, seconds: float) -> Dict[str, ProcessCost]:
    """Watches a process and all below it for some time; the costs by name, the largest first."""
    root = psutil.Process(pid)
    before = {process: cpu_of(process) for process in [root, *root.children(recursive=True)]}
    begin = time.monotonic()
    time.sleep(seconds)
    passed = time.monotonic() - begin
    costs: Dict[str, ProcessCost] = {}
    for process, cpu in before.items():
        with contextlib.suppress(psutil.NoSuchProcess, FileNotFoundError):  # It may have ended.
            one = ProcessCost((cpu_of(process) - cpu) / passed * 1e2, memory_of(process.pid))
            name = name_of(process.cmdline())
            known = costs.setdefault(name, ProcessCost(0.0, 0.0, 0))
            known.core += one.core
            known.memory += one.memory
            known.count += 1
    return dict(sorted(costs.items(), key=lambda item: -item[1].memory))


def total(costs: Dict[str, ProcessCost]) -> ProcessCost:
    values = list(costs.values())
    return ProcessCost(
        sum(cost.core for cost in values),
        sum(cost.memory for cost in values),
        sum(cost.count for cost in values),
    )
