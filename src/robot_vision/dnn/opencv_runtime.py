"""Networks run by OpenCV's module dnn."""

from typing import Sequence

import numpy as np

from .._core import OpenCvNetwork
from .model_facts import ModelFile
from .network_input import NetworkInput
from .onnx_check import require_names, require_operands
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
        self._net = _read(model, network_input)
        self.output_names = self._net.output_names()
        # OpenCV has an order of its own, and some versions know the outputs only by other names.
        declared = [one.name for one in model.outputs]
        if sorted(declared) == sorted(self.output_names):
            self.output_names = declared

    def _forward(self, values: np.ndarray) -> Sequence[np.ndarray]:
        return self._net.forward(values, self.output_names)

    def flop(self) -> int:
        """Returns the floating point operations of a run as OpenCV counts them."""
        try:
            return self._net.flop(self._input.shape)
        except ValueError:
            return 0


def _read(model: ModelFile, network_input: NetworkInput) -> OpenCvNetwork:
    data = model.data
    if model.kind == "onnx":
        graph = parse(data, "it is no ONNX file").graph
        require_names(graph)
        if needs_rewriting(model):
            data = opencv_onnx(data, network_input.shape)
            graph = parse(data, "it is no ONNX file").graph
        require_operands(graph)  # of what OpenCV gets, where weights may have other names
    try:
        return OpenCvNetwork(model.kind, data, model.description)
    except ValueError as error:
        raise ValueError(f"OpenCV cannot read it: {reason_of(error)}") from None
