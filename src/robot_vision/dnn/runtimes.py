"""Which runtime runs a network: onnxruntime, or OpenCV's module dnn."""

import os
from typing import Sequence

from .model_facts import ModelFile, joined
from .network_input import NetworkInput
from .onnx_file import ONNXRUNTIME_DOMAIN
from .onnx_runtime import HINT, OnnxRuntime
from .onnxruntime_folder import find_onnxruntime
from .opencv_runtime import OpenCvRuntime
from .runtime import NetworkError, Runtime

__all__ = [
    "BACKENDS",
    "NetworkError",
    "OnnxRuntime",
    "OpenCvRuntime",
    "Runtime",
    "advice_for",
    "make_runtime",
]
BACKENDS = ("auto", "onnxruntime", "opencv")


def make_runtime(
    model: ModelFile,
    network_input: NetworkInput,
    backend: str = "auto",
    threads: int = 1,
    affinity: Sequence[int] = (),
) -> Runtime:
    """Returns the runtime for a model: with `auto` onnxruntime for ONNX, if it is there.

    Raises:
        ValueError: The backend is unknown or cannot run the model, or a processor is not there.
    """
    if backend not in BACKENDS:
        raise ValueError(f"backend is {backend}, must be {', '.join(BACKENDS)}")
    _require_processors(affinity)
    own = [one for one in model.custom if not one.startswith(ONNXRUNTIME_DOMAIN + ".")]
    if own:
        raise ValueError(
            f"it has operators that are no part of ONNX, which no runtime here has: "
            f"{joined(own)}; export it without them"
        )
    if model.kind != "onnx":
        if backend == "onnxruntime":
            raise ValueError(f"backend is onnxruntime, which runs ONNX only, and not {model.kind}")
        return OpenCvRuntime(model, network_input, affinity)
    if backend == "opencv":
        return OpenCvRuntime(model, network_input, affinity)
    try:
        return OnnxRuntime(model, network_input, threads, affinity)
    except ValueError as error:
        if backend == "onnxruntime":
            raise
        try:
            return OpenCvRuntime(model, network_input, affinity)
        except ValueError as other:
            raise ValueError(f"{other}; {error}") from None


def _require_processors(affinity: Sequence[int]) -> None:
    there = os.sched_getaffinity(0)
    missing = sorted(set(affinity) - there)
    if missing:
        raise ValueError(
            f"affinity has the processors {missing}, must be some of {sorted(there)}, which this "
            "process may run on"
        )


def advice_for(model: ModelFile, runtime: Runtime) -> str:
    """Returns what would make a model faster on this machine, or nothing."""
    if model.kind == "onnx" and runtime.name == OpenCvRuntime.name:
        module, reason = find_onnxruntime()
        if module is None:
            return f"{runtime.name} runs it, as {reason}; {HINT}"
    return ""
