"""Networks run by OpenCV's module dnn."""

import contextlib
from typing import Any, Iterator, Sequence

import cv2
import numpy as np

from .model_facts import ModelFile
from .network_input import NetworkInput
from .onnx_check import require_convolutions, require_names
from .onnx_file import parse
from .onnx_rewrite import needs_rewriting, opencv_onnx
from .runtime import Runtime, reason_of


class OpenCvRuntime(Runtime):
    """OpenCV's module dnn. Its threads are those of the process (cv2.setNumThreads).

    Raises:
        ValueError: It cannot read the model.
    """

    name = "OpenCV"
    converts = True

    def __init__(self, model: ModelFile, network_input: NetworkInput, affinity: Sequence[int] = ()):
        super().__init__(network_input, affinity)
        try:
            with quiet_opencv():
                self._net = _read(model, network_input)
                self.output_names = list(self._net.getUnconnectedOutLayersNames())
        except cv2.error as error:
            raise ValueError(f"OpenCV cannot read it: {reason_of(error)}") from None
        # OpenCV has an order of its own, and some versions know the outputs only by other names.
        declared = [one.name for one in model.outputs]
        if sorted(declared) == sorted(self.output_names):
            self.output_names = declared

    def _forward(self, values: np.ndarray) -> Sequence[np.ndarray]:
        with quiet_opencv():
            self._net.setInput(values)
            return self._net.forward(self.output_names)

    def flop(self) -> int:
        """Returns the floating point operations of a run as OpenCV counts them."""
        with contextlib.suppress(cv2.error), quiet_opencv():
            return int(self._net.getFLOPS(self._input.shape))
        return 0


def _read(model: ModelFile, network_input: NetworkInput) -> Any:
    data = model.data
    if model.kind == "onnx":
        graph = parse(data, "it is no ONNX file").graph
        require_names(graph)
        require_convolutions(graph)
        if needs_rewriting(model):
            data = opencv_onnx(data, network_input.shape)
        return cv2.dnn.readNetFromONNX(_array(data))
    first, second = _array(model.description), _array(data)
    if model.kind == "darknet":
        return cv2.dnn.readNetFromDarknet(first, second)
    if model.kind == "caffe":
        return cv2.dnn.readNetFromCaffe(first, second)
    return cv2.dnn.readNetFromTensorflow(second, first)


def _array(data: bytes) -> np.ndarray:
    return np.frombuffer(data, np.uint8)


@contextlib.contextmanager
def quiet_opencv() -> Iterator[None]:
    """Keeps OpenCV from printing errors that it throws as well; before 4.6 it prints none."""
    set_level = getattr(cv2, "setLogLevel", None)
    before = set_level(0) if set_level else None
    try:
        yield
    finally:
        if set_level:
            set_level(before)
