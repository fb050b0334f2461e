"""Runs programs and nodes on the same images, in turns, and takes their figures."""

import contextlib
import dataclasses
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "support"), str(HERE.parent / "vivid")]

import cv2  # noqa: E402
import host  # noqa: E402
import numpy as np  # noqa: E402
import support  # noqa: E402
from results import Comparison, Figures, Kernel, Size, to_kernels  # noqa: E402

import robot_vision  # noqa: E402

RATE = 30  # Hz
WARM_UP = 1  # s, not counted
KERNEL_SECONDS = 0.07  # of the time of a node's measurement, for each kernel
NODE_LOG = "node-{}"  # name of the log of a contender's command
STAMP_ERROR = 1e-6  # s, by which a stamp changes on its way through text

Command = List[str]


@dataclasses.dataclass
class Contender:
    """Something that works on frames; `result` is the topic where its images come out.

    The commands are started in this order and ended in the opposite one; all are measured. Without
    a result, the listener, which is not measured, or the first command prints at its end when each
    frame arrived. A contender with `alone` is not a node: that one command is run and prints its
    result.
    """

    name: str
    commands: List[Command] = dataclasses.field(default_factory=list)
    result: str = ""
    expect: str = ""  # what the probe is to compare one result with
    own_camera: bool = False  # the frames are those of one of the commands, or of one beside
    listener: Command = dataclasses.field(default_factory=list)
    image: str = ""  # portrait: the photograph keeps its shape, in another one's middle; tags
    still: bool = False  # a box wanders before the photograph, instead of the photograph itself
    alone: Command = dataclasses.field(default_factory=list)
    beside: List[Command] = dataclasses.field(default_factory=list)  # meanwhile, not measured
    depth: str = ""  # the topic of a depth camera's images, which are there, too
    cloud: bool = False  # the result is a cloud
    certain: bool = False  # a result in which not all is found is an error
    rate: int = RATE  # Hz
    warm_up: int = WARM_UP  # s


def percentile(values: Sequence[float], share: float) -> float:
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def to_figures(result: Dict[str, Any]) -> Figures:
    latencies = result["latencies_ms"]
    if not latencies:
        raise RuntimeError("no result has arrived")
    return Figures(
        cpu_ms=result["cpu_seconds"] / len(latencies) * 1e3,
        core=result["cpu_seconds"] / result["seconds"] * 1e2,
        median=statistics.median(latencies),
        p99=percentile(latencies, 0.99),
        arrived=min(len(latencies) / result["sent"], 1.0) * 1e2,
        same=result["same_pixels"] * 1e2,
        found=result.get("found", -1.0) * 1e2,
    )


def over_rounds(rounds: List[Figures]) -> Figures:
    """The median of each figure."""
    return Figures(
        *(
            statistics.median(getattr(figures, field.name) for figures in rounds)
            for field in dataclasses.fields(Figures)
        )
    )


class Bench:
    """The programs, the private master and the settings of a run."""

    def __init__(self, programs: Path, folder: Path, seconds: float, rounds: int):
        self._programs = programs
        self.folder = folder
        self.seconds = seconds
        self.rounds = rounds
        self.scenes = 51  # of each object to recognize

    def program(self, name: str, *args: Any) -> Command:
        return [str(self._programs / name), *map(str, args)]

    def image(self, size: Size, kind: str = "") -> Path:
        """A photograph of this size as a file; portrait and tags as a Contender has them.

        nobody: one without faces; face: the part of the usual one that is its face.
        """
        import skimage.data

        path = self.folder / "{}x{}{}.png".format(*size, kind)
        if not path.exists():
            astronaut, coffee = skimage.data.astronaut(), skimage.data.coffee()
            parts = {"nobody": coffee, "face": astronaut[20:240, 110:330], "portrait": coffee}
            photograph = enlarged(parts.get(kind, astronaut), size)
            if kind == "portrait":
                width, height = size
                left = (width - height) // 2
                photograph[:, left : left + height] = enlarged(astronaut, (height, height))
            if kind == "tags":
                paste_tags(photograph)
            cv2.imwrite(str(path), photograph)
        return path

    def compare(self, title: str, size: Size, contenders: List[Contender]) -> Comparison:
        """Measures the contenders in turns; a figure is the median over the rounds."""
        measured: List[List[Figures]] = [[] for _ in contenders]
        for turn in range(self.rounds):
            for contender, figures in zip(contenders, measured):
                say("{}x{}, round {}: {}".format(*size, turn + 1, contender.name))
                figures.append(self._measure(size, contender))
        names = [contender.name for contender in contenders]
        return Comparison(title, size, names, [over_rounds(rounds) for rounds in measured])

    def in_process(self, size: Size, threads: int, frames: int) -> Dict[str, Any]:
        say("{}x{}: in one process".format(*size))
        args = ["__name:=bench_in_process", self.image(size), *size, frames, threads]
        return self._run(self.program("bench_in_process", *args), 60.0)

    def kernels(self, *args: str) -> List[Kernel]:
        """Medians of each repetition; of these the least, as nothing makes work faster."""
        say(" ".join(["work on pixels", *args]))
        command = self.program("bench_kernels", self.image((1920, 1080)), *args)
        command += [f"--benchmark_min_time={KERNEL_SECONDS * self.seconds}"]
        command += [f"--benchmark_repetitions={self.rounds}", "--benchmark_format=json"]
        return to_kernels(json.loads(self._output(command, 1800.0))["benchmarks"])

    def tags(self, size: Size, tags: int) -> Dict[str, Any]:
        say("{}x{}: {} AprilTags".format(*size, tags))
        args = [self.image(size), *size, tags, self.rounds]
        return self._run(self.program("bench_tags", *args), 300.0)

    def tag_depth(self) -> List[Dict[str, Any]]:
        say("poses of tags by depth")
        return self._run(self.program("bench_tag_depth", int(self.seconds * 200)), 300.0)

    def recognition(
        self, frames: int, slow: bool, models: Optional[Path] = None
    ) -> List[Dict[str, Any]]:
        """For each object: its name, and what each contender has found in these frames.

        With `slow` there is cv::ppf_match_3d, too, which takes some minutes for ten frames. The
        objects are the samples, or six `models` of the folder of assimp-testmodels.
        """
        say(f"objects recognized, {frames} frames of each" + (f", {models}" if models else ""))
        words = "" if slow else "views,point pairs,cv::linemod"
        folder = [models] if models else []
        command = self.program("bench_recognition", frames, words, *folder)
        return json.loads(self._output(command, 36000.0))

    def recognition_growth(self) -> Dict[str, Any]:
        say("recognition by the number of objects and of templates")
        return self._run(self.program("bench_recognition_growth"), 1800.0)

    def findings(self, size: Size, kind: str, numbers: Sequence[int]) -> List[List[float]]:
        """For each number: it, CPU ms per frame, how many were found."""
        say("{}x{}: {} {}".format(*size, ", ".join(map(str, numbers)), kind))
        args = [self.image(size, "nobody"), self.image((440, 440), "face"), kind, *size]
        return self._run(self.program("bench_growth", *args, *numbers), 600.0)

    def vm(self) -> Dict[str, float]:
        """CPU seconds per frame of a V4L2 camera; empty if there can be no VM here."""
        say("640x480: a V4L2 camera in a VM")
        one_webcam = "n_devs=1 node_types=0x1 num_inputs=1 input_types=0x0"
        out = self.folder / "vivid"
        done = host.run_guest(HERE / "vivid_cpu.py", out, one_webcam, 600.0)
        if done.returncode == host.UNAVAILABLE:
            say(done.stdout.strip())
            return {}
        if done.returncode != 0:
            raise RuntimeError(done.stdout + (out / "log").read_text(errors="replace"))
        return json.loads((out / "cpu.json").read_text())

    def chain(self, size: Size, threads: int) -> Command:
        return self.program("bench_chain", self.image(size), *size, self.seconds, RATE, threads)

    def _measure(self, size: Size, contender: Contender) -> Figures:
        if contender.alone:
            return to_figures(self._run(contender.alone, self._deadline(contender)))
        result, output = self.observe(size, contender)
        if not contender.result:  # the listener knows when they arrived
            arrivals = [
                arrival
                for arrival in json.loads(output.splitlines()[-1])
                if result["begin"] - STAMP_ERROR < arrival[0] < result["end"] + STAMP_ERROR
            ]
            result["latencies_ms"] = [arrival[1] for arrival in arrivals]
            if not arrivals:
                raise RuntimeError(self._failure(contender, "no result has arrived"))
            if contender.listener and arrivals and arrivals[0][2] is not None:
                found = sum(arrival[2] for arrival in arrivals)
                if contender.certain and found < len(arrivals):
                    what = f"only {found} of {len(arrivals)} results are as expected"
                    raise RuntimeError(self._failure(contender, what))
                result["found"] = found / result["sent"]
        return to_figures(result)

    def observe(self, size: Size, contender: Contender) -> Tuple[Dict[str, Any], str]:
        """Runs the commands once; returns what the probe says, and what the listener prints."""
        with contextlib.ExitStack() as stack:

            def start(command: Command, name: str) -> support.Process:
                process = support.Process(command, self.folder / (name + ".log"))
                stack.callback(process.end)
                return process

            names = map(NODE_LOG.format, range(len(contender.commands)))
            processes = [start(node, name) for node, name in zip(contender.commands, names)]
            pids = [process.pid for process in processes]
            for number, command in enumerate(contender.beside):
                start(command, f"beside-{number}")
            listener = contender.listener
            teller = start(listener, "listener") if listener else processes[0]
            try:
                result = self._run(self._probe(size, contender, pids), self._deadline(contender))
            except RuntimeError as error:
                raise RuntimeError(self._failure(contender, str(error))) from None
        return result, teller.output()

    def _failure(self, contender: Contender, what: str) -> str:
        """What has failed, and all that the nodes have said."""
        names = map(NODE_LOG.format, range(len(contender.commands)))
        logs = [(self.folder / (name + ".log")).read_text(errors="replace") for name in names]
        return "\n".join([f"{contender.name}: {what}", *logs])

    def _deadline(self, contender: Contender) -> float:
        return self.seconds + contender.warm_up + 45.0

    def _probe(self, size: Size, contender: Contender, pids: List[int]) -> Command:
        params = {
            "image": "" if contender.own_camera else self.image(size, contender.image),
            "width": size[0],
            "height": size[1],
            "rate": float(contender.rate),
            "seconds": float(self.seconds),
            "warm_up": float(contender.warm_up),
            "expect": contender.expect,
            "results": "true" if contender.result else "false",
            "still": "true" if contender.still else "false",
            "depth": contender.depth,
            "cloud": "true" if contender.cloud else "false",
            # Two spaces, or a single number would not be read as text.
            "pids": "  ".join(["", *map(str, pids), ""]),
        }
        return [
            *self.program("latency_probe", "image:=/camera/image"),
            "result:=" + (contender.result or "/nothing"),
            *(f"_{name}:={value}" for name, value in params.items()),
        ]

    def _run(self, command: Command, deadline: float) -> Any:
        """Runs a program whose last line is its result as JSON."""
        return json.loads(self._output(command, deadline).splitlines()[-1])

    def _output(self, command: Command, deadline: float) -> str:
        done = subprocess.run(command, timeout=deadline, text=True, capture_output=True)
        if done.returncode != 0:
            raise RuntimeError("{}\n{}".format(" ".join(command), done.stderr))
        return done.stdout


def enlarged(rgb: Any, size: Size) -> Any:
    """The BGR image of an RGB one, in this size."""
    return cv2.resize(cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR), size, interpolation=cv2.INTER_CUBIC)


def paste_tags(photograph: np.ndarray) -> None:
    """Tags 0 and 1 of tag36h11, with white around them, a quarter of the image high."""
    height, width = photograph.shape[:2]
    for id_, left in enumerate((width // 5, width * 3 // 5)):
        cells = np.pad(robot_vision.tag_cells("tag36h11", id_), 1, constant_values=255)
        side = height // 4
        sheet = cv2.resize(cells, (side, side), interpolation=cv2.INTER_AREA)
        top = height // 3
        photograph[top : top + side, left : left + side] = sheet[..., np.newaxis]


Contenders = Callable[[Bench, Size], List[Contender]]


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


@contextlib.contextmanager
def private_master(folder: Path) -> Iterator[None]:
    """A ROS master that nobody else knows of."""
    os.environ.update(
        ROS_HOSTNAME="127.0.0.1",
        ROS_HOME=str(folder),
        ROS_LOG_DIR=str(folder / "log"),
        ROSCONSOLE_STDOUT_LINE_BUFFERED="1",  # or lines of a log would come behind results
    )
    os.environ.pop("ROS_IP", None)
    with contextlib.ExitStack() as stack:

        def start(*command: Any) -> support.Process:
            process = support.Process([*map(str, command)], folder / "master.log")
            stack.callback(process.end)
            return process

        os.environ.update(support.Master(start, ["rosmaster"]).env)
        yield
