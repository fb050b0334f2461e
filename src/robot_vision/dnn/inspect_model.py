"""The command inspect_model.py, which tells what a model's file is, and how fast it is here."""

import argparse
import math
import os
import sys
import textwrap
from typing import Any, Iterator, List, Sequence, Tuple

from ..common.arguments import command_parser, number_within
from ..common.commands import run_command
from ..common.errors import about
from ..common.plain_text import printable
from .cost import flop_of, times_of
from .heads import EXPECTED, TASKS
from .model_facts import ModelFile, joined
from .model_file import read_model
from .network import Network, NetworkSettings, open_network, output_text
from .network_input import MAX_SIDE
from .onnxruntime_folder import find_onnxruntime
from .runtimes import BACKENDS, OnnxRuntime, OpenCvRuntime

PROGRAM = "inspect_model.py"
EXAMPLES = """examples:
  inspect_model.py yolov8n.onnx
  inspect_model.py yolov4-tiny.cfg --names coco.names
  inspect_model.py model.onnx --input-width 416 --input-height 416 --threads 1 2 4
  inspect_model.py model.onnx --head yolox --no-time
"""
WIDTH = 100  # columns
KINDS = {"onnx": "ONNX", "darknet": "darknet", "caffe": "Caffe", "tensorflow": "TensorFlow"}
MAX_OPERATORS = 12  # that are listed, the most frequent


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = parse_arguments(sys.argv[1:])
    return run_command(PROGRAM, lambda: inspect(arguments))


def parse_arguments(command: Sequence[str]) -> argparse.Namespace:
    """Parses the command line. Exits on wrong arguments."""
    parser = command_parser(
        PROGRAM,
        "Prints what a model takes and gives, which head object_detector takes it for and why, its "
        "classes, its cost, and its time on this machine for each runtime.",
        EXAMPLES,
    )
    parser.add_argument("model", help=".onnx, .cfg, .prototxt or .pbtxt")
    parser.add_argument("--weights", default="", metavar="FILE", help="of a model of two files")
    parser.add_argument(
        "--names", default="", metavar="FILE", help="of the classes: lines or YAML; or coco, or voc"
    )
    parser.add_argument("--head", choices=["auto", *EXPECTED], default="auto")
    parser.add_argument("--task", choices=["auto", *TASKS], default="auto")
    parser.add_argument("--backend", choices=BACKENDS, default="auto")
    for side in ("width", "height"):
        parser.add_argument(
            f"--input-{side}",
            type=number_within(int, 1, MAX_SIDE),
            default=0,
            metavar="PX",
            help="where the model leaves it open",
        )
    parser.add_argument("--no-time", action="store_true", help="measure no times")
    parser.add_argument(
        "--threads",
        nargs="+",
        type=number_within(int, 1, 256),
        metavar="N",
        help="numbers of threads to measure (default: 1, and all processors)",
    )
    parser.add_argument(
        "--runs",
        type=number_within(int, 1, 1000),
        default=9,
        metavar="N",
        help="runs of each, of which the median counts (default: %(default)d)",
    )
    return parser.parse_args(command)


def inspect(arguments: argparse.Namespace) -> None:
    """Prints what is known of a model, line by line as it becomes known.

    Raises:
        OSError: A file cannot be read.
        ValueError: The model cannot be used.
    """
    model = read_model(arguments.model, arguments.weights)
    _print(_facts(model))
    network = open_network(_settings(arguments), model)
    _print(_understood(network))
    with about(model.path):
        flop, complete = flop_of(model, network.input, network.runtime)
    _print([("cost", _cost(flop, complete, model))])
    if not arguments.no_time:
        _print(_times(model, network, arguments))
    if network.advice:
        _print([("advice", network.advice)])


def _settings(arguments: argparse.Namespace) -> NetworkSettings:
    return NetworkSettings(
        arguments.model,
        arguments.weights,
        arguments.names,
        arguments.backend,
        head=arguments.head,
        task=arguments.task,
        input_width=arguments.input_width,
        input_height=arguments.input_height,
    )


def _print(lines: Any) -> None:
    for name, text in lines:
        indent = " " * 11
        print(textwrap.fill(text, WIDTH, initial_indent=f"{name:11}", subsequent_indent=indent))
        sys.stdout.flush()


def _facts(model: ModelFile) -> Iterator[Tuple[str, str]]:
    size = (len(model.data) + len(model.description)) / 1e6
    parts = [KINDS[model.kind], f"{size:.2f} MB" if size < 10 else f"{size:.0f} MB"]
    if model.opset:
        parts.append(f"opset {model.opset}")
    if model.producer and model.producer != KINDS[model.kind]:
        parts.append(f"written by {model.producer}")
    parts += ["half precision"] if model.half else []
    parts += ["open sizes"] if model.dynamic else []
    yield "file", f"{printable(os.path.basename(model.path))}: {', '.join(parts)}"
    for one in model.inputs:
        yield "input", str(one)
    for one in model.outputs:
        yield "output", str(one)
    often = sorted(model.operators.items(), key=lambda item: (-item[1], item[0]))
    listed = [f"{count} {printable(name, 40)}" for name, count in often[:MAX_OPERATORS]]
    if len(often) > MAX_OPERATORS:
        listed.append(f"{len(often) - MAX_OPERATORS} other kinds")
    yield "operators", ", ".join(listed)
    if model.custom:
        yield "custom", joined(model.custom)
    for warning in model.warnings:
        yield "warning", warning
    for key in ("task", "stride", "imgsz", "end2end"):
        if key in model.metadata:
            yield key, printable(model.metadata[key])


def _understood(network: Network) -> Iterator[Tuple[str, str]]:
    head = network.head
    yield "gives", output_text(network)
    yield "head", f"{head.head}, {head.task}: {head.reason}"
    size = f"{network.input.width}x{network.input.height} px"
    yield "images", f"{size}, {network.input.layout}, {network.image}"
    if head.counted:
        yield "classes", f"{len(network.names)}: {', '.join(network.names)}"
    else:
        yield "classes", "as many as a file of names has (--names)"


def _cost(flop: int, complete: bool, model: ModelFile) -> str:
    least = "" if complete else "at least "
    parts = [f"{least}{_scaled(flop)}FLOP" if flop else "FLOP not known"]
    if model.parameters is not None:
        parts.append(f"{_scaled(model.parameters).rstrip()} parameters")
    return ", ".join(parts)


def _scaled(number: float) -> str:
    for limit, prefix in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if number >= limit:
            return f"{number / limit:.3g} {prefix}"
    return f"{number:.0f} "


def _times(
    model: ModelFile, network: Network, arguments: argparse.Namespace
) -> Iterator[Tuple[str, str]]:
    processors = len(os.sched_getaffinity(0))
    counts: List[int] = arguments.threads or sorted({1, processors})
    names = [OpenCvRuntime.name]
    if model.kind == "onnx" and find_onnxruntime()[0] is not None:
        names.insert(0, OnnxRuntime.name)
    for name, threads, seconds in times_of(model, network.input, counts, names, arguments.runs):
        if math.isnan(seconds):
            yield "time", f"{name} cannot run it"
        else:
            many = "1 thread" if threads == 1 else f"{threads} threads"
            digits = 1 if seconds > 0.001 else 3
            yield "time", f"{1000.0 * seconds:.{digits}f} ms with {name}, {many}"
