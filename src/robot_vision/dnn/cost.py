"""What a network costs: its floating point operations, and its time on this machine."""

import math
import statistics
import time
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple

import numpy as np

from ..common import opencv as cv2
from .model_facts import ModelFile
from .network_input import NetworkInput
from .onnx_file import load_onnx, parse
from .onnx_graph import nodes_of
from .onnx_rewrite import plain_onnx
from .runtime import NetworkError, Runtime
from .runtimes import OnnxRuntime, OpenCvRuntime

COUNTED = ("Conv", "QLinearConv", "ConvTranspose", "MatMul", "Gemm")
MAX_SHAPE_VALUES = 1024  # numbers of a constant that may be a shape
MAX_TIME = 2.0  # s for the runs of one runtime
Shape = Tuple[int, ...]


def flop_of(model: ModelFile, network_input: NetworkInput, runtime: Runtime) -> Tuple[int, bool]:
    """Returns the floating point operations of one run, and whether these are all.

    Of ONNX they are two for each multiplication of convolutions and matrices, as papers count them,
    of others what OpenCV counts.
    """
    if model.kind == "onnx":
        return _flop_of_onnx(plain_onnx(model.data, network_input.shape), network_input)
    flop = runtime.flop()
    return flop, flop > 0


def _flop_of_onnx(content: bytes, network_input: NetworkInput) -> Tuple[int, bool]:
    model = parse(content, "it is no ONNX file")
    shapes: Dict[str, Shape] = {one.name: tuple(one.dims) for one in model.graph.initializer}
    shapes.update(_inferred(content))
    products = [_products(node, shapes) for node in nodes_of(model.graph)]
    if None in products:
        shapes.update(_measured(content, network_input))
        products = [_products(node, shapes) for node in nodes_of(model.graph)]
    return 2 * sum(filter(None, products)), None not in products


def _inferred(content: bytes) -> Dict[str, Shape]:
    """Returns the shapes that python3-onnx infers, of which some may be missing."""
    model = parse(content, "it is no ONNX file")
    for tensor in model.graph.initializer:  # which would be copied, and matter only as shapes
        if math.prod(tensor.dims) > MAX_SHAPE_VALUES:
            tensor.ClearField("raw_data")
            tensor.ClearField("float_data")
    try:
        graph = load_onnx().shape_inference.infer_shapes(model).graph
    except Exception:  # it has errors of its own, and none is worth to end the command
        return {}
    shapes = {}
    for values in (graph.input, graph.value_info, graph.output):
        for value in values:
            sides = tuple(side.dim_value for side in value.type.tensor_type.shape.dim)
            if all(sides):
                shapes[value.name] = sides
    return shapes


def _measured(content: bytes, network_input: NetworkInput) -> Dict[str, Shape]:
    """Returns the shapes around all products by a run of onnxruntime; nothing without it."""
    model = parse(content, "it is no ONNX file")
    made = {name for node in model.graph.node for name in node.output}
    counted = [node for node in model.graph.node if node.op_type in COUNTED]
    wanted = {name for node in counted for name in (*node.input, *node.output)}
    for name in sorted(wanted & made - {one.name for one in model.graph.output}):
        model.graph.output.add(name=name)
    facts = ModelFile("", "onnx", model.SerializeToString())
    plain = network_input._replace(type="float32")
    try:
        runtime = OnnxRuntime(facts, plain, optimization="none")
        outputs = runtime.run(np.zeros(plain.shape, np.float32))
    except (NetworkError, ValueError):
        return {}
    return {name: one.shape for name, one in zip(runtime.output_names, outputs)}


def _products(node: Any, shapes: Dict[str, Shape]) -> Optional[int]:
    """Returns the multiplications of a node; None: its shapes are not known."""
    if node.op_type not in COUNTED:
        return 0
    operands = node.input[:4:3] if node.op_type == "QLinearConv" else node.input[:2]
    inputs = [shapes.get(name) for name in operands]
    out = shapes.get(node.output[0]) if node.output else None
    if len(inputs) < 2 or out is None:
        return None
    first, second = inputs
    if node.op_type in ("Conv", "QLinearConv"):
        return None if second is None else math.prod(out) * math.prod(second[1:])
    if node.op_type == "ConvTranspose":
        known = first is not None and second is not None
        return math.prod(first) * math.prod(second[1:]) if known else None
    # Of products of matrices either operand has the length of the sums.
    axes = {one.name: one.i for one in node.attribute}
    if first:
        return math.prod(out) * first[0 if axes.get("transA") else -1]
    if second:
        return math.prod(out) * second[-1 if axes.get("transB") or len(second) == 1 else -2]
    return None


def times_of(
    model: ModelFile,
    network_input: NetworkInput,
    thread_counts: Sequence[int],
    names: Sequence[str],
    runs: int,
) -> Iterator[Tuple[str, int, float]]:
    """Yields name, number of threads and median of the times in seconds for each runtime.

    A runtime that cannot run the model has NaN.

    Args:
        model: The model.
        network_input: What it takes.
        thread_counts: How many threads are tried.
        names: onnxruntime, OpenCV.
        runs: How many runs are timed at most, after the first; they end after MAX_TIME.
    """
    values = np.random.default_rng(0).random(network_input.shape, np.float32)
    before = cv2.getNumThreads()
    try:
        for name in names:
            for threads in thread_counts:
                cv2.setNumThreads(threads)
                try:
                    runtime = _runtime(name, model, network_input, threads)
                    runtime.run(values)
                    yield name, threads, _median(runtime, values, runs)
                except (NetworkError, ValueError):
                    yield name, threads, math.nan
                    break
    finally:
        cv2.setNumThreads(before)


def _runtime(name: str, model: ModelFile, network_input: NetworkInput, threads: int) -> Runtime:
    if name == OnnxRuntime.name:
        return OnnxRuntime(model, network_input, threads)
    return OpenCvRuntime(model, network_input)


def _median(runtime: Runtime, values: np.ndarray, runs: int) -> float:
    times: List[float] = []
    while len(times) < runs and (len(times) < 3 or sum(times) < MAX_TIME):
        begin = time.perf_counter()
        runtime.run(values)
        times.append(time.perf_counter() - begin)
    return statistics.median(times)
