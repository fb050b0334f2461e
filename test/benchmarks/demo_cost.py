"""What demo.launch costs as a whole: CPU and memory of each process, and its start."""

import contextlib
import dataclasses
import json
import os
import subprocess
import time
from typing import Dict, Iterator, List, Optional, Sequence, Tuple

import measuring
import support
from process_costs import ProcessCost, costs_of, memory_of, total
from results import Accuracy
from ros_programs import program_of
from tables import accuracies_table, table

RESULTS = {  # of each node; those that are drawn for a viewer only are not among them
    "usb_cam": "/usb_cam/camera_info",
    "brightness": "/brightness/processed_image",
    "edge_detector": "/edge_detector/processed_image",
    "hsv_tracker": "/hsv_tracker/objects",
    "ball_tracker": "/ball_tracker/objects",
    "line_follower": "/line_follower/line",
    "face_detector": "/face_detector/faces",
    "motion_detector": "/motion_detector/motion",
    "object_tracker": "/object_tracker/object",
    "apriltag_detector": "/apriltag_detector/tags",
    "code_reader": "/code_reader/codes",
    "object_detector": "/object_detector/objects",
}
AROUND = ("dashboard", "roslaunch", "rosmaster", "rosout")  # what runs beside these nodes
NEWER = ("/object_detector", "/dashboard")  # than the goals of CPU and memory
ONE = "one process"
WAYS = {"each Python node a process": ["one_process:=false"], ONE: ["one_process:=true"]}
START_TIMEOUT = 90.0  # s
SETTLE = 6.0  # s, not counted, in which what the start has taken is given back
WATCH = 8.0  # times the seconds of other measurements
CORE, MEMORY, START, NODE = 60.0, 350.0, 4.0, 12.0  # %, MB, s and MB: the goals
MORE = ("hough", "contours", "histogram")  # nodes that the demo has not
TITLE = "The demo as a whole"
TEXT = """demo.launch on the scene, 640x480 at 30 Hz, without a viewer of the dashboard: % of a
core, and memory as PSS in MB, in which what several processes share is counted once. The start is
the time from the command to the first result of the last node; roslaunch starts the master, too.
The goals of CPU and memory are older than two of the nodes: "as the goals know it" is what the rest
takes when these have been ended, with the master, roslaunch and all loaders.

"""


@dataclasses.dataclass
class DemoCost:
    """What the demo takes in one of the ways to run it; times of first results in s, by node."""

    processes: Dict[str, ProcessCost]
    first_results: Dict[str, float]
    older: Dict[str, ProcessCost] = dataclasses.field(default_factory=dict)  # without NEWER
    more: Dict[str, float] = dataclasses.field(default_factory=dict)  # MB of one more node, by name

    @property
    def start(self) -> float:
        return max(self.first_results.values())


@contextlib.contextmanager
def running(
    bench: measuring.Bench, arguments: List[str], port: int = 0
) -> Iterator[Tuple[support.Process, Dict[str, float]]]:
    """The demo at work on a master of its own, and the times of the first results."""
    port = port or support.free_port()
    env = {"ROS_MASTER_URI": f"http://127.0.0.1:{port}"}
    probe = support.Process(
        [str(measuring.HERE / "demo_probe"), str(START_TIMEOUT), *RESULTS.values()],
        bench.folder / "demo_probe.log",
        env,
    )
    try:
        probe.wait_for_output("ready")
        command = ["roslaunch", "-p", str(port), "--no-summary", "--skip-log-check"]
        command += ["robot_vision", "demo.launch", "port:=0", *arguments]
        begin = time.monotonic()
        demo = support.Process(command, bench.folder / "demo.log", env)
        try:
            yield demo, first_results(demo, begin, probe)
        finally:
            demo.end()
    finally:
        probe.end()


def first_results(demo: support.Process, begin: float, probe: support.Process) -> Dict[str, float]:
    """Seconds from the command to the first result of each node, and to the dashboard's address."""
    demo.wait_for_output("dashboard: http://", START_TIMEOUT)
    dashboard = time.monotonic() - begin
    if probe.exit_code(START_TIMEOUT) != 0:
        raise RuntimeError(probe.output())
    arrivals = json.loads(probe.output().splitlines()[-1])
    missing = [node for node, topic in RESULTS.items() if topic not in arrivals]
    if missing:
        raise RuntimeError(f"no result of {', '.join(missing)} from the demo:\n{demo.output()}")
    times = {node: arrivals[topic] - begin for node, topic in RESULTS.items()}
    return {**times, "dashboard": dashboard}


def measure(
    bench: measuring.Bench,
    arguments: List[str],
    more: Sequence[str] = (),
    newer: Sequence[str] = (),
) -> DemoCost:
    """Runs the demo once; `more` are nodes that are loaded into it afterwards, one by one.

    `newer` are nodes that are ended after that, to measure what is left.
    """
    port = support.free_port()
    with running(bench, arguments, port) as (demo, times):
        time.sleep(SETTLE)
        cost = DemoCost(costs_of(demo.pid, WATCH * bench.seconds), times)
        env = {"ROS_MASTER_URI": f"http://127.0.0.1:{port}"}
        with contextlib.ExitStack() as stack:
            for name in more:
                before = total(costs_of(demo.pid, 1.0)).memory
                loader = support.Process(loader_of(name), bench.folder / f"{name}.log", env)
                stack.callback(loader.end)
                time.sleep(2.0 * SETTLE)
                grown = total(costs_of(demo.pid, 1.0)).memory - before
                cost.more[name] = grown + memory_of(loader.pid)
        if newer:
            subprocess.run(["rosnode", "kill", *newer], env={**os.environ, **env}, check=True)
            time.sleep(SETTLE)
            cost.older = costs_of(demo.pid, WATCH * bench.seconds)
        return cost


def loader_of(name: str) -> List[str]:
    """The command that loads a node of this package into the demo's process."""
    command = [program_of("nodelet", "nodelet"), "load", f"robot_vision/{name}", "/vision"]
    return [*command, f"__name:={name}", "image:=/usb_cam/image_raw", "_always_subscribe:=true"]


def cost_table(costs: Dict[str, DemoCost]) -> str:
    """A line for each process; two columns for each way, and the sums of both last."""
    columns = ["process"]
    for way in costs:
        columns += [f"CPU: {way}", "PSS"]
    names = list(dict.fromkeys(name for cost in costs.values() for name in cost.processes))
    rows = []
    for name in names:
        rows.append([name])
        for cost in costs.values():
            rows[-1] += _cells(cost.processes.get(name))
    counts = ", ".join(str(total(cost.processes).count) for cost in costs.values())
    rows.append([f"all, {counts} processes"])
    for cost in costs.values():
        rows[-1] += _cells(total(cost.processes))
    return table(columns, rows)


def _cells(cost: Optional[ProcessCost]) -> List[str]:
    return [f"{cost.core:.1f}", f"{cost.memory:.1f}"] if cost else ["-", "-"]


def start_table(costs: Dict[str, DemoCost]) -> str:
    names = next(iter(costs.values())).first_results
    rows = [
        [name, *(f"{cost.first_results[name]:.1f}" for cost in costs.values())] for name in names
    ]
    return table(["first result, s", *costs], rows)


def goals(cost: DemoCost) -> List[Accuracy]:
    all_ = total(cost.processes)
    older = total(cost.older)
    nodes = total({name: one for name, one in cost.processes.items() if name not in AROUND})
    return [
        Accuracy("the demo", "all processes", "% of a core", all_.core, most=CORE),
        Accuracy("the demo", "all processes", "MB", all_.memory, most=MEMORY),
        Accuracy("the demo", "as the goals know it", "% of a core", older.core, most=CORE),
        Accuracy("the demo", "as the goals know it", "MB", older.memory, most=MEMORY),
        Accuracy("the demo", "its twelve nodes and their loaders", "MB", nodes.memory, most=MEMORY),
        Accuracy("the demo", "start", "s", cost.start, most=START),
        *(Accuracy("one more node", name, "MB", mb, most=NODE) for name, mb in cost.more.items()),
    ]


def all_tables(bench: measuring.Bench) -> str:
    """Of both ways, measured one after the other."""
    costs = {}
    for way, arguments in WAYS.items():
        measuring.say(f"the demo, {way}")
        costs[way] = measure(bench, arguments, *((MORE, NEWER) if way == ONE else ()))
    last = list(costs.values())[-1]
    tables = [cost_table(costs), start_table(costs), accuracies_table(goals(last))]
    return TEXT + "\n".join(tables)
